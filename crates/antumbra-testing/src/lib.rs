//! Skipping of tests on machines that lack something: such tests report *skipped*, or fail if the missing part is required.
//!
//! A test runner knows only passed and failed tests, and hides the output of passed ones. So a skip is also written to the file of
//! [`SKIPPED_LIST`], for `cargo xtask test` to count. If [`REQUIRE_ADAPTER`] or `CI` requires an adapter, a missing one is a failure.
//!
//! [`book`] parses the documentation for the tests that check it.

pub mod book;

use std::fmt::Display;
use std::io::Write;
use std::path::PathBuf;

/// Environment variable that makes tests fail without an adapter: `1` yes, `0` no. If it is not set, `CI` decides in the
/// same way. `cargo xtask ci` sets it.
pub const REQUIRE_ADAPTER: &str = "ANTUMBRA_REQUIRE_ADAPTER";

/// Environment variable with a file to which each skipped test adds a line with its reason. `cargo xtask test` sets it.
pub const SKIPPED_LIST: &str = "ANTUMBRA_SKIPPED_LIST";

/// Environment variable with the folder of test scenes, which are not part of the repository.
pub const SCENES: &str = "ANTUMBRA_SCENES";

/// Returns the folder of test scenes: the one in [`SCENES`], or `shared/scenes` beside or inside the workspace. If there is
/// none, reports the test as skipped.
pub fn scenes_folder() -> Option<PathBuf> {
    let workspace = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates = [
        std::env::var_os(SCENES).map(PathBuf::from),
        Some(workspace.join("../shared/scenes")),
        Some(workspace.join("shared/scenes")),
    ];
    let found = candidates.into_iter().flatten().find(|folder| folder.is_dir());
    if found.is_none() {
        skip(format_args!("set {SCENES} to the folder of test scenes"));
    }
    found
}

/// Returns the folder `cases` beside [`scenes_folder`]: small inputs that once failed.
pub fn cases_folder() -> Option<PathBuf> {
    let found = scenes_folder()?.parent().map(|folder| folder.join("cases")).filter(|folder| folder.is_dir());
    if found.is_none() {
        skip("there is no folder `cases` next to that of the test scenes");
    }
    found
}

/// Reports that this test, or a part of it, is skipped.
pub fn skip(reason: impl Display) {
    let line = format!("skipped: {reason}");
    println!("{line}");
    if let Some(list) = std::env::var_os(SKIPPED_LIST) {
        // A single append, because tests in other processes write to the file, too.
        let added = std::fs::OpenOptions::new().create(true).append(true).open(&list);
        let written = added.and_then(|mut file| file.write_all(format!("{reason}\n").as_bytes()));
        written.unwrap_or_else(|error| panic!("{SKIPPED_LIST}: {}: {error}", list.display()));
    }
}

/// Reports that this test is skipped because the machine has no graphics adapter.
///
/// # Panics
/// Panics if an adapter is required, with one line that says what to install.
pub fn skip_without_adapter() {
    let value = |name: &str| std::env::var(name).ok();
    assert!(
        !is_required(value(REQUIRE_ADAPTER).as_deref(), value("CI").as_deref()),
        "no graphics adapter was found, but {REQUIRE_ADAPTER} or CI requires one: install the graphics card's Vulkan driver, \
         or Mesa's software driver (Debian and Ubuntu: apt-get install mesa-vulkan-drivers libvulkan1)"
    );
    skip("no graphics adapter");
}

/// Whether an adapter is required, given the values of [`REQUIRE_ADAPTER`] and `CI`.
fn is_required(own: Option<&str>, ci: Option<&str>) -> bool {
    let said = |value: &&str| !value.is_empty();
    own.filter(said).or(ci.filter(said)).is_some_and(|value| value != "0" && value != "false")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ci_requires_an_adapter_unless_told_otherwise() {
        assert!(!is_required(None, None));
        assert!(is_required(Some("1"), None));
        assert!(is_required(None, Some("true")));
        assert!(is_required(Some(""), Some("true")));
        assert!(!is_required(Some("0"), Some("true")));
        assert!(!is_required(None, Some("false")));
        assert!(!is_required(None, Some("")));
        assert!(is_required(Some("1"), Some("false")));
    }
}
