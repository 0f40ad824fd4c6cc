//! Combinations of moves: sets of steps on different parameters, ranked by their predicted error and time.

/// Loads that the measured combinations may have as predicted.
const TARGETS: [f64; 3] = [0.97, 0.8, 0.6];
/// Minimum fall of the logarithm of the error, or of the relative time, for a move to count as a gain.
const WORTH: f64 = 0.003;
const WORTH_SAVING: f64 = 0.08;
/// Maximum number of partial sums kept.
const MAX_SUMS: usize = 48;

/// A step of one parameter with its measured effect.
#[derive(Clone, Debug)]
pub(super) struct Move {
    pub(super) key: &'static str,
    pub(super) value: String,
    /// Natural logarithm of the ratio of errors.
    pub(super) error: f64,
    /// Difference of loads (fractions of the budget).
    pub(super) load: f64,
}

/// Set of moves with the sums of their effects.
#[derive(Clone, Debug, Default)]
struct Sum {
    error: f64,
    load: f64,
    moves: Vec<usize>,
}

/// Returns the sets of moves on different parameters with the least predicted error within each target load, from a configuration of the
/// given `load`. If no set keeps a target, returns the cheapest set.
pub(super) fn combinations(moves: &[Move], load: f64) -> Vec<Vec<Move>> {
    let mut keys: Vec<&str> = moves.iter().map(|step| step.key).collect();
    keys.dedup();
    let mut sums = vec![Sum::default()];
    for key in keys {
        // A saving within the noise of times is no gain.
        let useful =
            |(_, step): &(usize, &Move)| step.key == key && (step.error < -WORTH || step.load < -WORTH_SAVING * load);
        let here: Vec<(usize, &Move)> = moves.iter().enumerate().filter(useful).collect();
        let with = |sum: &Sum, (i, step): &(usize, &Move)| Sum {
            error: sum.error + step.error,
            load: sum.load + step.load,
            moves: sum.moves.iter().copied().chain([*i]).collect(),
        };
        let longer: Vec<Sum> =
            sums.iter().flat_map(|sum| here.iter().map(|step| with(sum, step)).collect::<Vec<_>>()).collect();
        sums.extend(longer);
        sums = front(sums);
    }
    let min_error = |within: f64| {
        let fits = sums.iter().filter(|sum| load + sum.load <= within);
        fits.min_by(|a, b| a.error.total_cmp(&b.error))
    };
    let cheapest = || sums.iter().min_by(|a, b| a.load.total_cmp(&b.load));
    let mut chosen: Vec<&Sum> = TARGETS.iter().filter_map(|target| min_error(*target)).collect();
    if chosen.is_empty() {
        chosen.extend(cheapest());
    }
    let mut sets: Vec<Vec<usize>> = chosen.into_iter().map(|sum| sum.moves.clone()).collect();
    // Single moves have been measured already.
    sets.retain(|set| set.len() > 1);
    sets.dedup();
    sets.into_iter().map(|set| set.into_iter().map(|i| moves[i].clone()).collect()).collect()
}

/// Returns the Pareto front of error and load, thinned evenly to the maximum number.
fn front(mut sums: Vec<Sum>) -> Vec<Sum> {
    sums.sort_by(|a, b| a.load.total_cmp(&b.load).then(a.error.total_cmp(&b.error)));
    let mut least = f64::INFINITY;
    sums.retain(|sum| {
        let is_front = sum.error < least;
        least = least.min(sum.error);
        is_front
    });
    let count = sums.len();
    if count <= MAX_SUMS {
        return sums;
    }
    (0..MAX_SUMS).map(|i| sums[i * (count - 1) / (MAX_SUMS - 1)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(key: &'static str, value: &str, error: f64, load: f64) -> Move {
        Move { key, value: value.into(), error, load }
    }

    /// Time saved on an unimportant parameter pays for an important one.
    #[test]
    fn moves_are_joined_within_the_budget() {
        let moves = [
            step("map_size", "512", 0.01, -0.3),
            step("map_size", "2048", -0.01, 0.6),
            step("samples", "32", 0.2, -0.2),
            step("samples", "128", -0.3, 0.25),
            step("rotate", "false", 0.0, 0.0),
        ];
        let sets = combinations(&moves, 0.95);
        let values = |set: &[Move]| set.iter().map(|step| step.value.clone()).collect::<Vec<_>>();
        assert_eq!(values(&sets[0]), ["512", "128"]);
        assert!(sets.iter().all(|set| set.len() > 1));
        // If no set keeps the budget, the set with the largest saving is taken.
        assert_eq!(values(&combinations(&moves, 1.5)[0]), ["512", "32"]);
        assert!(combinations(&[], 0.5).is_empty());
    }

    /// A move whose time saving is noise is not combined; one with a real saving at equal error is.
    #[test]
    fn moves_that_gain_nothing_are_not_joined() {
        let saving = |part: f64| step("rotate", "false", 0.0, -part * 0.9);
        let samples = step("samples", "128", -0.3, 0.05);
        assert!(combinations(&[saving(0.5 * WORTH_SAVING), samples.clone()], 0.9).is_empty());
        let sets = combinations(&[saving(2.0 * WORTH_SAVING), samples.clone()], 0.9);
        assert!(sets.iter().any(|set| set.len() == 2), "{sets:?}");
        let hardly = step("bias_scale", "1.5", -0.5 * WORTH, 0.0);
        assert!(combinations(&[hardly, samples], 0.9).is_empty());
    }

    #[test]
    fn fronts_are_thinned_but_keep_their_ends() {
        let sum = |i: usize| Sum { error: -(i as f64), load: i as f64, moves: Vec::new() };
        let thinned = front((0..1000).map(sum).chain([Sum { error: 0.5, load: 3.0, moves: Vec::new() }]).collect());
        assert_eq!((thinned.len(), thinned[0].load, thinned[MAX_SUMS - 1].load), (MAX_SUMS, 0.0, 999.0));
    }
}
