//! Exhaustive grid of settings, against which the search is tested.
//!
//! The grid covers the parameters that a technique's qualities set. Each takes the values that qualities set, the default, its half and
//! its double. A combination is skipped if another one with no larger number and otherwise equal values took more than twice the budget,
//! because time grows with every number.

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;

use super::bench::FULL;
use super::search::Search;
use super::space::{Config, ladder, set_by_qualities};
use crate::error::LabError;

/// Multiple of the budget beyond which larger combinations are skipped.
const BEYOND: f64 = 2.0;

impl Search<'_, '_> {
    /// Measures every combination at full size. Returns the number of skipped combinations.
    pub(super) fn run_grid(&mut self, kinds: &[TechniqueKind]) -> Result<usize, LabError> {
        let grids: Vec<(TechniqueKind, Vec<Config>)> = kinds.iter().map(|kind| (*kind, grid_of(*kind))).collect();
        let count: usize = grids.iter().map(|(_, grid)| grid.len()).sum();
        self.progress.begin(&format!("a grid of {count}"), count as u64);
        let (mut done, mut left_out) = (0, 0);
        for (kind, grid) in grids {
            let mut too_slow: Vec<Config> = Vec::new();
            for config in grid {
                if too_slow.iter().any(|cheaper| is_at_most(cheaper, &config)) {
                    left_out += 1;
                } else {
                    let measured = self.measure(&config, FULL)?;
                    if measured.refused.is_none() && self.load(kind, FULL, &measured) > BEYOND {
                        too_slow.push(config);
                    }
                }
                done += 1;
                self.progress.reach(done);
            }
        }
        self.progress.end();
        Ok(left_out)
    }
}

/// Returns a technique's grid, small numbers first.
pub(super) fn grid_of(kind: TechniqueKind) -> Vec<Config> {
    let mut grid = vec![Config::default_of(kind)];
    for (spec, set) in set_by_qualities(kind) {
        let values = ladder(spec, &set, false);
        grid = grid
            .iter()
            .flat_map(|config| values.iter().map(|value| config.with(spec.key, value)).collect::<Vec<_>>())
            .collect();
    }
    // The sort key is the sum of logarithms, so a combination that is smaller in all numbers comes first.
    let size = |config: &Config| -> f64 {
        let numbers = kind.param_specs().iter().filter_map(|spec| number(config, spec));
        numbers.map(|v| (v + 1.0).ln()).sum()
    };
    grid.sort_by(|a, b| size(a).total_cmp(&size(b)));
    grid
}

fn number(config: &Config, spec: &ParamSpec) -> Option<f64> {
    spec.range?;
    config.value(spec).parse().ok()
}

/// Returns whether no number of `a` is larger than in `b` and all other values are equal.
fn is_at_most(a: &Config, b: &Config) -> bool {
    a.kind == b.kind
        && a.kind.param_specs().iter().all(|spec| match (number(a, spec), number(b, spec)) {
            (Some(a), Some(b)) => a <= b,
            _ => a.value(spec) == b.value(spec),
        })
}

#[cfg(test)]
mod tests {
    use super::super::space::QUALITIES;
    use super::*;

    #[test]
    fn a_grid_holds_every_quality_once() {
        for kind in TechniqueKind::ALL.iter().copied() {
            let grid = grid_of(kind);
            for quality in QUALITIES {
                let config = Config::of_quality(kind, quality);
                assert_eq!(grid.iter().filter(|other| **other == config).count(), 1, "{config}");
            }
            for (i, config) in grid.iter().enumerate() {
                assert!(grid[..i].iter().all(|before| !is_at_most(config, before)), "{config} comes too late");
            }
        }
        assert!(grid_of(TechniqueKind::Pcss).len() > 100);
    }
}
