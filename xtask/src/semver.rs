//! `cargo xtask semver`: compares the public API with that of the last release, by cargo-semver-checks.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, cargo, find};

/// Version of cargo-semver-checks to install if there is none: it reads the output of rustdoc 1.95.
const TOOL: &str = "0.51.0";

/// Crates with a public API: the library, and the lights in its interface.
const CRATES: [&str; 2] = ["antumbra", "antumbra-light"];

/// Compares the public API with the newest tag `v*` before this commit, or with a named revision. Before the first release it reports
/// that there is nothing to compare.
///
/// # Errors
/// A change that the version does not announce, an unknown revision, or a tool that cannot be installed.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let baseline = match words[..] {
        [] => last_release(),
        ["--baseline", revision] => Some(revision.to_owned()),
        _ => return Err("`cargo xtask semver` takes only `--baseline REVISION`".into()),
    };
    let Some(baseline) = baseline else {
        eprintln!("xtask: there is no tag v*, so there is no release to compare the API with");
        return Ok(());
    };
    let tool = tool()?;
    let packages = CRATES.iter().flat_map(|name| ["--package", name]);
    shell::run(Command::new(tool).arg("semver-checks").args(packages).args(["--baseline-rev", &baseline]))
}

/// Returns the newest release tag among this commit's ancestors.
fn last_release() -> Option<String> {
    let mut git = Command::new("git");
    git.current_dir(crate::root()).args(["describe", "--tags", "--abbrev=0", "--match", "v[0-9]*"]);
    let printed = git.output().ok().filter(|printed| printed.status.success())?;
    Some(String::from_utf8_lossy(&printed.stdout).trim().to_owned()).filter(|tag| !tag.is_empty())
}

/// Returns cargo-semver-checks: the installed one, or a copy in target/tools.
fn tool() -> Result<PathBuf, String> {
    if let Some(installed) = find("cargo-semver-checks") {
        return Ok(installed);
    }
    let tools = crate::root().join("target/tools");
    let own = tools.join(format!("bin/cargo-semver-checks{}", std::env::consts::EXE_SUFFIX));
    if !own.is_file() {
        install(&tools)?;
    }
    Ok(own)
}

fn install(tools: &Path) -> Result<(), String> {
    eprintln!(
        "xtask: installing cargo-semver-checks {TOOL} in {} with cargo, which takes ten minutes on two cores",
        tools.display()
    );
    let install = ["install", "--quiet", "--locked", "cargo-semver-checks", "--version", TOOL, "--root"];
    shell::run(cargo().args(install).arg(tools))
}
