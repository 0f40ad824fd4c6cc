//! For `cargo xtask mutants`, which asks of a changed shader whether any test notices: the tests are built once, and take
//! a shader's text when they run.
//!
//! Compiled by the feature `mutants` alone, which no host has a use for. Two environment variables name folders:
//! [`CHANGED`] holds texts in place of the linked ones, [`SEEN`] gets an empty file for each shader that was asked for.

use std::borrow::Cow;
use std::path::PathBuf;

/// Texts in place of linked ones, by the paths that [`file_of`] gives.
const CHANGED: &str = "ANTUMBRA_MUTANTS_CHANGED";

/// Where to note which shaders a program asked for, by the same paths with `=` for `/`.
const SEEN: &str = "ANTUMBRA_MUTANTS_SEEN";

/// What to use in place of a linked shader: a changed text where there is one.
pub(crate) fn text_of(linked: &'static str) -> Cow<'static, str> {
    let folder = |name| std::env::var_os(name).map(PathBuf::from);
    let file = file_of(linked);
    if let Some(seen) = folder(SEEN) {
        let note = seen.join(file.replace('/', "="));
        std::fs::write(&note, "").unwrap_or_else(|error| panic!("{}: {error}", note.display()));
    }
    match folder(CHANGED).map(|changed| changed.join(file)) {
        Some(changed) if changed.exists() => Cow::Owned(
            std::fs::read_to_string(&changed).unwrap_or_else(|error| panic!("{}: {error}", changed.display())),
        ),
        _ => Cow::Borrowed(linked),
    }
}

/// Where a shader's text lies in the folder, by its first line, `// Linked from src/PATH.wesl with FEATURES by ...`:
/// `PATH.FEATURES.wgsl`.
fn file_of(linked: &str) -> String {
    let named = linked.strip_prefix("// Linked from src/").and_then(|rest| rest.split_once(" by `"));
    let (source, _) = named.expect("the linker's first line");
    let (path, features) = source.split_once(" with ").unwrap_or((source, ""));
    let path = path.trim_end_matches(".wesl");
    if features.is_empty() { format!("{path}.wgsl") } else { format!("{path}.{features}.wgsl") }
}
