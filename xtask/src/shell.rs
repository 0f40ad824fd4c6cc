//! Execution of other programs.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Returns the cargo that runs xtask, so that a toolchain chosen by `cargo +name` stays chosen.
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(crate::root());
    command
}

/// Runs a command with xtask's input and output.
///
/// # Errors
/// The command that failed, and its status.
pub fn run(command: &mut Command) -> Result<(), String> {
    let shown = show(command);
    eprintln!("$ {shown}");
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{shown}` failed: {status}")),
        Err(error) => Err(format!("cannot run `{shown}`: {error}")),
    }
}

/// Returns the output of a command. Its messages go to xtask's standard error.
///
/// # Errors
/// The command that failed, and its status.
pub fn output(command: &mut Command) -> Result<String, String> {
    let shown = show(command);
    eprintln!("$ {shown}");
    match command.stderr(Stdio::inherit()).output() {
        Ok(output) if output.status.success() => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        Ok(output) => Err(format!("`{shown}` failed: {}", output.status)),
        Err(error) => Err(format!("cannot run `{shown}`: {error}")),
    }
}

/// Whether a command runs and succeeds; its output is dropped.
pub fn succeeds(command: &mut Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

/// Returns the path of a program on the search path.
pub fn find(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .map(|dir| dir.join(format!("{program}{}", std::env::consts::EXE_SUFFIX)))
        .find(|file| file.is_file())
}

fn show(command: &Command) -> String {
    let name = |word: &OsStr| word.to_string_lossy().into_owned();
    // Cargo's full path is irrelevant to a reader.
    let program = PathBuf::from(command.get_program()).file_stem().map_or_else(String::new, name);
    std::iter::once(program).chain(command.get_args().map(name)).collect::<Vec<_>>().join(" ")
}

/// Returns the command `antumbra`. Cargo puts every binary of xtask's profile in one folder.
///
/// # Errors
/// If it is not there.
pub fn built_binary() -> Result<PathBuf, String> {
    beside_us("antumbra")
}

/// Builds a program of the workspace with the features of everything else. Built alone, many of its dependencies would have fewer
/// features, and the tests would build them again.
///
/// # Errors
/// If it does not build.
pub fn built_of_workspace(name: &str) -> Result<PathBuf, String> {
    run(cargo().args(["build", "--locked", "--workspace", "--bin", name]))?;
    beside_us(name)
}

fn beside_us(name: &str) -> Result<PathBuf, String> {
    let own = std::env::current_exe().map_err(|error| format!("cannot find the path of this program: {error}"))?;
    let binary = own.with_file_name(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if binary.is_file() { Ok(binary) } else { Err(format!("expected the built command at {}", binary.display())) }
}
