//! Interleaved timing: configurations in turns, several times over, with `pcf` among them.

use antumbra::TechniqueKind;

use super::bench::FULL;
use super::search::Search;
use super::{Candidate, Config};
use crate::error::LabError;
use crate::stopwatch::FrameCount;

/// Number of turns, and timed frames of each.
pub(super) const TURNS: usize = 5;
const FRAMES: u32 = 9;

/// Minimum relative difference of two times whose ranges are disjoint.
const CLEARLY: f64 = 0.03;

/// Times of one configuration by turn and view, milliseconds. A turn is empty if the configuration could not run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Times {
    by_turn: Vec<Vec<f64>>,
    count: FrameCount,
}

impl Times {
    /// Returns the times of a view over the turns, sorted.
    fn of_view(&self, view: usize) -> Vec<f64> {
        sorted(self.by_turn.iter().filter_map(|turn| turn.get(view).copied()).collect())
    }

    /// Returns the times summed over all views, by turn, sorted.
    fn sums(&self) -> Vec<f64> {
        sorted(self.by_turn.iter().filter(|turn| !turn.is_empty()).map(|turn| turn.iter().sum()).collect())
    }

    /// Returns the ratio of median times to another configuration's, or `None` if the ranges of times overlap or the
    /// difference is within the machine's noise.
    pub(super) fn over(&self, other: &Self) -> Option<f64> {
        let (here, there) = (self.sums(), other.sums());
        let ([first, .., last], [other_first, .., other_last]) = (here.as_slice(), there.as_slice()) else {
            return None;
        };
        let ratio = median(&here) / median(&there);
        let is_apart = last < other_first || other_last < first;
        (is_apart && (ratio - 1.0).abs() >= CLEARLY).then_some(ratio)
    }

    /// Returns whether it takes clearly less time than another configuration.
    pub(super) fn saves(&self, other: &Self) -> bool {
        self.over(other).is_some_and(|ratio| ratio < 1.0)
    }

    /// Stores these times and the resulting loads in a candidate.
    pub(super) fn give(&self, one: &mut Candidate, budget_ms: &[f64]) {
        for view in 0..one.ms.len() {
            let times = self.of_view(view);
            if let (Some(first), Some(last)) = (times.first(), times.last()) {
                (one.ms[view], one.spread_ms[view]) = (median(&times), [*first, *last]);
            }
        }
        (one.turns, one.count) = (self.by_turn.len() as u32, self.count);
        one.weigh(budget_ms);
    }
}

/// Times configurations and `pcf` in turns, several times over. If the budget is a multiple of `pcf`'s time, each turn's times are divided
/// by the slowdown of `pcf` in it since the first measurement, which cancels the machine's slowdown.
pub(super) fn in_turns(search: &Search<'_, '_>, configs: &[&Config]) -> Result<Vec<Times>, LabError> {
    let pcf = Config::default_of(TechniqueKind::Pcf);
    let mut times: Vec<Times> =
        configs.iter().map(|_| Times { by_turn: Vec::new(), count: FrameCount::default() }).collect();
    search.progress.begin("timing in alternation", (TURNS * configs.len()) as u64);
    for turn in 0..TURNS {
        let paces = match &search.pcf_ms {
            None => Vec::new(),
            Some(base_ms) => {
                let now = search.bench.measure_frames(&pcf, FULL, FRAMES)?;
                now.ms.iter().zip(base_ms).map(|(now, base)| now / base.max(1e-9)).collect()
            }
        };
        for (i, (config, times)) in configs.iter().zip(&mut times).enumerate() {
            let measured = search.bench.measure_frames(config, FULL, FRAMES)?;
            let pace = |view: usize| paces.get(view).copied().unwrap_or(1.0).max(1e-9);
            times.by_turn.push(measured.ms.iter().enumerate().map(|(view, ms)| ms / pace(view)).collect());
            times.count = if turn == 0 {
                measured.count
            } else {
                FrameCount::least([times.count, measured.count]).unwrap_or_default()
            };
            search.progress.reach((turn * configs.len() + i + 1) as u64);
        }
    }
    search.progress.end();
    Ok(times)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

fn median(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Returns times of one view.
    pub(in super::super) fn times(ms: &[f64]) -> Times {
        Times { by_turn: ms.iter().map(|ms| vec![*ms]).collect(), count: FrameCount { frames: 9, warm_up: 1 } }
    }

    /// A difference within the spread is no difference.
    #[test]
    fn noise_is_no_difference() {
        let base = times(&[10.0, 10.2, 9.8, 10.1, 12.0]);
        // The median is 18 % less, but one turn takes as long as the other's fastest.
        assert_eq!(times(&[8.2, 8.1, 8.2, 8.3, 9.9]).over(&base), None);
        let apart = times(&[8.2, 8.1, 8.2, 8.3, 8.9]);
        assert_eq!(apart.over(&base), Some(8.2 / 10.1));
        assert!(apart.saves(&base) && !base.saves(&apart) && base.over(&apart).is_some_and(|ratio| ratio > 1.2));
        // Disjoint ranges, but hardly different.
        assert_eq!(times(&[9.7, 9.6, 9.7]).over(&times(&[9.8, 9.85, 9.9])), None);
        // A configuration that could not run has no ratio.
        assert_eq!(Times { by_turn: vec![Vec::new(); 3], count: FrameCount::default() }.over(&base), None);
    }
}
