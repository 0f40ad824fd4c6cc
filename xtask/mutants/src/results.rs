//! Verdicts of mutants, in a file that grows by a line per mutant, so that an interrupted run can be resumed.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::places::Change;

/// Readable description of a change, and its key: it stays the same while other lines move.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Mutant {
    /// Path of the source under `src/`.
    pub file: String,
    /// Text of the line, without indentation.
    pub text: String,
    /// Column in that text, from 1; and the number of earlier lines with the same text.
    pub column: usize,
    pub repeat: usize,
    pub from: String,
    pub to: String,
}

impl Mutant {
    pub fn new(file: &str, source: &str, change: &Change) -> Self {
        let begin = source[..change.start].rfind('\n').map_or(0, |at| at + 1);
        let end = source[change.start..].find('\n').map_or(source.len(), |at| change.start + at);
        let line = &source[begin..end];
        let text = line.trim();
        let indent = line.len() - line.trim_start().len();
        Self {
            file: file.to_owned(),
            text: text.to_owned(),
            column: change.start - begin - indent + 1,
            repeat: source[..begin].lines().filter(|other| other.trim() == text).count(),
            from: source[change.start..change.end].to_owned(),
            to: change.to.clone(),
        }
    }

    /// Returns its line in the current source, from 1; `None` if it is gone.
    pub fn line_in(&self, source: &str) -> Option<usize> {
        let same = source.lines().enumerate().filter(|(_, line)| line.trim() == self.text);
        same.map(|(at, _)| at + 1).nth(self.repeat)
    }
}

/// Verdict on a mutant.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MutantOutcome {
    /// It does not compile, or no shader changes. Contains the reason.
    Invalid(String),
    /// Killed by this test.
    Killed(String),
    /// This test exceeded its time limit.
    Hangs(String),
    /// Survived this number of tests.
    Survived(usize),
}

/// Line of the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    pub mutant: Mutant,
    pub fate: MutantOutcome,
    pub seconds: f64,
}

/// File of verdicts.
pub struct Results {
    path: PathBuf,
    pub entries: Vec<Entry>,
}

impl Results {
    /// Reads the results of earlier runs. If a mutant was judged again, the last verdict counts.
    ///
    /// # Errors
    /// If a line is invalid.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let lines = text.lines().map(serde_json::from_str::<Entry>).collect::<Result<Vec<_>, _>>();
        let lines = lines.map_err(|error| format!("{}: {error}", path.display()))?;
        let mut results = Self { path: path.to_owned(), entries: Vec::new() };
        lines.into_iter().for_each(|entry| results.put(entry));
        Ok(results)
    }

    pub fn fate_of(&self, mutant: &Mutant) -> Option<&MutantOutcome> {
        self.entries.iter().find(|entry| entry.mutant == *mutant).map(|entry| &entry.fate)
    }

    fn put(&mut self, entry: Entry) {
        self.entries.retain(|other| other.mutant != entry.mutant);
        self.entries.push(entry);
    }

    /// Adds a line to the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, entry: Entry) -> Result<(), String> {
        let line = serde_json::to_string(&entry).expect("plain data");
        std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(&self.path)
            .and_then(|mut file| writeln!(file, "{line}"))
            .map_err(|error| format!("cannot write {}: {error}", self.path.display()))?;
        self.put(entry);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "fn f() {\n    a = 1.0;\n}\nfn g() {\n    a = 1.0;\n}\n";

    #[test]
    fn a_mutant_is_found_again_when_lines_move() {
        let start = SOURCE.rfind("1.0").expect("there");
        let mutant = Mutant::new("a.wesl", SOURCE, &Change { start, end: start + 3, to: "0.0".to_owned() });
        assert_eq!((mutant.text.as_str(), mutant.column, mutant.repeat), ("a = 1.0;", 5, 1));
        assert_eq!(mutant.from, "1.0");
        assert_eq!(mutant.line_in(SOURCE), Some(5));
        assert_eq!(mutant.line_in(&format!("// More.\n{SOURCE}")), Some(6));
        assert_eq!(mutant.line_in("fn f() {}"), None);
    }

    #[test]
    fn the_newest_result_replaces_earlier_ones() {
        let path = std::env::temp_dir().join(format!("antumbra-mutants-{}", std::process::id()));
        let change = Change { start: 0, end: 2, to: String::new() };
        let mutant = Mutant::new("a.wesl", SOURCE, &change);
        let mut results = Results::read(&path).expect("none yet");
        for fate in [MutantOutcome::Survived(3), MutantOutcome::Killed("a test".to_owned())] {
            results.add(Entry { mutant: mutant.clone(), fate, seconds: 1.0 }).expect("a temporary folder");
        }
        let read = Results::read(&path);
        std::fs::remove_file(&path).expect("ours");
        let read = read.expect("ours");
        assert_eq!(read.entries.len(), 1);
        assert_eq!(read.fate_of(&mutant), Some(&MutantOutcome::Killed("a test".to_owned())));
    }
}
