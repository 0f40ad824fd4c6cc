//! Paths of a report's files in its folder.

use std::collections::BTreeSet;

use crate::motion::Motion;

pub(super) const REFERENCE_STEM: &str = "reference";
pub(super) const JUDGED_PATH: &str = "images/judged.png";
/// Path of the numbers.
pub const METRICS_PATH: &str = "metrics.json";
pub(super) const VALUES_PATH: &str = "values.js";
pub(super) const PAGE_PATH: &str = "index.html";

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

/// Path of a motion's strip.
pub(super) fn motion_path(stem: &str, motion: Motion) -> String {
    format!("images/{stem}_motion_{}.png", motion.name())
}

/// Returns every file that a report of these techniques and motions may have, relative to its folder.
pub fn report_paths(techniques: &[String], motions: &[Motion]) -> Vec<String> {
    let mut paths = [METRICS_PATH, VALUES_PATH, PAGE_PATH, JUDGED_PATH].map(str::to_owned).to_vec();
    let stems = stems_of(techniques.iter().map(String::as_str));
    for stem in std::iter::once(REFERENCE_STEM.to_owned()).chain(stems) {
        paths.extend([shaded_path(&stem), visibility_path(&stem), visibility_exr_path(&stem), error_path(&stem)]);
        paths.extend(motions.iter().map(|motion| motion_path(&stem, *motion)));
    }
    paths
}

/// Returns a name per technique for files and anchors: its own, with repeated ones numbered.
pub(super) fn stems_of<'a>(techniques: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut used = BTreeSet::from([REFERENCE_STEM.to_owned()]);
    let mut stems = Vec::new();
    for technique in techniques {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' };
        let name: String = technique.chars().map(plain).collect();
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let stem = std::iter::once(name.clone()).chain(numbered).find(|stem| !used.contains(stem));
        let stem = stem.expect("there are more numbers than rows");
        used.insert(stem.clone());
        stems.push(stem);
    }
    stems
}
