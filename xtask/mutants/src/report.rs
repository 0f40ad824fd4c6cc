//! Report of the last result: `docs/mutants.md`.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde::Deserialize;

use crate::results::{Mutant, MutantOutcome};
use crate::sources::Sources;

/// First line of the page's part that is written by other programs and kept.
const REST: &str = "## Rust";

/// Reasons why no test can detect a mutant: `reasons.toml`.
#[derive(Debug, Deserialize)]
struct Reasons {
    #[serde(default)]
    reason: Vec<Reason>,
}

#[derive(Debug, Deserialize)]
struct Reason {
    file: String,
    text: String,
    from: String,
    to: String,
    why: String,
}

/// Options and results of a run.
pub struct Run<'a> {
    pub command: String,
    pub commit: String,
    /// Time limit of the tests of a mutant, seconds.
    pub seconds: f64,
    pub sources: &'a Sources,
    /// Mutants that compile, with their verdicts.
    pub judged: Vec<(&'a Mutant, &'a MutantOutcome)>,
    pub invalid: usize,
    /// Named changes, with their verdicts; `None` if not run.
    pub named: Vec<(String, Option<MutantOutcome>)>,
}

impl Reasons {
    fn read(root: &Path) -> Result<Self, String> {
        let path = root.join("xtask/mutants/reasons.toml");
        std::fs::read_to_string(&path)
            .map_err(|error| error.to_string())
            .and_then(|text| toml::from_str(&text).map_err(|error| error.to_string()))
            .map_err(|error| format!("{}: {error}", path.display()))
    }

    fn of(&self, mutant: &Mutant) -> Option<&str> {
        let is_it = |reason: &&Reason| {
            (&reason.file, &reason.text, &reason.from, &reason.to)
                == (&mutant.file, &mutant.text, &mutant.from, &mutant.to)
        };
        self.reason.iter().find(is_it).map(|reason| reason.why.as_str())
    }
}

/// Writes the page.
///
/// # Errors
/// If the reasons cannot be read, or the page cannot be written.
pub fn write(root: &Path, run: &Run<'_>) -> Result<(), String> {
    let path = root.join("docs/mutants.md");
    let before = std::fs::read_to_string(&path).unwrap_or_default();
    let rest = before.find(REST).map_or("", |at| &before[at..]);
    crate::sources::write(&path, &format!("{}{rest}", page(run, &Reasons::read(root)?)))?;
    println!("{}", path.display());
    Ok(())
}

/// Prints the number of killed mutants.
///
/// # Errors
/// If the reasons cannot be read, or a survivor has none, or a named change is not killed.
pub fn check(root: &Path, run: &Run<'_>) -> Result<(), String> {
    let killed = run.judged.iter().filter(|(_, fate)| is_killed(fate)).count();
    println!("{}: {killed} of {} killed", run.command, run.judged.len());
    match &unexplained(&run.judged, &run.named, &Reasons::read(root)?)[..] {
        [] => Ok(()),
        all => Err(format!(
            "no test detects these, and xtask/mutants/reasons.toml has no reason for them: {}",
            all.join("; ")
        )),
    }
}

/// Returns the survivors without a reason, and the named changes that no test detects.
fn unexplained(
    judged: &[(&Mutant, &MutantOutcome)],
    named: &[(String, Option<MutantOutcome>)],
    reasons: &Reasons,
) -> Vec<String> {
    let survivors = judged.iter().filter(|(mutant, fate)| !is_killed(fate) && reasons.of(mutant).is_none());
    let named = named.iter().filter(|(_, fate)| !fate.as_ref().is_some_and(is_killed));
    survivors
        .map(|(Mutant { file, text, column, from, to, .. }, _)| format!("{file}: {text} @{column} {from} → {to}"))
        .chain(named.map(|(what, _)| what.clone()))
        .collect()
}

fn page(run: &Run<'_>, reasons: &Reasons) -> String {
    let mut page = head(run);
    table_of_named(&mut page, run);
    table_of_survivors(&mut page, run, reasons);
    table_of_sources(&mut page, run);
    page
}

fn is_killed(fate: &MutantOutcome) -> bool {
    matches!(fate, MutantOutcome::Killed(_) | MutantOutcome::Hangs(_))
}

fn head(run: &Run<'_>) -> String {
    let made = run.judged.len();
    let killed = run.judged.iter().filter(|(_, fate)| is_killed(fate)).count();
    let hung = run.judged.iter().filter(|(_, fate)| matches!(fate, MutantOutcome::Hangs(_))).count();
    let sources: std::collections::BTreeSet<_> = run.judged.iter().map(|(mutant, _)| &mutant.file).collect();
    format!(
        "\
# Mutation tests

How well the tests detect faults in shaders. `{command}` at commit {commit} changed one operator, comparison or number of a shader at a
time, chosen by seed over all sources, linked the shaders that import it, and ran the tests of library and laboratory that use one of them:
the most promising first, until one failed or {seconds} s had passed. A survivor has passed only those tests. CONTRIBUTING.md says how to run it.

**{killed} of {made} killed, {percent:.1} %**, {hung} of them by a time limit. They are from {files} of the {all} sources. {invalid} further changes did not
compile or changed no shader, and are not counted.

",
        command = run.command,
        commit = run.commit,
        seconds = run.seconds,
        percent = 100.0 * killed as f64 / made.max(1) as f64,
        files = sources.len(),
        all = run.sources.texts.len(),
        invalid = run.invalid,
    )
}

fn table_of_named(page: &mut String, run: &Run<'_>) {
    page.push_str("## Changes that once passed all tests\n\n| change | killed by |\n|---|---|\n");
    for (what, fate) in &run.named {
        let by = match fate {
            Some(MutantOutcome::Killed(by) | MutantOutcome::Hangs(by)) => format!("`{by}`"),
            Some(MutantOutcome::Survived(asked)) => format!("none of {asked} tests"),
            Some(MutantOutcome::Invalid(why)) => why.clone(),
            None => "not run".to_owned(),
        };
        let _ = writeln!(page, "| {what} | {by} |");
    }
}

fn table_of_survivors(page: &mut String, run: &Run<'_>, reasons: &Reasons) {
    page.push_str(
        "\n## Survivors\n\n| source | line | change | tests run | why no test can detect it |\n|---|---|---|---|---|\n",
    );
    let mut survivors: Vec<_> = run.judged.iter().filter(|(_, fate)| !is_killed(fate)).collect();
    survivors.sort();
    for (mutant, fate) in survivors {
        let why = reasons.of(mutant).unwrap_or("not yet explained");
        let line = mutant.line_in(&run.sources.texts[&mutant.file]).map_or("gone".to_owned(), |line| line.to_string());
        let code = |text: &str| format!("`{}`", text.replace('|', "\\|"));
        let (from, to, text) = (code(&mutant.from), code(&mutant.to), code(&mutant.text));
        let column = mutant.column;
        let asked = if let MutantOutcome::Survived(asked) = fate { *asked } else { 0 };
        let _ = writeln!(page, "| {} | {line}:{column} | {from} → {to} in {text} | {asked} | {why} |", mutant.file);
    }
}

fn table_of_sources(page: &mut String, run: &Run<'_>) {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (mutant, fate) in &run.judged {
        let (made, killed) = counts.entry(&mutant.file).or_default();
        *made += 1;
        *killed += usize::from(is_killed(fate));
    }
    page.push_str("\n## By source\n\n| source | made | killed |\n|---|---|---|\n");
    for (file, (made, killed)) in counts {
        let _ = writeln!(page, "| {file} | {made} | {killed} |");
    }
    page.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survivors_without_a_reason_are_found() {
        let [file, text, from, to] = ["a.wesl", "let b = c + d;", "+", "-"].map(str::to_owned);
        let words = (file.clone(), text.clone(), from.clone(), to.clone());
        let mutant = Mutant { file, text, column: 11, repeat: 0, from, to };
        let [killed, survived] = [MutantOutcome::Killed("a test".into()), MutantOutcome::Survived(3)];
        let none = Reasons { reason: Vec::new() };
        assert!(unexplained(&[(&mutant, &killed)], &[], &none).is_empty());
        assert_eq!(unexplained(&[(&mutant, &survived)], &[], &none), ["a.wesl: let b = c + d; @11 + → -"]);
        let (file, text, from, to) = words;
        let why = "d is zero".to_owned();
        let one = Reasons { reason: vec![Reason { file, text, from, to, why }] };
        assert!(unexplained(&[(&mutant, &survived)], &[], &one).is_empty());
        let named = [("a change".to_owned(), Some(killed)), ("another".to_owned(), Some(survived))];
        assert_eq!(unexplained(&[], &named, &one), ["another"]);
    }
}
