//! "Did you mean": the known name nearest to one that was typed.

/// The known name that `typed` most likely meant; `None` where nothing is near.
pub fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = normalised(typed);
    // Of names equally near, the one that begins alike: a word is left unfinished more often than it ends wrongly.
    let rank = |name: &str| {
        let name = normalised(name);
        // Neighbouring letters that are swapped are one slip.
        (strsim::osa_distance(&typed, &name), usize::MAX - common_prefix(&typed, &name))
    };
    let ((distance, _), name) = known.into_iter().map(|name| (rank(name), name)).min_by_key(|(rank, _)| *rank)?;
    // A third of the letters wrong is still recognisable; more is a different word.
    (distance <= 1.max(typed.chars().count() / 3)).then_some(name)
}

/// ` (did you mean `x`?)`, or nothing.
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
