//! Names of rows.

use std::collections::BTreeMap;

/// Returns the names with repeated ones numbered from the second on: `pcss`, `pcss-2` with `-` as the separator.
pub(crate) fn numbered(names: impl IntoIterator<Item = String>, separator: &str) -> Vec<String> {
    let mut counts: BTreeMap<String, u32> = BTreeMap::new();
    let numbered = |name: String| {
        let count = counts.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name}{separator}{count}") }
    };
    names.into_iter().map(numbered).collect()
}

#[cfg(test)]
mod tests {
    use super::numbered;

    #[test]
    fn names_that_come_again_are_numbered() {
        let names = ["a", "b", "a", "a"].map(str::to_owned);
        assert_eq!(numbered(names, "-"), ["a", "b", "a-2", "a-3"]);
    }
}
