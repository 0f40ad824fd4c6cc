//! `cargo xtask bevy`: checks the Bevy plugin, which is a separate workspace and needs a newer compiler.

use std::process::Command;
use std::time::Instant;

use crate::shell::{self, find};

/// Minimum compiler for Bevy 0.20: 1.97, nightly included, although Bevy declares a patch release of it.
const NEEDED: (u32, u32) = (1, 97);

/// Checks format and lints of the plugin, and runs its tests; arguments go to `cargo test`. If no compiler is new enough, reports that
/// it was skipped.
///
/// # Errors
/// The first check that failed.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let began = Instant::now();
    let Some(toolchain) = toolchain() else {
        eprintln!(
            "xtask: SKIPPED the plugin for Bevy: it needs Rust {}.{} or newer (`rustup toolchain install nightly`)",
            NEEDED.0, NEEDED.1
        );
        return Ok(());
    };
    eprintln!(
        "xtask: building the plugin for Bevy with toolchain `{toolchain}`; the first build takes at least a quarter of an hour"
    );
    let cargo = |words: &[&str]| {
        let mut command = Command::new("rustup");
        command.current_dir(crate::root().join("bevy_antumbra")).args(["run", &toolchain, "cargo"]).args(words);
        // Variables of the cargo that runs xtask.
        for variable in ["CARGO", "RUSTC", "RUSTDOC", "RUSTUP_TOOLCHAIN", "CARGO_MANIFEST_DIR"] {
            command.env_remove(variable);
        }
        command
    };
    const LOCKED: [&str; 2] = ["--locked", "--ignore-rust-version"];
    /// Option that includes the examples.
    const WINDOW: [&str; 2] = ["--features", "window"];
    if arguments.is_empty() {
        if shell::succeeds(&mut cargo(&["fmt", "--version"])) {
            shell::run(&mut cargo(&["fmt", "--check"]))?;
        }
        if shell::succeeds(&mut cargo(&["clippy", "--version"])) {
            let lint = ["--all-targets", "--", "-D", "warnings"];
            shell::run(cargo(&["clippy"]).args(LOCKED).args(WINDOW).args(lint))?;
        }
    }
    // Checks the plugin as users build it: the tests enable more features of Bevy.
    shell::run(cargo(&["check"]).args(LOCKED))?;
    shell::run(cargo(&["test"]).args(LOCKED).args(WINDOW).args(arguments))?;
    eprintln!("xtask: checked the plugin for Bevy in {} s", began.elapsed().as_secs());
    Ok(())
}

/// Returns an installed toolchain that is new enough: preferably the one that runs xtask.
fn toolchain() -> Option<String> {
    find("rustup")?;
    let listed = Command::new("rustup").args(["toolchain", "list"]).output().ok()?;
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    let ours = std::env::var("RUSTUP_TOOLCHAIN").ok();
    let installed = listed.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned);
    ours.into_iter().chain(installed).find(|name| version_of(name).is_some_and(|version| version >= NEEDED))
}

/// Returns the compiler's version, from `rustc 1.97.0-nightly (…)`.
fn version_of(toolchain: &str) -> Option<(u32, u32)> {
    let printed = Command::new("rustup").args(["run", toolchain, "rustc", "--version"]).output().ok()?;
    let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
    let mut numbers = printed.split_whitespace().nth(1)?.split('.').map(|number| number.parse().ok());
    Some((numbers.next()??, numbers.next()??))
}
