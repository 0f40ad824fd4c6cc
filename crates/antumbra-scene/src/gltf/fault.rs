//! Faults inside a glTF file, before the file's name is known.

use crate::SceneError;

/// Fault in a file: place, problem and remedy.
#[derive(Debug)]
pub(super) struct Fault {
    place: String,
    problem: String,
    remedy: String,
    /// Whether the file is valid, but its data must come from elsewhere.
    absent: bool,
}

pub(super) type Result<T> = std::result::Result<T, Fault>;

impl Fault {
    pub(super) fn new(place: impl Into<String>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: place.into(), problem: problem.into(), remedy: remedy.into(), absent: false }
    }

    /// Fault about data that the specification allows a file to lack.
    pub(super) fn absent(place: impl Into<String>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { absent: true, ..Self::new(place, problem, remedy) }
    }

    /// Whether the fault is [`Self::absent`]: whatever needs the data may be left out.
    pub(super) fn is_absent(&self) -> bool {
        self.absent
    }

    /// Fault about an index past the end of its list.
    pub(super) fn unresolved(place: impl Into<String>, list: &str, index: usize, len: usize) -> Self {
        let remedy = match len {
            0 => format!("the file has no {list}"),
            _ => format!("expected an index from 0 to {}", len - 1),
        };
        Self::new(place, format!("refers to {list}[{index}], which does not exist"), remedy)
    }

    /// Turns the fault into an error that names the file.
    pub(super) fn within(self, origin: &str) -> SceneError {
        SceneError::Invalid { origin: origin.to_owned(), place: self.place, problem: self.problem, remedy: self.remedy }
    }

    /// Formats the fault as a warning; `consequence` says what is left out.
    pub(super) fn as_warning(&self, consequence: &str) -> String {
        format!("{}: {}; {consequence}", self.place, self.problem)
    }
}

/// Quotes a string of the file on one line, shortened if long, because a data URI may have megabytes.
pub(super) fn quoted(text: &str) -> String {
    /// Largest number of characters: enough to recognise a path.
    const LONGEST: usize = 80;
    let mut shown: String = text.chars().take(LONGEST).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    format!("{shown:?}")
}
