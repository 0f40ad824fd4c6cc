//! What the tests of every room do where the machine lacks something: they say *skipped*, or fail where it is required.
//!
//! A test runner knows only passed and failed, and hides what a passed test prints. So a skip is also written down, where
//! [`SKIPPED_LIST`] says, for `cargo xtask test` to count; and where [`REQUIRE_ADAPTER`] or `CI` says that there is to be
//! an adapter, there are no skips for want of one.
//!
//! [`book`] reads the documentation, for the tests that hold it to what it says.

pub mod book;

use std::fmt::Display;
use std::io::Write;
use std::path::PathBuf;

/// The variable that decides whether a test without an adapter fails: `1` yes, `0` no. Where it is not set, `CI` decides in
/// the same way. `cargo xtask ci` sets it.
pub const REQUIRE_ADAPTER: &str = "ANTUMBRA_REQUIRE_ADAPTER";

/// The variable that names a file to which each skipped test adds a line with its reason. `cargo xtask test` sets it.
pub const SKIPPED_LIST: &str = "ANTUMBRA_SKIPPED_LIST";

/// The variable that names the folder of test scenes, which are not part of the repository.
pub const SCENES: &str = "ANTUMBRA_SCENES";

/// The folder of test scenes, where this machine has one: what [`SCENES`] names, or `shared/scenes` beside or inside the workspace.
/// Where there is none, says that the test is skipped.
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

/// The folder `cases` beside [`scenes_folder`]: small inputs that once failed.
pub fn cases_folder() -> Option<PathBuf> {
    let found = scenes_folder()?.parent().map(|folder| folder.join("cases")).filter(|folder| folder.is_dir());
    if found.is_none() {
        skip("there is no folder of cases beside that of test scenes");
    }
    found
}

/// Says that this test, or a part of it, is skipped.
pub fn skip(reason: impl Display) {
    let line = format!("skipped: {reason}");
    println!("{line}");
    if let Some(list) = std::env::var_os(SKIPPED_LIST) {
        // One write to the end of the file: tests of other processes write, too.
        let added = std::fs::OpenOptions::new().create(true).append(true).open(&list);
        let written = added.and_then(|mut file| file.write_all(format!("{reason}\n").as_bytes()));
        written.unwrap_or_else(|error| panic!("{SKIPPED_LIST}: {}: {error}", list.display()));
    }
}

/// Says that this test is skipped because the machine has no graphics adapter.
///
/// # Panics
/// Where an adapter is required, with the one line that says what to install.
pub fn skip_without_adapter() {
    let value = |name: &str| std::env::var(name).ok();
    assert!(
        !is_required(value(REQUIRE_ADAPTER).as_deref(), value("CI").as_deref()),
        "no graphics adapter answers, and {REQUIRE_ADAPTER} or CI requires one: install the graphics card's Vulkan driver, \
         or Mesa's software driver (Debian and Ubuntu: apt-get install mesa-vulkan-drivers libvulkan1)"
    );
    skip("no graphics adapter");
}

/// Whether an adapter is required, by the values of [`REQUIRE_ADAPTER`] and of `CI`.
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
