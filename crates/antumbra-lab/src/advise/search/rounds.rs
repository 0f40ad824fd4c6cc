//! Rounds of the search: from the qualities of all techniques on small images to full size, dropping the worse half each time.

use std::collections::HashMap;

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;

use super::Search;
use super::growth::Growth;
use crate::advise::bench::FULL;
use crate::advise::space::{Config, QUALITIES, StepSize, set_by_qualities};
use crate::error::LabError;

/// Multiple of the budget: a quality expected to exceed it on a small image is skipped with all dearer ones,
/// because it takes longer still at full size.
const HOPELESS: f64 = 1.3;
/// Error ratio to the best so far, and minimum gain of the last quality step: a technique worse in both is not tried further.
const FAR_BEHIND: f64 = 2.0;
const LAGGING: f64 = 0.1;
/// Minimum number of techniques kept in each round.
const MIN_KEPT: [usize; 3] = [4, 3, 2];
/// Maximum score ratio to the best beyond that minimum: moves gain less from round to round.
const WITHIN_REACH: [f64; 3] = [3.0, 2.0, 1.5];
/// Maximum load of one technique that is always kept, because the others' times at full size are not known yet.
const SURELY_FITS: f64 = 0.7;
/// Maximum number of fallbacks tried at full size when no candidate keeps the budget there.
const MAX_FALLBACKS: usize = 8;
/// Number of techniques of which all parameters are tried.
const LOOKED_AT_IN_FULL: usize = 2;

impl Search<'_, '_> {
    /// Runs all rounds. Results are in `tried` and in the store.
    pub(in crate::advise) fn run(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
        self.progress.begin("round 1: every technique's qualities", kinds.len() as u64);
        self.survey(kinds)?;
        let mut left = self.keep(kinds, 0, 0);
        let mut relevant: HashMap<TechniqueKind, Vec<&'static str>> = HashMap::new();
        for size_index in 0..FULL {
            let what = ["small", "medium"][size_index];
            let stage = format!("round {}: {} techniques on {what} images", size_index + 2, left.len());
            self.progress.begin(&stage, left.len() as u64);
            for (place, kind) in left.clone().into_iter().enumerate() {
                self.carry_over(kind, size_index)?;
                // On small images, refine only what qualities set; then all parameters of the techniques that are likely to be kept.
                let looks_at_all = size_index > 0 && place < LOOKED_AT_IN_FULL;
                let keys = (!looks_at_all).then(|| keys_of_qualities(kind));
                let matters = self.refine(kind, size_index, keys.as_deref(), StepSize::Whole)?;
                relevant.insert(kind, matters);
                self.progress.reach(place as u64 + 1);
            }
            left = self.keep(&left, size_index, size_index + 1);
        }
        self.progress.begin(&format!("round 4: {} techniques at full size", left.len()), left.len() as u64);
        for (done, kind) in (1..).zip(left.clone()) {
            let sure = self.best_that_fits(kind, FULL - 1, SURELY_FITS);
            for (config, _) in self.best(kind, FULL - 1, 2).into_iter().chain(sure) {
                self.measure(&config, FULL)?;
            }
            self.refine(kind, FULL, relevant.get(&kind).map(Vec::as_slice), StepSize::Whole)?;
            self.progress.reach(done);
        }
        // A promising technique may be too slow at full size, and the replacement has not been refined as closely.
        self.fall_back(kinds)?;
        if let Some(kind) = self.first_that_fits(kinds, FULL, 1.0).filter(|kind| !left.contains(kind)) {
            self.refine(kind, FULL, Some(&keys_of_qualities(kind)), StepSize::Whole)?;
        }
        // Half steps, because the budget may lie between two whole ones.
        if let Some(kind) = self.first_that_fits(kinds, FULL, 1.0) {
            self.refine(kind, FULL, Some(&keys_of_qualities(kind)), StepSize::Half)?;
        }
        self.progress.end();
        Ok(())
    }

    /// Measures the techniques' qualities on small images, cheapest first, so that the best error is known for the dearer ones.
    fn survey(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
        let mut left: Vec<(TechniqueKind, Vec<Step>)> = kinds.iter().map(|kind| (*kind, Vec::new())).collect();
        let mut least = f64::INFINITY;
        for (done, quality) in (1..).zip(QUALITIES) {
            for (kind, seen) in &mut left {
                let measured = self.measure(&Config::of_quality(*kind, quality), 0)?;
                // Without an error there is nothing to compare.
                let refused = measured.refused.is_some();
                let error = if refused { f64::INFINITY } else { measured.error() };
                let step = Step { error, load: self.load(*kind, 0, &measured) };
                if step.load <= 1.0 {
                    least = least.min(step.error);
                }
                seen.push(step);
            }
            left.retain(|(_, seen)| goes_on(seen, least));
            self.progress.reach(done * kinds.len() as u64 / QUALITIES.len() as u64);
        }
        // The dearest qualities may use another algorithm that costs little more with the numbers of a cheap one.
        for kind in kinds {
            let Some((centre, _)) = self.best_that_fits(*kind, 0, 1.0) else { continue };
            for (key, value) in switches_of_qualities(*kind) {
                self.measure(&centre.with(key, &value), 0)?;
            }
        }
        Ok(())
    }

    /// Returns the better half of the techniques by their best score, plus the best one that is sure to keep the budget.
    fn keep(&self, kinds: &[TechniqueKind], size_index: usize, round: usize) -> Vec<TechniqueKind> {
        let best = |kind: &TechniqueKind| self.best(*kind, size_index, 1).first().map(|(_, score)| (*kind, *score));
        let mut scored: Vec<(TechniqueKind, f64)> = kinds.iter().filter_map(best).collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        let count = count_kept(&scored.iter().map(|(_, score)| *score).collect::<Vec<_>>(), kinds.len(), round);
        let mut kept: Vec<TechniqueKind> = scored.into_iter().take(count).map(|(kind, _)| kind).collect();
        kept.extend(self.first_that_fits(kinds, size_index, SURELY_FITS).filter(|kind| !kept.contains(kind)));
        kept
    }

    /// Returns the configuration of a technique with the least error within a load, and its error.
    fn best_that_fits(&self, kind: TechniqueKind, size_index: usize, part: f64) -> Option<(Config, f64)> {
        let fitting = self.tried[size_index].iter().filter(|config| config.kind == kind).filter_map(|config| {
            let measured = self.known(config, size_index)?;
            let is_within = self.limits.keep(measured.memory_bytes, measured.roughness());
            (is_within && self.load(kind, size_index, measured) <= part).then(|| (config.clone(), measured.error()))
        });
        fitting.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns the technique with the least error within a load.
    fn first_that_fits(&self, kinds: &[TechniqueKind], size_index: usize, part: f64) -> Option<TechniqueKind> {
        let fitting = kinds.iter().filter_map(|kind| self.best_that_fits(*kind, size_index, part));
        fitting.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(config, _)| config.kind)
    }

    /// Measures, at full size, the configurations that kept the budget on smaller images, until one keeps it there too.
    fn fall_back(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
        for _ in 0..MAX_FALLBACKS {
            if self.first_that_fits(kinds, FULL, 1.0).is_some() {
                return Ok(());
            }
            let on_small = |kind: &TechniqueKind| {
                (0..FULL).rev().find_map(|size_index| self.best_that_fits(*kind, size_index, 1.0))
            };
            let others = kinds.iter().filter_map(on_small).filter(|(config, _)| !self.tried[FULL].contains(config));
            let Some((config, _)) = others.min_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(()) };
            self.measure(&config, FULL)?;
        }
        Ok(())
    }

    /// Times a technique's best configuration at full size, and measures the best ones of the previous size at this one.
    fn carry_over(&mut self, kind: TechniqueKind, size_index: usize) -> Result<(), LabError> {
        let before = size_index.saturating_sub(1);
        let best = self.best(kind, before, if size_index == 0 { 1 } else { 2 });
        let Some((first, _)) = best.first().cloned() else { return Ok(()) };
        for (config, _) in best {
            self.measure(&config, size_index)?;
        }
        let full = self.measure(&first, FULL)?;
        let small = self.measure(&first, size_index)?;
        let pixels = |size_index| f64::from(self.bench.size_px(size_index).element_product());
        if let Some(growth) = Growth::between(&small, &full, &self.budget_ms, pixels(FULL) / pixels(size_index)) {
            self.scale.insert((kind, size_index), growth);
        }
        Ok(())
    }
}

/// Result of a quality on small images.
#[derive(Clone, Copy, Debug)]
struct Step {
    error: f64,
    load: f64,
}

/// Returns whether a technique's next quality is worth measuring, given those `seen` and the `least` error within the budget.
fn goes_on(seen: &[Step], least: f64) -> bool {
    let Some(last) = seen.last() else { return true };
    let Some(before) = seen.len().checked_sub(2).map(|i| seen[i]) else {
        return last.error.is_finite() && last.load <= HOPELESS;
    };
    // Times of successive qualities grow by about a constant ratio.
    let next_load = last.load * (last.load / before.load.max(1e-9)).max(1.0);
    let lags = last.error > FAR_BEHIND * least && last.error > (1.0 - LAGGING) * before.error;
    last.error.is_finite() && next_load <= HOPELESS && !lags
}

/// Returns how many of the sorted scores a round keeps, out of `count` techniques.
fn count_kept(scores: &[f64], count: usize, round: usize) -> usize {
    let best = scores.first().copied().unwrap_or(0.0);
    let within = scores.iter().filter(|score| **score <= WITHIN_REACH[round] * best).count();
    within.min(count.div_ceil(2)).max(MIN_KEPT[round])
}

fn keys_of_qualities(kind: TechniqueKind) -> Vec<&'static str> {
    set_by_qualities(kind).into_iter().map(|(spec, _)| spec.key).collect()
}

/// Returns the non-numeric parameters that qualities set to other values than the default.
fn switches_of_qualities(kind: TechniqueKind) -> Vec<(&'static str, String)> {
    let other_of = |(spec, values): (&'static ParamSpec, Vec<String>)| {
        let is_switch = spec.range.is_none();
        let other = values.into_iter().find(|value| *value != spec.default.to_string())?;
        is_switch.then_some((spec.key, other))
    };
    set_by_qualities(kind).into_iter().filter_map(other_of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advise::bench::Bench;
    use crate::advise::store::{Measured, Store};
    use crate::advise::tests::request;
    use crate::advise::{Budget, Limits, about};
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;

    /// Runs `judge` on a search with a budget of 1 ms and known measurements: technique, index of the size, error and milliseconds.
    fn with_known(known: &[(TechniqueKind, usize, f64, f64)], judge: impl FnOnce(&mut Search<'_, '_>)) {
        let Some(lab) = lab_or_skip() else { return };
        let request = request("builtin:overlap", &[], Budget::Ms(1.0));
        let bench = Bench::new(lab, &request, &Silent).unwrap();
        let mut store = Store::open(None, about(lab, &request)).unwrap();
        for (kind, size_index, rmse, ms) in known {
            let measured = Measured { rmse: vec![*rmse], ms: vec![*ms], ..Measured::default() };
            store.insert(&Config::default_of(*kind), &bench.place(*size_index), measured).unwrap();
        }
        let fresh = store.fresh();
        let mut search = Search::new(&bench, &mut store, &Silent, vec![1.0], Limits::default());
        // Known measurements on small images count as tried.
        for (kind, size_index, ..) in known.iter().filter(|(_, size_index, ..)| *size_index < FULL) {
            search.measure(&Config::default_of(*kind), *size_index).unwrap();
        }
        judge(&mut search);
        assert_eq!(search.store.fresh(), fresh, "nothing was measured");
    }

    /// The best technique that is sure to keep the budget is kept whatever its error.
    #[test]
    fn a_technique_that_surely_fits_is_kept() {
        let kinds = &TechniqueKind::ALL[..12];
        let row = |i: usize| match i {
            11 => (kinds[i], 0, 0.5, 0.5 * SURELY_FITS),
            10 => (kinds[i], 0, 0.6, 0.5 * SURELY_FITS),
            _ => (kinds[i], 0, 0.1 + 1e-3 * i as f64, 0.5 + 0.5 * SURELY_FITS),
        };
        with_known(&(0..12).map(row).collect::<Vec<_>>(), |search| {
            assert_eq!(search.keep(kinds, 0, 0), [&kinds[..6], &kinds[11..]].concat());
            assert_eq!(search.keep(&kinds[10..], 0, 0), [kinds[11], kinds[10]], "none is there twice");
        });
    }

    /// Fallbacks are tried in order of error until one keeps the budget at full size.
    #[test]
    fn fallbacks_are_tried_in_order_of_error() {
        let kinds = [TechniqueKind::Hard, TechniqueKind::Pcf, TechniqueKind::Pcss, TechniqueKind::Vsm];
        let [hard, pcf, pcss, vsm] = kinds;
        let small = [(hard, 0, 0.3, 0.2), (pcf, 0, 0.2, 0.2), (pcss, 0, 0.1, 0.2), (vsm, 0, 0.05, 1.2)];
        let full = [(hard, FULL, 0.3, 0.3), (pcf, FULL, 0.2, 0.9), (pcss, FULL, 0.1, 3.0)];
        with_known(&[&small[..], &full[..]].concat(), |search| {
            search.fall_back(&kinds).unwrap();
            assert_eq!(
                search.tried[FULL],
                [pcss, pcf].map(Config::default_of),
                "vsm is too slow already, hard not needed"
            );
            assert_eq!(search.first_that_fits(&kinds, FULL, 1.0), Some(pcf));
        });
        // The search for fallbacks ends if none keeps the budget.
        let full = full.map(|(kind, size_index, rmse, _)| (kind, size_index, rmse, 5.0));
        with_known(&[&small[..], &full[..]].concat(), |search| {
            search.fall_back(&kinds).unwrap();
            assert_eq!((search.tried[FULL].len(), search.first_that_fits(&kinds, FULL, 1.0)), (3, None));
        });
    }

    #[test]
    fn switches_are_what_qualities_choose() {
        assert_eq!(switches_of_qualities(TechniqueKind::Pcss), [("means", "ranges".to_owned())]);
        assert!(switches_of_qualities(TechniqueKind::Vsm).is_empty());
    }

    /// Qualities are followed while they keep the budget and gain; one that lags far behind or would exceed it is skipped.
    #[test]
    fn qualities_are_followed_while_they_are_worth_it() {
        let seen = |steps: &[(f64, f64)]| -> Vec<Step> {
            steps.iter().map(|(error, load)| Step { error: *error, load: *load }).collect()
        };
        assert!(goes_on(&[], 0.1) && goes_on(&seen(&[(0.5, 0.1)]), 0.1), "one step says nothing of the next");
        assert!(!goes_on(&seen(&[(0.5, 1.4)]), 0.1), "beyond the budget already");
        assert!(goes_on(&seen(&[(0.11, 0.2), (0.11, 0.4)]), 0.1), "near the best");
        assert!(goes_on(&seen(&[(0.5, 0.2), (0.4, 0.4)]), 0.1), "far, but gaining");
        assert!(!goes_on(&seen(&[(0.5, 0.2), (0.48, 0.4)]), 0.1), "far, and hardly gaining");
        assert!(!goes_on(&seen(&[(0.11, 0.2), (0.1, 0.6)]), 0.1), "the next would take 1.8 times the budget");
        assert!(!goes_on(&seen(&[(f64::INFINITY, 0.0)]), 0.1), "refused");
    }

    #[test]
    fn rounds_keep_the_better_half_of_what_is_in_reach() {
        let even = [1.0; 10];
        assert_eq!(count_kept(&even, 10, 0), 5);
        let mut far = even;
        far[4..].fill(3.1);
        assert_eq!((count_kept(&far, 10, 0), count_kept(&far, 20, 0)), (4, 4), "the fifth is out of reach");
        assert_eq!(count_kept(&[1.0, 1.6, 1.7, 1.8], 4, 2), 2, "so many at least");
        assert_eq!(count_kept(&[1.0, 1.4, 1.4, 1.4, 1.6, 1.6], 6, 2), 3);
    }
}
