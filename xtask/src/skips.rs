//! What tests skipped: a test runner counts a skipped test as passed, so it is said after the runner's own summary.

use std::path::{Path, PathBuf};

/// Names the file to which skipped tests add a line; `antumbra-testing` has the same name.
pub const LIST: &str = "ANTUMBRA_SKIPPED_LIST";

/// Makes tests that find no graphics adapter fail; `antumbra-testing` has the same name.
pub const REQUIRE_ADAPTER: &str = "ANTUMBRA_REQUIRE_ADAPTER";

/// The list of what the tests of one run skip.
pub struct Skips {
    path: PathBuf,
}

impl Skips {
    /// An empty list.
    ///
    /// # Errors
    /// Where there can be none.
    pub fn new() -> Result<Self, String> {
        // In the build folder, wherever that is: beside us.
        let own = std::env::current_exe().map_err(|error| format!("cannot tell where this program lies: {error}"))?;
        let path = own.with_file_name(format!("skipped-{}.txt", std::process::id()));
        std::fs::write(&path, "").map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self { path })
    }

    /// Where tests write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Says how much was skipped, and for want of what.
    pub fn report(self) {
        for (reason, count) in counted(&std::fs::read_to_string(&self.path).unwrap_or_default()) {
            eprintln!("xtask: SKIPPED {count} tests or parts of them: {reason}");
        }
        // A file left behind in the build folder harms nobody.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// How often each reason stands in a list, most often first.
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
