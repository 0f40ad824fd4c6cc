//! `cargo xtask web`: builds, serves and tests the viewer as a web page.

pub mod browser;
mod build;
mod check;
mod compare;
mod programs;
mod server;

pub use build::build;
pub use programs::{Extent as Programs, check as check_programs};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use check::Extent;
use server::Server;

use crate::wasm;

/// Port of the page's server, if it is free.
const PORT: u16 = 8080;

/// Builds the page; serves it or tests it in a browser if an option requests it.
///
/// # Errors
/// What does not build, or does not work.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        [] => build(&folder()),
        ["--serve"] => {
            build(&folder())?;
            serve(&folder(), PORT, "a browser with WebGPU")
        }
        ["--shaders"] => check_programs(Programs::ModulesAndLayouts),
        ["--pipelines"] => check_programs(Programs::Pipelines),
        ["--check"] => check(Extent::Techniques),
        ["--check-all"] => check(Extent::Variants),
        _ => Err(
            "`cargo xtask web` takes only one of `--serve`, `--shaders`, `--pipelines`, `--check` and `--check-all`"
                .into(),
        ),
    }
}

/// Returns the folder of the built page.
fn folder() -> PathBuf {
    crate::root().join("target/web")
}

/// Serves a folder on this machine until the program ends, on the port if free, else on another one.
///
/// # Errors
/// If no port is available.
pub fn serve(folder: &Path, port: u16, by: &str) -> Result<(), String> {
    let server = Server::new(folder, port).or_else(|problem| {
        eprintln!("xtask: {problem}; using another port");
        Server::new(folder, 0)
    })?;
    eprintln!("xtask: open {} in {by}; Ctrl+C stops the server", server.address()?);
    server.run(Arc::new(|_, _| {}));
    Ok(())
}

/// Builds the page and tests it in a browser, if there is one or it can be installed.
fn check(extent: Extent) -> Result<(), String> {
    match wasm::compiler(&[]).and_then(|_| browser::get()) {
        Ok(browser) => {
            build(&folder())?;
            check::check(&folder(), &browser, extent)
        }
        Err(lack) => {
            eprintln!("xtask: SKIPPED the page in a browser: {lack}");
            Ok(())
        }
    }
}
