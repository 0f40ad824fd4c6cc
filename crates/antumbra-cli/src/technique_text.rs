//! Descriptions of techniques as plain text.

use antumbra::TechniqueKind;

/// Removes Markdown's code marks.
pub fn plain(text: &str) -> String {
    text.replace('`', "")
}

/// List of all techniques with their uses, for `--help`.
pub fn techniques_help() -> String {
    let rows = TechniqueKind::ALL.iter().map(|kind| format!("  {:20} {}\n", kind.name(), plain(kind.facts().good_for)));
    format!("Good for:\n{}\n`antumbra techniques` also lists where each fails.", rows.collect::<String>())
}
