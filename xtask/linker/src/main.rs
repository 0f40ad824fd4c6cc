//! `cargo xtask shaders`: relinks the library's shaders.

use std::process::ExitCode;

use antumbra_linker::{library, relink};

fn main() -> ExitCode {
    match relink(&library()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("antumbra-linker: {message}");
            ExitCode::FAILURE
        }
    }
}
