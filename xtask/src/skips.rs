//! Report of skipped tests. A test runner counts a skipped test as passed, so the report follows the runner's own summary.

use std::path::{Path, PathBuf};

/// Environment variable with the file to which skipped tests add a line; `antumbra-testing` uses the same name.
pub const LIST: &str = "ANTUMBRA_SKIPPED_LIST";

/// Environment variable that makes tests without a graphics adapter fail; `antumbra-testing` uses the same name.
pub const REQUIRE_ADAPTER: &str = "ANTUMBRA_REQUIRE_ADAPTER";

/// List of the tests that a run skips.
pub struct Skips {
    path: PathBuf,
}

impl Skips {
    /// Creates an empty list.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn new() -> Result<Self, String> {
        // In the build folder, which contains this program.
        let own = std::env::current_exe().map_err(|error| format!("cannot find the path of this program: {error}"))?;
        let path = own.with_file_name(format!("skipped-{}.txt", std::process::id()));
        std::fs::write(&path, "").map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self { path })
    }

    /// Returns the path of the file that tests write to.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Prints the number of skipped tests for each reason.
    pub fn report(self) {
        for (reason, count) in counted(&std::fs::read_to_string(&self.path).unwrap_or_default()) {
            eprintln!("xtask: SKIPPED {count} tests or parts of tests: {reason}");
        }
        // A remaining file in the build folder is harmless.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Returns the number of lines for each reason, the most frequent first.
fn counted(list: &str) -> Vec<(&str, usize)> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for reason in list.lines() {
        match counts.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, count)) => *count += 1,
            None => counts.push((reason, 1)),
        }
    }
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

#[cfg(test)]
mod tests {
    #[test]
    fn reasons_are_counted() {
        assert_eq!(super::counted("no b\nno a\nno b\n"), [("no b", 2), ("no a", 1)]);
        assert!(super::counted("").is_empty());
    }
}
