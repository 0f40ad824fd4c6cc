//! Running the command, for the tests of its contract.

use std::path::Path;
use std::process::{Command, Output};

/// The command in the folder `dir`, without what the developer's environment may say.
pub fn antumbra(dir: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_antumbra"));
    command.current_dir(dir).env_remove("ANTUMBRA_ADAPTER").env_remove("ANTUMBRA_SCENES");
    command
}

/// Runs the command with these words.
pub fn run(dir: &Path, words: &[&str]) -> Output {
    antumbra(dir).args(words).output().expect("the command was built with the test")
}

/// What stands in a folder.
#[allow(dead_code, reason = "not every test looks")]
pub fn names_in(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A word of the name of an adapter that draws, or `None` and a word where there is none and none is required. Asked of the laboratory in
/// this process: `doctor` makes every technique before it answers.
#[allow(dead_code, reason = "not every test draws")]
pub fn adapter() -> Option<String> {
    let adapters = antumbra_lab::device::list_adapters();
    if adapters.is_empty() {
        antumbra_testing::skip_without_adapter();
    }
    adapters.first().and_then(|adapter| adapter.name.split_whitespace().next().map(str::to_owned))
}
