//! Compiler for browsers, and the check that the library and the viewer's page compile with it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::machine::{self, Missing, Need};
use crate::shell::{self, cargo, find, succeeds};

/// Target of browsers.
pub const TARGET: &str = "wasm32-unknown-unknown";

/// Requirement of Debian's Rust for browsers, whose standard library is source only.
const DEBIAN: [Need; 1] = [Need {
    why: "a Rust compiler for wasm32",
    met: || {
        ["/usr/bin/cargo", "/usr/bin/rustc", "/usr/bin/wasm-ld", "/usr/lib/rustlib/src/rust/library"]
            .iter()
            .all(|file| Path::new(file).exists())
    },
    packages: &["rustc-web", "cargo-web", "rust-web-src", "lld"],
    otherwise: "`rustup target add wasm32-unknown-unknown`",
}];

/// Compiles the viewer's page, and with it the library on wgpu's browser backend, without linking.
///
/// # Errors
/// A compile error; or, with [`Missing::Fail`], how to get a compiler.
pub fn check(missing: Missing) -> Result<(), String> {
    let began = Instant::now();
    let arguments = ["check", "--package", "antumbra-web"];
    let mut check = match compiler(&arguments) {
        Ok(command) => command,
        Err(lack) if missing == Missing::Fail => return Err(format!("cannot check wasm32: {lack}")),
        Err(lack) => {
            eprintln!("xtask: SKIPPED wasm32: {lack}");
            return Ok(());
        }
    };
    shell::run(&mut check)?;
    eprintln!("xtask: checked wasm32 in {} s", began.elapsed().as_secs());
    Ok(())
}

/// Returns the cargo command with these arguments for browsers, with xtask's own toolchain or else Debian's. Its output is in
/// [`target_folder`] of the command.
///
/// # Errors
/// How to get a compiler, if there is none and none can be installed.
pub fn compiler(arguments: &[&str]) -> Result<Command, String> {
    let ours_is_here = || {
        let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let library = Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
        library.is_ok_and(|printed| Path::new(String::from_utf8_lossy(&printed.stdout).trim()).is_dir())
    };
    if !ours_is_here() && find("rustup").is_some() {
        eprintln!("xtask: this toolchain lacks {TARGET}; installing it with rustup");
        // If rustup's server is unreachable, Debian's may still be reachable.
        let _ = succeeds(Command::new("rustup").args(["target", "add", TARGET]));
    }
    if ours_is_here() {
        let mut command = cargo();
        command.args(arguments).args(FOR_BROWSERS).arg("--target-dir").arg(crate::root().join("target/wasm"));
        return Ok(command);
    }
    machine::install(&DEBIAN)?;
    let mut command = Command::new("/usr/bin/cargo");
    command.current_dir(crate::root()).args(arguments).args(FOR_BROWSERS);
    // Building the standard library is still unstable, although this compiler is stable.
    command.args(["-Zbuild-std=std,panic_abort", "--target-dir"]).arg(crate::root().join("target/wasm-debian"));
    command.env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-C linker=wasm-ld");
    Ok(command)
}

const FOR_BROWSERS: [&str; 3] = ["--locked", "--target", TARGET];

/// Returns the folder that a command of [`compiler`] builds into.
pub fn target_folder(command: &Command) -> PathBuf {
    let after = command.get_args().skip_while(|word| *word != "--target-dir").nth(1);
    after.map_or_else(|| crate::root().join("target"), PathBuf::from)
}
