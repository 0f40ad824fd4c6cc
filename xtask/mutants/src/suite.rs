//! The tests, built once: which there are, and of those that were asked how long each takes and which shaders it uses.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::sources::write;

/// A test takes at most this long as it stands; one that takes longer is not asked.
const LONGEST: Duration = Duration::from_secs(120);

/// One test of one test program.
#[derive(Clone, Debug)]
pub struct Test {
    /// The package's name and the program's, without the number that cargo gives it.
    program: String,
    pub name: String,
}

impl Test {
    /// As reports name it.
    pub fn shown(&self) -> String {
        format!("{} {}", self.program, self.name)
    }
}

/// What a test does with nothing changed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Measured {
    pub seconds: f64,
    /// Shaders that it asks for, as the library's feature `mutants` calls them.
    pub shaders: BTreeSet<String>,
}

/// A built test program.
#[derive(Clone, Debug)]
struct Program {
    path: PathBuf,
    /// Where cargo runs it.
    folder: PathBuf,
}

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Passed,
    Failed,
    TimedOut,
}

/// All tests, and what is known of them.
pub struct Suite {
    programs: BTreeMap<String, Program>,
    pub tests: Vec<Test>,
    /// By the tests' names as reports have them.
    measured: Mutex<BTreeMap<String, Measured>>,
    /// Where that is kept.
    store: PathBuf,
}

impl Suite {
    /// Builds the test programs; the laboratory's own, which compare whole techniques with the truth, where asked for.
    ///
    /// # Errors
    /// Where they do not build, or what is known of them cannot be read.
    pub fn new(root: &Path, store: &Path, is_wide: bool) -> Result<Self, String> {
        let file = store.join("tests.json");
        let measured = match std::fs::read_to_string(&file) {
            Ok(text) => serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))?,
            Err(_) => BTreeMap::new(),
        };
        let programs = build(root, is_wide)?;
        let mut suite = Self { programs, tests: Vec::new(), measured: Mutex::new(measured), store: store.to_owned() };
        suite.tests = suite.listed()?;
        Ok(suite)
    }

    fn measured(&self) -> MutexGuard<'_, BTreeMap<String, Measured>> {
        self.measured.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is known of a test.
    pub fn known(&self, test: &Test) -> Option<Measured> {
        self.measured().get(&test.shown()).cloned()
    }

    /// Every test of every program, not run yet.
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

    /// Runs a test with nothing changed, and keeps what is learnt.
    ///
    /// # Errors
    /// Where it fails.
    pub fn measure(&self, test: &Test) -> Result<Measured, String> {
        // One at a time: they would note their shaders in one folder.
        static ONE: Mutex<()> = Mutex::new(());
        let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let seen = self.store.join("seen");
        let unable = |error: std::io::Error| format!("{}: {error}", seen.display());
        if seen.exists() {
            std::fs::remove_dir_all(&seen).map_err(unable)?;
        }
        std::fs::create_dir_all(&seen).map_err(unable)?;
        let begun = Instant::now();
        let outcome = self.run(test, ("ANTUMBRA_MUTANTS_SEEN", &seen), LONGEST)?;
        let mut found = Measured { seconds: begun.elapsed().as_secs_f64(), shaders: BTreeSet::new() };
        match outcome {
            Outcome::Failed => return Err(format!("`{}` fails with nothing changed", test.shown())),
            Outcome::TimedOut => {}
            Outcome::Passed => {
                let notes = std::fs::read_dir(&seen).map_err(unable)?.filter_map(Result::ok);
                found.shaders = notes.map(|note| note.file_name().to_string_lossy().replace('=', "/")).collect();
            }
        }
        let mut measured = self.measured();
        measured.insert(test.shown(), found.clone());
        let text = serde_json::to_string_pretty(&*measured).expect("plain data");
        write(&self.store.join("tests.json"), &text)?;
        Ok(found)
    }

    /// Runs a test, with one of the library's variables set.
    ///
    /// # Errors
    /// Where its program cannot be run.
    pub fn run(&self, test: &Test, (variable, folder): (&str, &Path), limit: Duration) -> Result<Outcome, String> {
        let program = &self.programs[&test.program];
        let unable = |error: std::io::Error| format!("{}: {error}", program.path.display());
        let mut child = Command::new(&program.path)
            .args(["--exact", &test.name])
            .current_dir(&program.folder)
            .env(variable, folder)
            // Where there is no adapter nothing would be noticed.
            .env("ANTUMBRA_REQUIRE_ADAPTER", "1")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(unable)?;
        let begun = Instant::now();
        loop {
            if let Some(status) = child.try_wait().map_err(unable)? {
                return Ok(if status.success() { Outcome::Passed } else { Outcome::Failed });
            }
            if begun.elapsed() > limit {
                child.kill().and_then(|()| child.wait().map(|_| ())).map_err(unable)?;
                return Ok(Outcome::TimedOut);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// Builds the tests of library and laboratory with the library's feature `mutants`.
fn build(root: &Path, is_wide: bool) -> Result<BTreeMap<String, Program>, String> {
    let packages = ["--package", "antumbra", "--package", "antumbra-lab"];
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["test", "--no-run", "--locked", "--features", "antumbra/mutants", "--lib"])
        .args(is_wide.then_some("--tests"))
        .args(packages)
        .arg("--message-format=json-render-diagnostics")
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo cannot be run: {error}"))?;
    if !output.status.success() {
        return Err("the tests do not build".to_owned());
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
        // A package's own tests are those of its library, which has its name.
        let program = if target.replace('_', "-") == package { package } else { format!("{package} {target}") };
        programs.insert(program, Program { path: path.into(), folder });
    }
    Ok(programs)
}
