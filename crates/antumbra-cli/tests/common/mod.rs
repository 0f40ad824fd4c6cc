//! Helpers that run the command.

use std::path::Path;
use std::process::{Command, Output};

/// The command in the folder `dir`, without the project's environment variables.
pub fn antumbra(dir: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_antumbra"));
    command.current_dir(dir).env_remove("ANTUMBRA_ADAPTER").env_remove("ANTUMBRA_SCENES");
    command
}

/// Runs the command with these arguments.
pub fn run(dir: &Path, words: &[&str]) -> Output {
    antumbra(dir).args(words).output().expect("the command was built with the test")
}

/// Sorted names of a folder's entries.
#[allow(dead_code, reason = "not every test looks")]
pub fn names_in(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Returns a word of an adapter's name; `None` and a message if there is no adapter and none is required. Queries the
/// laboratory in this process, because `doctor` creates every technique before it answers.
#[allow(dead_code, reason = "not every test draws")]
pub fn adapter() -> Option<String> {
    let adapters = antumbra_lab::device::list_adapters();
    if adapters.is_empty() {
        antumbra_testing::skip_without_adapter();
    }
    adapters.first().and_then(|adapter| adapter.name.split_whitespace().next().map(str::to_owned))
}
