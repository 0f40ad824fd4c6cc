//! Paths of a report's files in its folder.

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
