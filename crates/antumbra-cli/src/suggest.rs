//! "Did you mean": the known name nearest to one that was typed.

/// The known name that `typed` most likely meant; `None` where nothing is near.
pub fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = normalised(typed);
    // Of names equally near, the one that begins alike: a word is left unfinished more often than it ends wrongly.
    let rank = |name: &str| {
        let name = normalised(name);
        (edit_distance(&typed, &name), usize::MAX - common_prefix(&typed, &name))
    };
    let ((distance, _), name) = known.into_iter().map(|name| (rank(name), name)).min_by_key(|(rank, _)| *rank)?;
    // A third of the letters wrong is still recognisable; more is a different word.
    (distance <= 1.max(typed.chars().count() / 3)).then_some(name)
}

/// `, did you mean `x`?`, or nothing.
pub fn did_you_mean<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(typed, known).map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

fn normalised(name: &str) -> String {
    name.to_lowercase().replace(['-', ' '], "_")
}

fn common_prefix(a: &str, b: &str) -> usize {
    a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count()
}

/// Optimal string alignment (Damerau 1964): insertions, deletions, substitutions and swaps of neighbours.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let substitution = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let best = substitution.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
                let swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                if swapped { best.min(rows[i - 2][j - 2] + 1) } else { best }
            };
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("pcss", "pcss"), 0);
        assert_eq!(edit_distance("psc", "pcs"), 1);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn suggests_near_names_only() {
        let known = ["hard", "pcf", "pcss", "multi_view"];
        assert_eq!(nearest("multiview", known), Some("multi_view"));
        assert_eq!(nearest("Multi-View", known), Some("multi_view"));
        assert_eq!(nearest("pcs", known), Some("pcss"));
        assert_eq!(nearest("raytracing", known), None);
    }
}
