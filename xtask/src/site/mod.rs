//! `cargo xtask site`: builds index, gallery, book and viewer as one folder of static files. All links are relative, so it can be served
//! below any path.

mod check;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use crate::shell;
use crate::web::{self, serve};
use crate::{book, machine};

/// Port of `--serve`, if it is free.
const PORT: u16 = 8000;

#[derive(Debug, Default, PartialEq)]
struct Options {
    folder: Option<PathBuf>,
    is_checked: bool,
    is_served: bool,
}

/// Builds the site; checks or serves it if an option requests it.
///
/// # Errors
/// A part that does not build, or faults that the check finds.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let options = parse(arguments)?;
    let folder = options.folder.unwrap_or_else(|| crate::root().join("target/site"));
    build(&folder)?;
    println!("The site: {}", folder.join("index.html").display());
    if options.is_checked {
        check::check(&folder)?;
    }
    if options.is_served { serve(&folder, PORT, "a browser with WebGPU") } else { Ok(()) }
}

fn parse(arguments: &[String]) -> Result<Options, String> {
    let mut options = Options::default();
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--check" => options.is_checked = true,
            "--serve" => options.is_served = true,
            "-o" => options.folder = Some(rest.next().ok_or("`-o` needs a folder")?.into()),
            other => return Err(format!("site has no option `{other}`; it has -o FOLDER, --check and --serve")),
        }
    }
    Ok(options)
}

fn build(folder: &Path) -> Result<(), String> {
    machine::set_up()?;
    let (images, work) = (folder.join("images"), crate::root().join("target/site-images"));
    for needed in [&images, &work] {
        std::fs::create_dir_all(needed).map_err(|error| format!("{}: {error}", needed.display()))?;
    }
    // A browser resolves relative paths from the site; the programs below run in another folder.
    let folder = folder.canonicalize().map_err(|error| format!("{}: {error}", folder.display()))?;
    book::build(&folder.join("book"), Some(&crate::root().join("xtask/book/site/theme")))?;
    let mut pages = book::generator()?;
    pages.arg("site").arg(&folder).arg(&work);
    match repository()? {
        Some(address) => drop(pages.arg(address)),
        None => eprintln!("xtask: Cargo.toml has no `repository`, so the site has no link to it"),
    }
    make_images(&shell::output(&mut pages)?, &work, &images)?;
    let viewer = folder.join("viewer");
    web::build(&viewer)?;
    link_home(&viewer.join("index.html"))
}

/// Turns the name in the viewer's masthead into a link to the index of the site.
fn link_home(page: &Path) -> Result<(), String> {
    const NAME: &str = "<div class=\"brand\">Antumbra</div>";
    const LINK: &str = "<div class=\"brand\"><a href=\"../index.html\">Antumbra</a></div>";
    let failed = |error| format!("{}: {error}", page.display());
    let text = std::fs::read_to_string(page).map_err(failed)?;
    let linked = text.replacen(NAME, LINK, 1);
    if linked == text {
        return Err(format!("{} has no {NAME}", page.display()));
    }
    std::fs::write(page, linked).map_err(failed)
}

/// Returns the address of the repository, from the workspace's manifest.
fn repository() -> Result<Option<String>, String> {
    let manifest = crate::root().join("Cargo.toml");
    let text = std::fs::read_to_string(&manifest).map_err(|error| format!("{}: {error}", manifest.display()))?;
    let value = text.lines().find_map(|line| line.strip_prefix("repository = \"")?.strip_suffix('"'));
    Ok(value.map(str::to_owned))
}

/// Runs the gallery's commands, lines `OUTPUT: COMMAND`, in the folder `work`, and copies their images for the gallery into `images`.
/// Outputs newer than the program and the command's files are kept.
fn make_images(commands: &str, work: &Path, images: &Path) -> Result<(), String> {
    let renderer = shell::built_of_workspace("antumbra")?;
    let animator = shell::built_of_workspace("antumbra-animate")?;
    for line in commands.lines() {
        let (output, command) = line.split_once(": ").ok_or_else(|| format!("not a command: {line}"))?;
        let words: Vec<&str> = command.split(' ').collect();
        let (program, arguments) = match words[..] {
            ["antumbra", ref arguments @ ..] => (&renderer, arguments),
            ["antumbra-animate", ref arguments @ ..] => (&animator, arguments),
            _ => return Err(format!("not a command: {line}")),
        };
        let inputs = arguments.iter().filter(|word| **word != output).map(|word| modified(&work.join(word)));
        let newest = inputs.chain([modified(program)]).max().flatten();
        if modified(&work.join(output)) <= newest {
            shell::run(Command::new(program).current_dir(work).args(arguments))?;
        }
        if !output.contains(".frame.") {
            let to = images.join(output);
            std::fs::copy(work.join(output), &to).map_err(|error| format!("{}: {error}", to.display()))?;
        }
    }
    Ok(())
}

fn modified(file: &Path) -> Option<SystemTime> {
    file.metadata().and_then(|metadata| metadata.modified()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_in_any_order() {
        let parse = |words: &[&str]| parse(&words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
        let all = Options { folder: Some("a b".into()), is_checked: true, is_served: true };
        assert_eq!(parse(&["--serve", "-o", "a b", "--check"]), Ok(all));
        assert_eq!(parse(&[]), Ok(Options::default()));
        assert!(parse(&["-o"]).is_err() && parse(&["--chek"]).is_err());
    }
}
