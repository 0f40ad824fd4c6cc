//! Suggestions for misspelt names ("did you mean").

/// Returns the known name nearest to `typed`; `None` if none is similar.
pub fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = normalised(typed);
    // Of equally near names the one with the longer common prefix wins: incomplete words are more common than wrong endings.
    let rank = |name: &str| {
        let name = normalised(name);
        // Swapping two neighbouring letters counts as one error.
        (strsim::osa_distance(&typed, &name), usize::MAX - common_prefix(&typed, &name))
    };
    let ((distance, _), name) = known.into_iter().map(|name| (rank(name), name)).min_by_key(|(rank, _)| *rank)?;
    // More wrong letters than a third make it a different word.
    (distance <= 1.max(typed.chars().count() / 3)).then_some(name)
}

/// Returns ` (did you mean `x`?)`, or an empty string.
pub fn did_you_mean<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(typed, known).map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

fn normalised(name: &str) -> String {
    name.to_lowercase().replace(['-', ' '], "_")
}

fn common_prefix(a: &str, b: &str) -> usize {
    a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        use strsim::osa_distance;
        assert_eq!(osa_distance("", "abc"), 3);
        assert_eq!(osa_distance("pcss", "pcss"), 0);
        assert_eq!(osa_distance("psc", "pcs"), 1);
        assert_eq!(osa_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn suggests_near_names_only() {
        let known = ["hard", "pcf", "pcss", "multi_view"];
        assert_eq!(nearest("multiview", known), Some("multi_view"));
        assert_eq!(nearest("Multi-View", known), Some("multi_view"));
        assert_eq!(nearest("pcs", known), Some("pcss"));
        assert_eq!(nearest("fpc", known), None);
        assert_eq!(nearest("pfc", known), Some("pcf"));
        assert_eq!(nearest("raytracing", known), None);
    }
}
