//! What is wrong inside a glTF file, before the file's name is known.

use crate::SceneError;

/// One contradiction: where in the file, what, and what would be right.
#[derive(Debug)]
pub(super) struct Fault {
    place: String,
    problem: String,
    remedy: String,
    /// The file is in order, but its data is to come from elsewhere.
    absent: bool,
}

pub(super) type Result<T> = std::result::Result<T, Fault>;

impl Fault {
    pub(super) fn new(place: impl Into<String>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: place.into(), problem: problem.into(), remedy: remedy.into(), absent: false }
    }

    /// Data that the specification allows to be nowhere in the file.
    pub(super) fn absent(place: impl Into<String>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { absent: true, ..Self::new(place, problem, remedy) }
    }

    /// Whether it is [`Self::absent`]: what needs the data may be left out.
    pub(super) fn is_absent(&self) -> bool {
        self.absent
    }

    /// An index that points past the end of its list.
    pub(super) fn unresolved(place: impl Into<String>, list: &str, index: usize, len: usize) -> Self {
        let remedy = match len {
            0 => format!("the file has no {list} at all"),
            _ => format!("an index from 0 to {} is right", len - 1),
        };
        Self::new(place, format!("refers to {list}[{index}], which does not exist"), remedy)
    }

    /// Names the file.
    pub(super) fn within(self, origin: &str) -> SceneError {
        SceneError::Invalid { origin: origin.to_owned(), place: self.place, problem: self.problem, remedy: self.remedy }
    }

    /// The same as a warning about something that is left out.
    pub(super) fn as_warning(&self, consequence: &str) -> String {
        format!("{}: {}; {consequence}", self.place, self.problem)
    }
}

/// A string of the file, shown on one line and cut where it is long: a data URI may have megabytes.
pub(super) fn quoted(text: &str) -> String {
    /// Enough to recognise a path.
    const LONGEST: usize = 80;
    let mut shown: String = text.chars().take(LONGEST).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    format!("{shown:?}")
}
