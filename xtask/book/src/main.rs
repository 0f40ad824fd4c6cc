//! Writes the parts of the documentation that are made of the declarations of techniques and scenes: `cargo xtask docs`.
//!
//! Such a part stands between two comments of a page, of which the first says what it is made of. The text is committed, so that pages
//! read where they lie. Tests here fail where it is not what the declarations say, and where a page does not hold together: a link
//! that leads nowhere, a page that the summary lacks, a snippet that nothing compiles.

mod generated;
#[cfg(test)]
mod tests;

use std::process::ExitCode;

use antumbra_testing::book::{Page, book_pages, page, root};

fn main() -> ExitCode {
    match write() {
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
