//! Facts of techniques as plain text.

use antumbra::TechniqueKind;

/// Text without Markdown's marks of code.
pub fn plain(text: &str) -> String {
    text.replace('`', "")
}

/// List of all techniques for `--help`: names with what each is for.
pub fn techniques_help() -> String {
    let rows = TechniqueKind::ALL.iter().map(|kind| format!("  {:20} {}\n", kind.name(), plain(kind.facts().good_for)));
    format!("Good for:\n{}\n`antumbra techniques` says where each fails, too.", rows.collect::<String>())
}
