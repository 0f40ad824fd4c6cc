//! Writes the parts of the documentation that are made of the declarations of techniques and scenes: `cargo xtask docs`. With `site FOLDER
//! WORK [REPOSITORY]`, the index and the gallery of the site, for `cargo xtask site`.
//!
//! Such a part stands between two comments of a page, of which the first says what it is made of. The text is committed, so that pages
//! read where they lie. Tests here fail where it is not what the declarations say, and where a page does not hold together: a link
//! that leads nowhere, a page that the summary lacks, a snippet that nothing compiles.

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
        _ => Err("it takes nothing, or `site FOLDER WORK [REPOSITORY]`".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("antumbra-book: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Makes every page what the declarations say.
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

/// The pages that may have such parts: the book and the README.
fn pages() -> Vec<Page> {
    let mut pages = book_pages();
    pages.push(page("README.md"));
    pages
}
