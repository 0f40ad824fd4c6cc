//! Which of the tests that could see a mutant are asked, in which order, and what they say.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::sources::Folder;
use crate::suite::{Outcome, Suite, Test};

/// A test may take this many times as long as it does with nothing changed, and [`SPARE`] more, before it is said to hang.
const PATIENCE: f64 = 8.0;

/// What a busy machine may add.
const SPARE: Duration = Duration::from_secs(20);

/// What the tests say of a mutant.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The test that failed, or ran on without an end.
    Killed { by: String, hangs: bool },
    /// How many tests passed.
    Survived { asked: usize },
}

/// How often each test was asked and failed.
#[derive(Default)]
pub struct Record(Mutex<BTreeMap<String, (f64, f64)>>);

impl Record {
    /// Notes that a test was asked.
    pub fn note(&self, test: &str, failed: bool) {
        let mut record = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (asked, kills) = record.entry(test.to_owned()).or_default();
        *asked += 1.0;
        *kills += if failed { 1.0 } else { 0.0 };
    }

    /// The chance that a test kills a mutant of a source, to begin with that of one beside it or not, for each second.
    fn worth(&self, test: &Test, seconds: f64, source: &str) -> f64 {
        let record = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (asked, kills) = record.get(&test.shown()).copied().unwrap_or_default();
        let shared = test.name.split("::").zip(source.split('/')).take_while(|(a, b)| a == b).count();
        let at_first = [0.1, 0.2, 0.5, 0.6][shared.min(3)];
        (kills + 4.0 * at_first) / (asked + 4.0) / seconds.max(0.05)
    }
}

/// What a test takes of which nothing is known yet.
const USUAL_S: f64 = 2.0;

/// Asks the tests, the most promising first, until one fails, or they have taken `seconds` in all. What a test uses is
/// found when it is first asked, by running it with nothing changed.
///
/// # Errors
/// Where a test program cannot be run, or a test fails with nothing changed.
pub fn judge(
    suite: &Suite,
    record: &Record,
    folder: &Folder,
    source: &str,
    shaders: &BTreeSet<String>,
    seconds: f64,
) -> Result<Verdict, String> {
    let mut tests: Vec<(f64, &Test)> = suite
        .tests
        .iter()
        .filter_map(|test| match suite.known(test) {
            Some(known) if known.shaders.is_disjoint(shaders) => None,
            known => Some((record.worth(test, known.map_or(USUAL_S, |known| known.seconds), source), test)),
        })
        .collect();
    tests.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (begun, mut asked) = (Instant::now(), 0);
    for (_, test) in tests {
        if begun.elapsed().as_secs_f64() > seconds {
            break;
        }
        let known = suite.known(test).map_or_else(|| suite.measure(test), Ok)?;
        if known.shaders.is_disjoint(shaders) {
            continue;
        }
        asked += 1;
        let limit = Duration::from_secs_f64(PATIENCE * known.seconds) + SPARE;
        let outcome = suite.run(test, ("ANTUMBRA_MUTANTS_CHANGED", &folder.changed), limit)?;
        record.note(&test.shown(), outcome != Outcome::Passed);
        if outcome != Outcome::Passed {
            return Ok(Verdict::Killed { by: test.shown(), hangs: outcome == Outcome::TimedOut });
        }
    }
    Ok(Verdict::Survived { asked })
}
