//! Paths of a report's files in its folder.

use std::collections::BTreeSet;

use super::model::Report;
use crate::motion::Motion;

pub(super) const REFERENCE_STEM: &str = "reference";
pub(super) const JUDGED_PATH: &str = "images/judged.png";

pub(super) fn shaded_path(stem: &str) -> String {
    format!("images/{stem}_shaded.png")
}

pub(super) fn visibility_path(stem: &str) -> String {
    format!("images/{stem}_visibility.png")
}

pub(super) fn visibility_exr_path(stem: &str) -> String {
    format!("images/{stem}_visibility.exr")
}

pub(super) fn error_path(stem: &str) -> String {
    format!("images/{stem}_error.png")
}

/// The strip of a motion.
pub(super) fn motion_path(stem: &str, motion: Motion) -> String {
    format!("images/{stem}_motion_{}.png", motion.name())
}

/// A name for each row's files and anchor: the technique's, numbered where it comes more than once.
pub(super) fn row_stems(report: &Report) -> Vec<String> {
    let mut used = BTreeSet::from([REFERENCE_STEM.to_owned()]);
    let mut stems = Vec::new();
    for row in &report.rows {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' };
        let name: String = row.technique.chars().map(plain).collect();
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let stem = std::iter::once(name.clone()).chain(numbered).find(|stem| !used.contains(stem));
        let stem = stem.expect("there are more numbers than rows");
        used.insert(stem.clone());
        stems.push(stem);
    }
    stems
}
