//! Choice of mutants: random by seed, spread over all sources.

/// Random number generator with the same numbers on every machine (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number
/// generators", OOPSLA: SplitMix64).
struct Random(u64);

impl Random {
    /// Returns the generator of a seed and a source, so that an edit of one source leaves the choice in all others unchanged. The name is
    /// hashed by Fowler, Noll and Vo's FNV-1a.
    fn of(seed: u64, source: &str) -> Self {
        Self(
            source.bytes().fold(seed ^ 0xcbf2_9ce4_8422_2325, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            }),
        )
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a random permutation of `count` items.
    fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, (self.next() % (i as u64 + 1)) as usize);
        }
        order
    }
}

/// Returns the order in which to take changes, as (source, change) indices: first one of every source, then in proportion to the square
/// root of each source's number of changes, so that long sources do not crowd out short ones.
pub fn order_of(seed: u64, changes_by_source: &[(&str, usize)]) -> Vec<(usize, usize)> {
    let mut ranked = Vec::new();
    for (source, (name, count)) in changes_by_source.iter().enumerate() {
        for (rank, change) in Random::of(seed, name).order(*count).into_iter().enumerate() {
            ranked.push((rank as f64 / (*count as f64).sqrt(), source, change));
        }
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, source, change)| (source, change)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_source_is_taken_from_and_long_ones_more() {
        let sources = [("a", 100), ("b", 4), ("c", 0), ("d", 25)];
        let order = order_of(7, &sources);
        assert_eq!(order.len(), 129);
        let first: Vec<usize> = order[..3].iter().map(|(source, _)| *source).collect();
        assert_eq!(first, [0, 1, 3]);
        let of = |source| order[..34].iter().filter(|(taken, _)| *taken == source).count();
        assert!(of(0) > of(3) && of(3) > of(1) && of(1) == 4, "{} {} {}", of(0), of(1), of(3));
        let mut all = order.clone();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), order.len(), "each once");
        assert_ne!(order, order_of(8, &sources));
        // The choice in one source does not depend on another.
        let of_the_last = |sources: &[(&str, usize)]| -> Vec<usize> {
            order_of(7, sources).into_iter().filter(|(source, _)| *source == 3).map(|(_, change)| change).collect()
        };
        assert_eq!(of_the_last(&sources), of_the_last(&[("a", 99), ("b", 5), ("c", 1), ("d", 25)]));
    }
}
