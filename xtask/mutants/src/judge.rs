//! Tests of a mutant: which ones run, in which order, and their verdict.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::sources::Folder;
use crate::suite::{Measured, Outcome, Suite, Test};

/// Time limit of a test, as a multiple of its passing time, before [`SPARE`] is added. Beyond it the test counts as hanging.
const PATIENCE: f64 = 8.0;

/// Additional time for a busy machine.
const SPARE: Duration = Duration::from_secs(20);

/// Verdict of the tests on a mutant.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The test that failed or exceeded its time limit.
    Killed { by: String, hangs: bool },
    /// Number of tests that passed.
    Survived { asked: usize },
}

/// Number of runs and failures of each test.
#[derive(Default)]
pub struct Record(Mutex<BTreeMap<String, (f64, f64)>>);

impl Record {
    /// Records a run of a test.
    pub fn note(&self, test: &str, failed: bool) {
        let mut record = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (asked, kills) = record.entry(test.to_owned()).or_default();
        *asked += 1.0;
        *kills += if failed { 1.0 } else { 0.0 };
    }

    /// Returns the probability that a test kills a mutant, with the prior `at_first`, per second of its run time.
    fn worth(&self, test: &Test, seconds: f64, at_first: f64) -> f64 {
        let record = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (asked, kills) = record.get(&test.shown()).copied().unwrap_or_default();
        (kills + 4.0 * at_first) / (asked + 4.0) / seconds.max(0.05)
    }
}

/// Returns the prior of a test without runs. It is high for tests in the module of the source, for tests that use little else than the
/// changed shaders, and for tests with golden masks.
fn at_first(test: &Test, known: Option<&Measured>, source: &str, shaders: &BTreeSet<String>) -> f64 {
    if test.is_golden() {
        return 0.5;
    }
    let shared = test.name.split("::").zip(source.split('/')).take_while(|(a, b)| a == b).count();
    let beside: f64 = [0.1, 0.2, 0.5, 0.6][shared.min(3)];
    let alone = known
        .map_or(0.0, |known| known.shaders.intersection(shaders).count() as f64 / known.shaders.len().max(1) as f64);
    beside.max(0.6 * alone)
}

/// Assumed run time of an unmeasured test, seconds.
const USUAL_S: f64 = 2.0;

/// Time limit of an unmeasured test, seconds, before it moves behind all others.
const AT_FIRST_S: f64 = 20.0;

/// Returns the tests that may use one of the shaders, the most promising first.
fn most_promising<'s>(suite: &'s Suite, record: &Record, source: &str, shaders: &BTreeSet<String>) -> Vec<&'s Test> {
    let mut tests: Vec<(f64, &Test)> = suite
        .tests
        .iter()
        .filter_map(|test| match suite.known(test) {
            Some(known) if known.shaders.is_disjoint(shaders) => None,
            known => {
                let at_first = at_first(test, known.as_ref(), source, shaders);
                Some((record.worth(test, known.map_or(USUAL_S, |known| known.seconds), at_first), test))
            }
        })
        .collect();
    tests.sort_by(|a, b| b.0.total_cmp(&a.0));
    tests.into_iter().map(|(_, test)| test).collect()
}

/// Runs the tests, the most promising first, until one fails or `seconds` have passed in total. The shaders that a test uses are recorded
/// at its first run.
///
/// # Errors
/// If a test program cannot be run, or a test fails without a change.
pub fn judge(
    suite: &Suite,
    record: &Record,
    folder: &Folder,
    source: &str,
    shaders: &BTreeSet<String>,
    seconds: f64,
) -> Result<Verdict, String> {
    let (begun, mut asked) = (Instant::now(), 0);
    for test in most_promising(suite, record, source, shaders) {
        if begun.elapsed().as_secs_f64() > seconds {
            break;
        }
        let known = suite.known(test);
        if known.as_ref().is_some_and(|known| known.seconds > seconds) {
            continue;
        }
        let limit = known.as_ref().map_or(Duration::from_secs_f64(seconds.min(AT_FIRST_S)), |known| {
            Duration::from_secs_f64(PATIENCE * known.seconds) + SPARE
        });
        let ran = suite.run(test, folder, true, limit)?;
        // The test may hang, but is more likely slow, so faster tests run first.
        if known.is_none() && ran.outcome == Outcome::TimedOut {
            suite.keep(test, Measured { seconds: 2.0 * AT_FIRST_S, shaders: ran.shaders })?;
            continue;
        }
        if ran.shaders.is_disjoint(shaders) {
            continue;
        }
        asked += 1;
        record.note(&test.shown(), ran.outcome != Outcome::Passed);
        if ran.outcome == Outcome::Passed {
            continue;
        }
        // A failure counts only if the test passes without the change.
        if known.is_none() {
            match suite.run(test, folder, false, limit)?.outcome {
                Outcome::Passed => {}
                Outcome::Failed => return Err(format!("`{}` fails without a mutation; fix it first", test.shown())),
                Outcome::TimedOut => {
                    suite.keep(test, Measured { seconds: 2.0 * AT_FIRST_S, shaders: ran.shaders })?;
                    continue;
                }
            }
        }
        return Ok(Verdict::Killed { by: test.shown(), hangs: ran.outcome == Outcome::TimedOut });
    }
    Ok(Verdict::Survived { asked })
}
