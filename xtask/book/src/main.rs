//! Writes the parts of the documentation that are generated from the declarations of techniques and scenes: `cargo xtask docs`. With
//! `site FOLDER WORK [REPOSITORY]`, writes the index and the gallery of the site, for `cargo xtask site`.
//!
//! A generated part is between two comments of a page, the first of which names its content. The text is committed, so that pages can be
//! read in the repository. Tests here fail if it differs from the declarations, and if a page is inconsistent: a broken link, a page
//! missing from the summary, a snippet that no compiled source contains.

mod animation;
mod generated;
mod site;
#[cfg(test)]
mod tests;

use std::path::Path;
use std::process::ExitCode;

use antumbra_testing::book::{Page, book_pages, page, root};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        [] => write(),
        ["site", folder, work, ref repository @ ..] if repository.len() < 2 => {
            let [folder, work] = [folder, work].map(Path::new);
            site::write(folder, work, repository.first().copied()).map(|commands| print!("{commands}"))
        }
        _ => Err("expected no arguments, or `site FOLDER WORK [REPOSITORY]`".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("antumbra-book: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Renews the generated parts of every page.
fn write() -> Result<(), String> {
    let mut written = 0;
    let pages = pages();
    for page in &pages {
        let text = generated::renewed(&page.text).map_err(|problem| format!("{}: {problem}", page.path))?;
        if text != page.text {
            std::fs::write(root().join(&page.path), text).map_err(|error| format!("{}: {error}", page.path))?;
            println!("wrote {}", page.path);
            written += 1;
        }
    }
    println!("{} pages: {written} written", pages.len());
    Ok(())
}

/// Returns the pages that may contain such parts: the book and the README.
fn pages() -> Vec<Page> {
    let mut pages = book_pages();
    pages.push(page("README.md"));
    pages
}
