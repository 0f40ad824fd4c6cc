//! Build of the page as a folder: the WebAssembly program, its JavaScript bindings, and the page's own files.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::shell::{self, cargo, find};
use crate::wasm;

/// Size limit of the program, bytes before compression. Of 9.2 MB two thirds are code, a fifth the shaders of all techniques.
const MAX_WASM_BYTES: u64 = 9_500_000;

/// Files of the page, from `crates/antumbra-web/page`.
const PAGE: [&str; 4] = ["index.html", "style.css", "page.js", "check.js"];
/// Images for browsers without WebGPU, from `docs/figures`.
const FIGURES: [&str; 3] = ["hero_smrt.png", "viewer_compare.png", "viewer_error.png"];

/// Builds the page in a folder for any static file server, and prints time and sizes.
///
/// # Errors
/// What is missing, does not compile, or is too large.
pub fn build(folder: &Path) -> Result<(), String> {
    let began = Instant::now();
    let mut compile = wasm::compiler(&["build", "--profile", "web", "--package", "antumbra-web"])?;
    shell::run(&mut compile)?;
    let program = wasm::target_folder(&compile).join(wasm::TARGET).join("web/antumbra-web.wasm");
    // No file of an older build may remain.
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let figures = folder.join("figures");
    std::fs::create_dir_all(&figures).map_err(|error| format!("{}: {error}", figures.display()))?;
    shell::run(
        Command::new(bindgen()?)
            // Function names would be a quarter of it. Binaryen's wasm-opt saves nothing after compression, and Debian's release
            // of it breaks reference tables.
            .args(["--remove-name-section", "--remove-producers-section"])
            .args(["--target", "web", "--no-typescript", "--out-name", "antumbra", "--out-dir"])
            .args([folder, program.as_path()]),
    )?;
    let program = folder.join("antumbra_bg.wasm");
    let root = crate::root();
    for (from, names, to) in
        [("crates/antumbra-web/page", &PAGE[..], folder), ("docs/figures", &FIGURES[..], figures.as_path())]
    {
        for name in names {
            let from = root.join(from).join(name);
            std::fs::copy(&from, to.join(name)).map_err(|error| format!("{}: {error}", from.display()))?;
        }
    }
    let bytes = std::fs::metadata(&program).map_err(|error| format!("{}: {error}", program.display()))?.len();
    let glue = folder.join("antumbra.js");
    eprintln!(
        "xtask: built the page in {} ({} s): program {}, JavaScript {}",
        folder.display(),
        began.elapsed().as_secs(),
        sizes(&program),
        sizes(&glue)
    );
    if bytes > MAX_WASM_BYTES {
        return Err(format!("the page's program has {bytes} bytes; at most {MAX_WASM_BYTES} are allowed"));
    }
    Ok(())
}

/// Returns a file's size and its compressed size: `5.10 MB, 1.90 MB by gzip`.
fn sizes(file: &Path) -> String {
    let mb = |bytes: u64| format!("{:.2} MB", bytes as f64 / 1e6);
    let whole = std::fs::metadata(file).map_or(0, |metadata| metadata.len());
    let compressed = Command::new("gzip").args(["-9", "-c"]).arg(file).output();
    match compressed {
        Ok(output) if output.status.success() => format!("{}, {} with gzip", mb(whole), mb(output.stdout.len() as u64)),
        _ => mb(whole),
    }
}

/// Returns wasm-bindgen in exactly the version of the lock file, because the two must agree.
fn bindgen() -> Result<PathBuf, String> {
    let lock = crate::root().join("Cargo.lock");
    let text = std::fs::read_to_string(&lock).map_err(|error| format!("{}: {error}", lock.display()))?;
    let version = locked_version(&text, "wasm-bindgen").ok_or("Cargo.lock does not contain wasm-bindgen")?;
    let tools = crate::root().join("target/tools");
    let own = tools.join(format!("bin/wasm-bindgen{}", std::env::consts::EXE_SUFFIX));
    let is_right = |program: &PathBuf| {
        let printed = Command::new(program).arg("--version").output();
        printed.is_ok_and(|printed| String::from_utf8_lossy(&printed.stdout).split_whitespace().nth(1) == Some(version))
    };
    if let Some(right) = find("wasm-bindgen").into_iter().chain([own.clone()]).find(is_right) {
        return Ok(right);
    }
    eprintln!(
        "xtask: installing wasm-bindgen-cli {version} in {} with cargo, which takes a few minutes",
        tools.display()
    );
    let install = ["install", "--quiet", "--force", "wasm-bindgen-cli", "--version", version, "--root"];
    shell::run(cargo().args(install).arg(&tools))?;
    if is_right(&own) {
        Ok(own)
    } else {
        Err(format!("installed wasm-bindgen-cli {version}, but {} has another version", own.display()))
    }
}

/// Returns the version of a package in a lock file.
fn locked_version<'a>(lock: &'a str, package: &str) -> Option<&'a str> {
    let mut lines = lock.lines().skip_while(|line| *line != format!("name = \"{package}\""));
    lines.nth(1)?.strip_prefix("version = \"")?.strip_suffix('"')
}

#[cfg(test)]
mod tests {
    use super::locked_version;

    #[test]
    fn versions_are_read_off_the_lock_file() {
        let lock =
            "[[package]]\nname = \"a-b\"\nversion = \"1.2.3\"\n\n[[package]]\nname = \"b\"\nversion = \"4.5.6\"\n";
        assert_eq!(locked_version(lock, "b"), Some("4.5.6"));
        assert_eq!(locked_version(lock, "a"), None);
    }
}
