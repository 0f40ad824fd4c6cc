//! Shader replacement for `cargo xtask mutants`, which checks whether a test detects a changed shader. The tests are
//! built once and load shader texts at run time.
//!
//! Compiled only with the feature `mutants`, which hosts do not need. Two environment variables name folders: [`CHANGED`]
//! contains texts that replace linked ones, [`SEEN`] receives an empty file for each requested shader.

use std::borrow::Cow;
use std::path::PathBuf;

/// Environment variable: folder of replacement texts, at the paths that [`file_of`] returns.
const CHANGED: &str = "ANTUMBRA_MUTANTS_CHANGED";

/// Environment variable: folder for the names of requested shaders, the same paths with `=` for `/`.
const SEEN: &str = "ANTUMBRA_MUTANTS_SEEN";

/// Returns the text of a linked shader, or its replacement if there is one.
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

/// Returns the path of a shader's text in the folder, `PATH.FEATURES.wgsl`, from its first line:
/// `// Linked from src/PATH.wesl with FEATURES by ...`.
fn file_of(linked: &str) -> String {
    let named = linked.strip_prefix("// Linked from src/").and_then(|rest| rest.split_once(" by `"));
    let (source, _) = named.expect("the linker's first line");
    let (path, features) = source.split_once(" with ").unwrap_or((source, ""));
    let path = path.trim_end_matches(".wesl");
    if features.is_empty() { format!("{path}.wgsl") } else { format!("{path}.{features}.wgsl") }
}
