//! `cargo xtask book` and `cargo xtask docs`: the pages of docs/ as a book, and what of them is made of declarations.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, cargo, find};
use crate::web::serve;

/// The release of mdbook that the pages are written for.
const MDBOOK: &str = "0.5.4";

/// Where the book is served if nothing else has the port.
const PORT: u16 = 3000;

/// Writes the generated parts and builds the book in `target/book`; serves it where that is asked for.
///
/// # Errors
/// What cannot be installed, does not build, or is not taken.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let is_served = match words[..] {
        [] => false,
        ["--serve"] => true,
        _ => return Err("`cargo xtask book` takes `--serve` or nothing".into()),
    };
    let folder = crate::root().join("target/book");
    build(&folder, None)?;
    println!("The book: {}", folder.join("index.html").display());
    if is_served { serve(&folder, PORT, "a browser") } else { Ok(()) }
}

/// Writes the generated parts and builds the book in a folder, in place of what it holds. Files of the folder `theme` replace those of
/// mdbook's own theme.
///
/// # Errors
/// What cannot be installed or does not build.
pub fn build(folder: &Path, theme: Option<&Path>) -> Result<(), String> {
    write_generated_parts()?;
    // Nothing of an older book may remain.
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let mut build = Command::new(mdbook()?);
    build.arg("build").arg(crate::root().join("docs")).arg("--dest-dir").arg(folder);
    build.envs(theme.map(|theme| ("MDBOOK_OUTPUT__HTML__THEME", theme)));
    shell::run(&mut build)
}

/// Makes the generated parts of pages what the declarations say. The program that does is one of its own, since it is built with the
/// library.
///
/// # Errors
/// What of a page cannot be made.
pub fn write_generated_parts() -> Result<(), String> {
    shell::run(&mut generator()?)
}

/// The program that writes the generated parts and the site's own pages, built with what tests and the command `antumbra` are built of.
///
/// # Errors
/// What does not build.
pub fn generator() -> Result<Command, String> {
    shell::built_of_workspace("antumbra-book").map(Command::new)
}

/// The program that makes a book of pages.
fn mdbook() -> Result<PathBuf, String> {
    let tools = crate::root().join("target/tools");
    let own = tools.join(format!("bin/mdbook{}", std::env::consts::EXE_SUFFIX));
    let is_right = |program: &PathBuf| {
        let printed = Command::new(program).arg("--version").output();
        printed.is_ok_and(|printed| String::from_utf8_lossy(&printed.stdout).trim() == format!("mdbook v{MDBOOK}"))
    };
    if let Some(right) = find("mdbook").into_iter().chain([own.clone()]).find(is_right) {
        return Ok(right);
    }
    eprintln!("xtask: installing mdbook {MDBOOK} in {}, by cargo: a few minutes", tools.display());
    // Without its server, since we have one: it would bring an asynchronous runtime.
    let features = ["--no-default-features", "--features", "search"];
    let install = ["install", "--quiet", "--locked", "--force", "mdbook", "--version", MDBOOK, "--root"];
    shell::run(cargo().args(install).arg(&tools).args(features))?;
    if is_right(&own) { Ok(own) } else { Err(format!("installed mdbook {MDBOOK}, and {} is not it", own.display())) }
}
