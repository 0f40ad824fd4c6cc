//! Run of mutation tests: named changes, then the seed's, by one worker or several, until the requested number is reached.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::Options;
use crate::choice::order_of;
use crate::judge::{Record, Verdict, judge};
use crate::named;
use crate::places::{Change, changes_of};
use crate::report;
use crate::results::{Entry, Mutant, MutantOutcome, Results};
use crate::sources::{Folder, MutationEffect, Sources};
use crate::suite::Suite;

/// Returns the workspace's root.
pub fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).expect("xtask/mutants").to_owned()
}

/// Change that may be made.
#[derive(Debug)]
struct Candidate {
    mutant: Mutant,
    change: Change,
    /// Whether it is one of the named changes.
    is_named: bool,
}

/// Judges the requested number of mutants, and writes the page or checks that there is a reason for each survivor.
///
/// # Errors
/// If tests do not build or fail without a change, files cannot be read or written, or a check finds a survivor without a reason.
pub fn run(options: &Options) -> Result<(), String> {
    let root = root();
    let store = root.join(if options.check { "target/mutants/check" } else { "target/mutants" });
    std::fs::create_dir_all(&store).map_err(|error| format!("{}: {error}", store.display()))?;
    if options.anew {
        for file in ["results.jsonl", "tests.json"] {
            let _ = std::fs::remove_file(store.join(file));
        }
    }
    let sources = Sources::read()?;
    let candidates = candidates(options, &sources, &root)?;
    let results = Results::read(&store.join("results.jsonl"))?;
    let work = Work { options, sources: &sources, candidates: &candidates, state: Mutex::new(State::new(results)) };
    if !options.report {
        let suite = Suite::new(&root, &store, options.wide)?;
        eprintln!("{} tests", suite.tests.len());
        suite.learn(&Folder::new(&store.join("worker-0"), &sources)?)?;
        work.all(&suite, &store)?;
    }
    let state = work.state();
    let outcome = outcome(options, &root, &work, &state)?;
    if options.check { report::check(&root, &outcome) } else { report::write(&root, &outcome) }
}

/// Returns the named changes, then all others of the requested sources in the seed's order.
fn candidates(options: &Options, sources: &Sources, root: &Path) -> Result<Vec<Candidate>, String> {
    let mut candidates = Vec::new();
    for named in named::read(root)? {
        let change = named.change(sources)?;
        let mutant = Mutant::new(&named.file, &sources.texts[&named.file], &change);
        candidates.push(Candidate { mutant, change, is_named: true });
    }
    let files: Vec<_> = sources.texts.iter().filter(|(file, _)| file.starts_with(&options.only)).collect();
    let changes = files
        .iter()
        .map(|(file, text)| changes_of(text).map_err(|error| format!("{file}: {error}")))
        .collect::<Result<Vec<_>, _>>()?;
    let counts: Vec<(&str, usize)> =
        files.iter().zip(&changes).map(|((file, _), changes)| (file.as_str(), changes.len())).collect();
    eprintln!("{} changes in {} sources", changes.iter().map(Vec::len).sum::<usize>(), files.len());
    for (file, change) in order_of(options.seed, &counts) {
        let (change, (file, text)) = (changes[file][change].clone(), files[file]);
        candidates.push(Candidate { mutant: Mutant::new(file, text, &change), change, is_named: false });
    }
    Ok(candidates)
}

struct Work<'a> {
    options: &'a Options,
    sources: &'a Sources,
    candidates: &'a [Candidate],
    state: Mutex<State>,
}

struct State {
    results: Results,
    /// Index of the next candidate.
    next: usize,
    /// Number of candidates taken that are mutants, or may be; at most the requested number.
    taken: usize,
    /// Number judged in this run, and its start.
    judged: usize,
    begun: Instant,
}

impl State {
    fn new(results: Results) -> Self {
        Self { results, next: 0, taken: 0, judged: 0, begun: Instant::now() }
    }
}

impl Work<'_> {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn all(&self, suite: &Suite, store: &Path) -> Result<(), String> {
        let record = Record::default();
        for entry in &self.state().results.entries {
            if let MutantOutcome::Killed(by) | MutantOutcome::Hangs(by) = &entry.fate {
                record.note(by, true);
            }
        }
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..self.options.jobs)
                .map(|i| {
                    let (record, path) = (&record, store.join(format!("worker-{i}")));
                    scope.spawn(move || self.worker(suite, record, &path))
                })
                .collect();
            workers.into_iter().try_for_each(|worker| worker.join().expect("a worker does not panic"))
        })
    }

    fn worker(&self, suite: &Suite, record: &Record, path: &Path) -> Result<(), String> {
        let folder = Folder::new(path, self.sources)?;
        while let Some(candidate) = self.take() {
            let begun = Instant::now();
            let fate = self.fate(suite, record, &folder, candidate)?;
            let seconds = begun.elapsed().as_secs_f64();
            let entry = Entry { mutant: candidate.mutant.clone(), fate, seconds };
            let mut state = self.state();
            state.judged += 1;
            self.tell(&state, &entry);
            if matches!(entry.fate, MutantOutcome::Invalid(_)) && !candidate.is_named {
                state.taken -= 1;
            }
            state.results.add(entry)?;
        }
        Ok(())
    }

    /// Returns the next candidate to judge. Mutants judged in earlier runs count towards the requested number.
    fn take(&self) -> Option<&Candidate> {
        let mut state = self.state();
        loop {
            let candidate = self.candidates.get(state.next)?;
            if !candidate.is_named && state.taken == self.options.count {
                return None;
            }
            state.next += 1;
            let known = state.results.fate_of(&candidate.mutant).cloned();
            let is_mutant = !matches!(known, Some(MutantOutcome::Invalid(_)));
            state.taken += usize::from(is_mutant && !candidate.is_named);
            match known {
                None => return Some(candidate),
                Some(MutantOutcome::Survived(_)) if self.options.again => return Some(candidate),
                Some(_) => {}
            }
        }
    }

    fn fate(
        &self,
        suite: &Suite,
        record: &Record,
        folder: &Folder,
        candidate: &Candidate,
    ) -> Result<MutantOutcome, String> {
        let file = &candidate.mutant.file;
        let shaders = match self.sources.make(folder, file, &candidate.change)? {
            MutationEffect::Nothing(why) => return Ok(MutantOutcome::Invalid(why.to_owned())),
            MutationEffect::Shaders(shaders) => shaders,
        };
        folder.put(&shaders)?;
        // The named changes are known to be hard to detect, so their tests get more time.
        let seconds = if candidate.is_named { 20.0 } else { 1.0 } * self.options.seconds;
        let names: BTreeSet<String> = shaders.into_keys().collect();
        Ok(match judge(suite, record, folder, file, &names, seconds)? {
            Verdict::Killed { by, hangs: false } => MutantOutcome::Killed(by),
            Verdict::Killed { by, hangs: true } => MutantOutcome::Hangs(by),
            Verdict::Survived { asked } => MutantOutcome::Survived(asked),
        })
    }

    fn tell(&self, state: &State, entry: &Entry) {
        let Mutant { file, text, column, from, to, .. } = &entry.mutant;
        let each = state.begun.elapsed().as_secs_f64() / state.judged as f64;
        let left = each * (self.options.count - state.taken.min(self.options.count)) as f64 / 60.0;
        let fate = match &entry.fate {
            MutantOutcome::Invalid(why) => why.clone(),
            MutantOutcome::Killed(by) => format!("killed by {by}"),
            MutantOutcome::Hangs(by) => format!("ran on in {by}"),
            MutantOutcome::Survived(asked) => format!("SURVIVED {asked} tests"),
        };
        let (taken, count) = (state.taken, self.options.count);
        eprintln!(
            "[{taken}/{count}, {each:.1} s each, {left:.0} min left] {file}: {text} @{column} {from} → {to}: {fate}"
        );
    }
}

/// Returns the options and results of a run.
fn outcome<'a>(
    options: &Options,
    root: &Path,
    work: &'a Work<'_>,
    state: &'a State,
) -> Result<report::Run<'a>, String> {
    let mut run = report::Run {
        command: options.command(),
        commit: commit(root),
        seconds: options.seconds,
        sources: work.sources,
        judged: Vec::new(),
        invalid: 0,
        named: Vec::new(),
    };
    for (candidate, named) in work.candidates.iter().zip(named::read(root)?) {
        run.named.push((named.what, state.results.fate_of(&candidate.mutant).cloned()));
    }
    for candidate in work.candidates.iter().filter(|candidate| !candidate.is_named) {
        if run.judged.len() == options.count {
            break;
        }
        match state.results.fate_of(&candidate.mutant) {
            Some(MutantOutcome::Invalid(_)) => run.invalid += 1,
            Some(fate) => run.judged.push((&candidate.mutant, fate)),
            None => {}
        }
    }
    Ok(run)
}

fn commit(root: &Path) -> String {
    let output = Command::new("git").args(["rev-parse", "--short", "HEAD"]).current_dir(root).output();
    output.map_or_else(|_| "unknown".to_owned(), |output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
