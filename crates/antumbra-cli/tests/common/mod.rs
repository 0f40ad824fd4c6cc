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

/// Whether there is an adapter to draw with; says so where there is none, and fails where one is required. An adapter that
/// gives no device is a failure.
#[allow(dead_code, reason = "not every test draws")]
pub fn has_adapter(dir: &Path) -> bool {
    let output = run(dir, &["doctor"]);
    let problem = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(0) => true,
        Some(3) if problem.contains("no usable adapter") => {
            antumbra_testing::skip_without_adapter();
            false
        }
        code => panic!("doctor ends with {code:?}: {problem}"),
    }
}
