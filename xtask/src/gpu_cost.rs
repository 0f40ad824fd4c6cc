//! `cargo xtask gpu-cost`: counts registers and instructions of every pipeline with Mesa's AMD compiler, into `bench/gpu-cost.md`.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use crate::driver::{self, Library};
use crate::machine::{self, Missing};
use crate::shell::{self, cargo};

/// Use of the counts.
enum Purpose {
    /// Writes the page, and compares a table with an earlier one if given.
    Page { earlier: Option<String> },
    /// Checks limits.
    Check,
}

/// Writes the page, or with `--check` checks limits.
///
/// # Errors
/// The step that failed, or a limit that is exceeded.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        [] => count(&Purpose::Page { earlier: None }, Missing::Fail),
        ["--diff", earlier] => count(&Purpose::Page { earlier: Some(earlier.to_owned()) }, Missing::Fail),
        ["--check"] => count(&Purpose::Check, Missing::Fail),
        _ => Err("`cargo xtask gpu-cost` takes only `--diff TABLE` or `--check`".into()),
    }
}

/// Checks limits if Mesa's AMD driver is available.
///
/// # Errors
/// As [`run`].
pub fn check() -> Result<(), String> {
    count(&Purpose::Check, Missing::Skip)
}

fn count(purpose: &Purpose, missing: Missing) -> Result<(), String> {
    let began = Instant::now();
    let Library { file, searched } = match driver() {
        Ok(library) => library,
        Err(lack) if missing == Missing::Fail => return Err(lack),
        Err(lack) => {
            eprintln!("xtask: SKIPPED limits of registers and spills: {lack}");
            return Ok(());
        }
    };
    let root = crate::root();
    let program = shell::built_of_workspace("antumbra-programs")?;
    shell::run(cargo().args(["build", "--locked", "--package", "antumbra-null-device"]))?;
    let (begin, end) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let null_device = program.with_file_name(format!("{begin}antumbra_null_device{end}"));
    let mut command = Command::new(program);
    command.arg("costs").arg(root.join("target/gpu-cost")).env("LD_LIBRARY_PATH", searched);
    command.arg("--driver").arg(file).arg("--null-device").arg(null_device);
    if let Purpose::Page { earlier } = purpose {
        command.arg("--page").arg(root.join("bench/gpu-cost.md"));
        command.arg("--antumbra").arg(shell::built_of_workspace("antumbra")?);
        if let Some(earlier) = earlier {
            command.arg("--diff").arg(std::path::absolute(PathBuf::from(earlier)).unwrap_or_default());
        }
    }
    shell::run(&mut command)?;
    eprintln!("xtask: counted pipelines in {} s", began.elapsed().as_secs());
    Ok(())
}

fn driver() -> Result<Library, String> {
    if !cfg!(target_os = "linux") {
        return Err("Mesa's driver for AMD exists only on Linux".into());
    }
    machine::set_up()?;
    driver::for_amd()
}
