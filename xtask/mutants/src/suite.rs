//! The tests, built once: their list, and the run time and used shaders of those that ran.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::sources::{Folder, write};

/// Test program of whole techniques in the laboratory, and the module of its tests that always run.
const TECHNIQUES: &str = "techniques";
const GOLDEN: &str = "golden::";

/// Test of a test program.
#[derive(Clone, Debug)]
pub struct Test {
    /// Names of the package and the program, without the number that cargo adds.
    program: String,
    pub name: String,
}

impl Test {
    /// Whether it compares a technique's masks with golden masks.
    pub fn is_golden(&self) -> bool {
        self.program.ends_with(TECHNIQUES) && self.name.starts_with(GOLDEN)
    }

    /// Returns its name in reports.
    pub fn shown(&self) -> String {
        format!("{} {}", self.program, self.name)
    }
}

/// Measurements of a passing test.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Measured {
    pub seconds: f64,
    /// Shaders that it requests, by their names in the library's feature `mutants`.
    pub shaders: BTreeSet<String>,
}

/// Built test program.
#[derive(Clone, Debug)]
struct Program {
    path: PathBuf,
    /// Folder in which cargo runs it.
    folder: PathBuf,
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Passed,
    Failed,
    TimedOut,
}

/// Run of a test.
#[derive(Debug)]
pub struct TestRun {
    pub outcome: Outcome,
    /// Shaders that it used until it ended.
    pub shaders: BTreeSet<String>,
}

/// All tests, and their measurements.
pub struct Suite {
    programs: BTreeMap<String, Program>,
    pub tests: Vec<Test>,
    /// Measurements, by the tests' names in reports.
    measured: Mutex<BTreeMap<String, Measured>>,
    /// Folder of the stored measurements.
    store: PathBuf,
}

impl Suite {
    /// Builds the test programs. Of the laboratory's slow tests of whole techniques it includes those with golden masks, and all if
    /// `is_wide`.
    ///
    /// # Errors
    /// If they do not build, or the measurements cannot be read.
    pub fn new(root: &Path, store: &Path, is_wide: bool) -> Result<Self, String> {
        let file = store.join("tests.json");
        let measured = match std::fs::read_to_string(&file) {
            Ok(text) => serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))?,
            Err(_) => BTreeMap::new(),
        };
        let programs = build(root, is_wide)?;
        let mut suite = Self { programs, tests: Vec::new(), measured: Mutex::new(measured), store: store.to_owned() };
        suite.tests = suite.listed()?;
        if !is_wide {
            suite.tests.retain(|test| !test.program.ends_with(TECHNIQUES) || test.is_golden());
        }
        Ok(suite)
    }

    fn measured(&self) -> MutexGuard<'_, BTreeMap<String, Measured>> {
        self.measured.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the measurements of a test, if there are any.
    pub fn known(&self, test: &Test) -> Option<Measured> {
        self.measured().get(&test.shown()).cloned()
    }

    /// Lists every test of every program, without running it.
    fn listed(&self) -> Result<Vec<Test>, String> {
        let mut tests = Vec::new();
        for (program, built) in &self.programs {
            let list = Command::new(&built.path)
                .args(["--list", "--format", "terse"])
                .current_dir(&built.folder)
                .output()
                .map_err(|error| format!("{}: {error}", built.path.display()))?;
            for line in String::from_utf8_lossy(&list.stdout).lines() {
                if let Some(name) = line.strip_suffix(": test") {
                    tests.push(Test { program: program.clone(), name: name.to_owned() });
                }
            }
        }
        Ok(tests)
    }

    /// Runs unmeasured tests with golden masks without a change: whole techniques use many shaders and detect most changes of them, so
    /// their shaders must be known first.
    ///
    /// # Errors
    /// If a program cannot be run, or a test fails.
    pub fn learn(&self, folder: &Folder) -> Result<(), String> {
        let is_new = |test: &&Test| test.is_golden() && self.known(test).is_none();
        for test in self.tests.iter().filter(is_new) {
            if self.run(test, folder, false, Duration::from_secs(600))?.outcome != Outcome::Passed {
                return Err(format!("`{}` fails without a mutation; fix it first", test.shown()));
            }
        }
        Ok(())
    }

    /// Stores the measurements of a test.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn keep(&self, test: &Test, found: Measured) -> Result<(), String> {
        let mut measured = self.measured();
        measured.insert(test.shown(), found);
        let text = serde_json::to_string_pretty(&*measured).expect("plain data");
        write(&self.store.join("tests.json"), &text)
    }

    /// Runs a test with the changed shaders of a folder, or without a change, and returns the shaders that it used. Stores the
    /// measurements of a test that passes.
    ///
    /// # Errors
    /// If its program cannot be run.
    pub fn run(&self, test: &Test, folder: &Folder, is_changed: bool, limit: Duration) -> Result<TestRun, String> {
        let program = &self.programs[&test.program];
        let unable = |error: std::io::Error| format!("{}: {error}", program.path.display());
        folder.clear_seen()?;
        let mut command = Command::new(&program.path);
        command.args(["--exact", &test.name]).current_dir(&program.folder);
        command.env("ANTUMBRA_MUTANTS_SEEN", &folder.seen);
        if is_changed {
            command.env("ANTUMBRA_MUTANTS_CHANGED", &folder.changed);
        }
        // Without an adapter, tests would be skipped and detect nothing.
        command.env("ANTUMBRA_REQUIRE_ADAPTER", "1").stdout(Stdio::null()).stderr(Stdio::null());
        let begun = Instant::now();
        let outcome = end_of(&mut command, limit).map_err(unable)?;
        let shaders = folder.shaders_seen()?;
        if outcome == Outcome::Passed && self.known(test).is_none() {
            self.keep(test, Measured { seconds: begun.elapsed().as_secs_f64(), shaders: shaders.clone() })?;
        }
        Ok(TestRun { outcome, shaders })
    }
}

/// Runs a command, and kills it at the time limit.
fn end_of(command: &mut Command, limit: Duration) -> std::io::Result<Outcome> {
    let mut child = command.spawn()?;
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(if status.success() { Outcome::Passed } else { Outcome::Failed });
        }
        if begun.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(Outcome::TimedOut);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Builds the tests of library and laboratory with the library's feature `mutants`.
fn build(root: &Path, is_wide: bool) -> Result<BTreeMap<String, Program>, String> {
    let packages = ["--package", "antumbra", "--package", "antumbra-lab"];
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["test", "--no-run", "--locked", "--features", "antumbra/mutants", "--lib"])
        .args(if is_wide { &["--tests"][..] } else { &["--test", TECHNIQUES] })
        .args(packages)
        .arg("--message-format=json-render-diagnostics")
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cannot run cargo: {error}"))?;
    if !output.status.success() {
        return Err("the tests do not compile".to_owned());
    }
    let mut programs = BTreeMap::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let message: serde_json::Value = serde_json::from_str(line).map_err(|error| format!("cargo's: {error}"))?;
        let (Some(path), Some(manifest)) = (message["executable"].as_str(), message["manifest_path"].as_str()) else {
            continue;
        };
        let folder = Path::new(manifest).parent().expect("a file's").to_owned();
        let package = folder.file_name().expect("a package's folder").to_string_lossy().into_owned();
        let target = message["target"]["name"].as_str().unwrap_or_default();
        // The program of a package's own tests has the library's name, which is the package's.
        let program = if target.replace('_', "-") == package { package } else { format!("{package} {target}") };
        programs.insert(program, Program { path: path.into(), folder });
    }
    Ok(programs)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn tests_are_stopped_at_the_time_limit() {
        let end = |program: &str, args: &[&str], limit_ms| {
            end_of(Command::new(program).args(args), Duration::from_millis(limit_ms)).expect("every system has it")
        };
        assert_eq!(end("sleep", &["60"], 50), Outcome::TimedOut);
        assert_eq!(end("true", &[], 60_000), Outcome::Passed);
        assert_eq!(end("false", &[], 60_000), Outcome::Failed);
    }
}
