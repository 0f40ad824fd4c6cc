//! `cargo xtask book` and `cargo xtask docs`: builds the pages of docs/ as a book, and renews their generated parts.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, cargo, find};
use crate::web::serve;

/// Version of mdbook that the pages are written for.
const MDBOOK: &str = "0.5.4";

/// Port of the book's server, if it is free.
const PORT: u16 = 3000;

/// Writes the generated parts and builds the book in `target/book`; serves it with `--serve`.
///
/// # Errors
/// What cannot be installed, does not build, or is an unknown argument.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let is_served = match words[..] {
        [] => false,
        ["--serve"] => true,
        _ => return Err("`cargo xtask book` takes only `--serve`".into()),
    };
    let folder = crate::root().join("target/book");
    build(&folder, None)?;
    println!("The book: {}", folder.join("index.html").display());
    if is_served { serve(&folder, PORT, "a browser") } else { Ok(()) }
}

/// Writes the generated parts and builds the book in a folder, which is emptied first. Files of the folder `theme` replace those of
/// mdbook's own theme.
///
/// # Errors
/// What cannot be installed or does not build.
pub fn build(folder: &Path, theme: Option<&Path>) -> Result<(), String> {
    write_generated_parts()?;
    // No file of an older book may remain.
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let mut build = Command::new(mdbook()?);
    build.arg("build").arg(crate::root().join("docs")).arg("--dest-dir").arg(folder);
    build.envs(theme.map(|theme| ("MDBOOK_OUTPUT__HTML__THEME", theme)));
    shell::run(&mut build)
}

/// Renews the generated parts of pages. A separate program does it, because it is built with the library.
///
/// # Errors
/// The part of a page that cannot be generated.
pub fn write_generated_parts() -> Result<(), String> {
    shell::run(&mut generator()?)
}

/// Returns the program that writes the generated parts and the site's own pages, built with the dependencies of the tests and of the
/// command `antumbra`.
///
/// # Errors
/// If it does not build.
pub fn generator() -> Result<Command, String> {
    shell::built_of_workspace("antumbra-book").map(Command::new)
}

/// Returns mdbook, installed if necessary.
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
    eprintln!("xtask: installing mdbook {MDBOOK} in {} with cargo, which takes a few minutes", tools.display());
    // Without its server, which would need an asynchronous runtime; xtask has its own.
    let features = ["--no-default-features", "--features", "search"];
    let install = ["install", "--quiet", "--locked", "--force", "mdbook", "--version", MDBOOK, "--root"];
    shell::run(cargo().args(install).arg(&tools).args(features))?;
    if is_right(&own) {
        Ok(own)
    } else {
        Err(format!("installed mdbook {MDBOOK}, but {} has another version", own.display()))
    }
}
