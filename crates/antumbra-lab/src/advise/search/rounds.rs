//! Rounds of the search: from every technique's qualities on small pictures to the full size, the worse half dropped each time.

use std::collections::HashMap;

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;

use super::Search;
use super::growth::Growth;
use crate::advise::bench::FULL;
use crate::advise::space::{Config, QUALITIES, Stride, set_by_qualities};
use crate::error::LabError;

/// Where a small picture is expected to take more than so many times the budget, a quality and dearer ones are not looked at: at
/// the full size they take longer still.
const HOPELESS: f64 = 1.3;
/// Nor where the technique errs so many times as much as the best so far, and its last step of quality took off less than this part.
const FAR_BEHIND: f64 = 2.0;
const LAGGING: f64 = 0.1;
/// Rounds keep the better half, and so many at least.
const LEAST_KEPT: [usize; 3] = [4, 3, 2];
/// And beyond those least none that is so many times as bad as the best: what moves gain falls from round to round.
const WITHIN_REACH: [f64; 3] = [3.0, 2.0, 1.5];
/// One stays that takes no more of the budget than this: what others will take at the full size is not known yet.
const SURELY_FITS: f64 = 0.7;
/// Where nothing keeps the budget at the full size in the end, so many of what did on smaller pictures are looked at.
const MOST_FALLBACKS: usize = 8;
/// Techniques of which all parameters are looked at.
const LOOKED_AT_IN_FULL: usize = 2;

impl Search<'_, '_> {
    /// Runs all rounds; what came of it is in `tried` and in the store.
    pub(in crate::advise) fn run(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
        self.progress.begin("round 1: every technique's qualities", kinds.len() as u64);
        self.survey(kinds)?;
        let mut left = self.keep(kinds, 0, 0);
        let mut relevant: HashMap<TechniqueKind, Vec<&'static str>> = HashMap::new();
        for rung in 0..FULL {
            let what = ["small", "middling"][rung];
            let stage = format!("round {}: {} techniques on {what} pictures", rung + 2, left.len());
            self.progress.begin(&stage, left.len() as u64);
            for (place, kind) in left.clone().into_iter().enumerate() {
                self.carry_over(kind, rung)?;
                // On small pictures what qualities set; then all that is declared, of those that are likely to be kept.
                let looks_at_all = rung > 0 && place < LOOKED_AT_IN_FULL;
                let keys = (!looks_at_all).then(|| keys_of_qualities(kind));
                let matters = self.refine(kind, rung, keys.as_deref(), Stride::Whole)?;
                relevant.insert(kind, matters);
                self.progress.reach(place as u64 + 1);
            }
            left = self.keep(&left, rung, rung + 1);
        }
        self.progress.begin(&format!("round 4: {} techniques at full size", left.len()), left.len() as u64);
        for (done, kind) in (1..).zip(left.clone()) {
            let sure = self.best_that_fits(kind, FULL - 1, SURELY_FITS);
            for (config, _) in self.best(kind, FULL - 1, 2).into_iter().chain(sure) {
                self.measure(&config, FULL)?;
            }
            self.refine(kind, FULL, relevant.get(&kind).map(Vec::as_slice), Stride::Whole)?;
            self.progress.reach(done);
        }
        // What was promising may have turned out to be too slow; what is left has not been looked at as closely.
        self.fall_back(kinds)?;
        if let Some(kind) = self.first_that_fits(kinds, FULL, 1.0).filter(|kind| !left.contains(kind)) {
            self.refine(kind, FULL, Some(&keys_of_qualities(kind)), Stride::Whole)?;
        }
        // A budget lies between two steps.
        if let Some(kind) = self.first_that_fits(kinds, FULL, 1.0) {
            self.refine(kind, FULL, Some(&keys_of_qualities(kind)), Stride::Half)?;
        }
        self.progress.end();
        Ok(())
    }

    /// Techniques' qualities on small pictures, the cheapest of all first: so that what the next is worth is known when it is its turn.
    fn survey(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
        let mut left: Vec<(TechniqueKind, Vec<Step>)> = kinds.iter().map(|kind| (*kind, Vec::new())).collect();
        let mut least = f64::INFINITY;
        for (done, quality) in (1..).zip(QUALITIES) {
            for (kind, seen) in &mut left {
                let measured = self.measure(&Config::of_quality(*kind, quality), 0)?;
                // Without an error there is nothing to go on from.
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
        // The dearest qualities may be another algorithm, which costs hardly more with the numbers of a cheap one.
        for kind in kinds {
            let Some((centre, _)) = self.best_that_fits(*kind, 0, 1.0) else { continue };
            for (key, value) in switches_of_qualities(*kind) {
                self.measure(&centre.with(key, &value), 0)?;
            }
        }
        Ok(())
    }

    /// The better half of techniques, by their best, and the best of those that surely keep the budget.
    fn keep(&self, kinds: &[TechniqueKind], rung: usize, round: usize) -> Vec<TechniqueKind> {
        let best = |kind: &TechniqueKind| self.best(*kind, rung, 1).first().map(|(_, score)| (*kind, *score));
        let mut scored: Vec<(TechniqueKind, f64)> = kinds.iter().filter_map(best).collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        let count = count_kept(&scored.iter().map(|(_, score)| *score).collect::<Vec<_>>(), kinds.len(), round);
        let mut kept: Vec<TechniqueKind> = scored.into_iter().take(count).map(|(kind, _)| kind).collect();
        kept.extend(self.first_that_fits(kinds, rung, SURELY_FITS).filter(|kind| !kept.contains(kind)));
        kept
    }

    /// What errs least of a technique within a part of the budget, and its error.
    fn best_that_fits(&self, kind: TechniqueKind, rung: usize, part: f64) -> Option<(Config, f64)> {
        let fitting = self.tried[rung].iter().filter(|config| config.kind == kind).filter_map(|config| {
            let measured = self.known(config, rung)?;
            let is_within = self.limits.keep(measured.memory_bytes, measured.roughness());
            (is_within && self.load(kind, rung, measured) <= part).then(|| (config.clone(), measured.error()))
        });
        fitting.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The technique that errs least within a part of the budget.
    fn first_that_fits(&self, kinds: &[TechniqueKind], rung: usize, part: f64) -> Option<TechniqueKind> {
        let fitting = kinds.iter().filter_map(|kind| self.best_that_fits(*kind, rung, part));
        fitting.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(config, _)| config.kind)
    }

    /// Where nothing keeps the budget at the full size, looks there at what did on smaller pictures, until something does.
    fn fall_back(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
        for _ in 0..MOST_FALLBACKS {
            if self.first_that_fits(kinds, FULL, 1.0).is_some() {
                return Ok(());
            }
            let on_small =
                |kind: &TechniqueKind| (0..FULL).rev().find_map(|rung| self.best_that_fits(*kind, rung, 1.0));
            let others = kinds.iter().filter_map(on_small).filter(|(config, _)| !self.tried[FULL].contains(config));
            let Some((config, _)) = others.min_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(()) };
            self.measure(&config, FULL)?;
        }
        Ok(())
    }

    /// Times a technique's best at the full size, and measures the best of the rung before on this one.
    fn carry_over(&mut self, kind: TechniqueKind, rung: usize) -> Result<(), LabError> {
        let before = rung.saturating_sub(1);
        let best = self.best(kind, before, if rung == 0 { 1 } else { 2 });
        let Some((first, _)) = best.first().cloned() else { return Ok(()) };
        for (config, _) in best {
            self.measure(&config, rung)?;
        }
        let full = self.measure(&first, FULL)?;
        let small = self.measure(&first, rung)?;
        let pixels = |rung| f64::from(self.bench.size_px(rung).element_product());
        if let Some(growth) = Growth::between(&small, &full, &self.budget_ms, pixels(FULL) / pixels(rung)) {
            self.scale.insert((kind, rung), growth);
        }
        Ok(())
    }
}

/// What a quality came to on small pictures.
#[derive(Clone, Copy, Debug)]
struct Step {
    error: f64,
    load: f64,
}

/// Whether a technique's next quality is worth a look, after those that were `seen`, where the least error within the budget is `least`.
fn goes_on(seen: &[Step], least: f64) -> bool {
    let Some(last) = seen.last() else { return true };
    let Some(before) = seen.len().checked_sub(2).map(|i| seen[i]) else {
        return last.error.is_finite() && last.load <= HOPELESS;
    };
    // Qualities take longer from step to step in about one ratio.
    let next_load = last.load * (last.load / before.load.max(1e-9)).max(1.0);
    let lags = last.error > FAR_BEHIND * least && last.error > (1.0 - LAGGING) * before.error;
    last.error.is_finite() && next_load <= HOPELESS && !lags
}

/// How many of sorted scores, of `count` techniques that were in it, a round keeps.
fn count_kept(scores: &[f64], count: usize, round: usize) -> usize {
    let best = scores.first().copied().unwrap_or(0.0);
    let within = scores.iter().filter(|score| **score <= WITHIN_REACH[round] * best).count();
    within.min(count.div_ceil(2)).max(LEAST_KEPT[round])
}

fn keys_of_qualities(kind: TechniqueKind) -> Vec<&'static str> {
    set_by_qualities(kind).into_iter().map(|(spec, _)| spec.key).collect()
}

/// What is no number among that which qualities set, where it is not the default.
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

    /// A search with a budget of a millisecond, all of whose measurements are known: technique, rung, error and milliseconds.
    fn with_known(known: &[(TechniqueKind, usize, f64, f64)], judge: impl FnOnce(&mut Search<'_, '_>)) {
        let Some(lab) = lab_or_skip() else { return };
        let request = request("builtin:overlap", &[], Budget::Ms(1.0));
        let bench = Bench::new(lab, &request, &Silent).unwrap();
        let mut store = Store::open(None, about(lab, &request)).unwrap();
        for (kind, rung, rmse, ms) in known {
            let measured = Measured { rmse: vec![*rmse], ms: vec![*ms], ..Measured::default() };
            store.insert(&Config::default_of(*kind), &bench.place(*rung), measured).unwrap();
        }
        let fresh = store.fresh();
        let mut search = Search::new(&bench, &mut store, &Silent, vec![1.0], Limits::default());
        // What is known of small pictures has been tried there.
        for (kind, rung, ..) in known.iter().filter(|(_, rung, ..)| *rung < FULL) {
            search.measure(&Config::default_of(*kind), *rung).unwrap();
        }
        judge(&mut search);
        assert_eq!(search.store.fresh(), fresh, "nothing was measured");
    }

    /// However it errs, the best of what surely keeps the budget goes on with the better half.
    #[test]
    fn what_surely_fits_stays() {
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

    /// One after the other in the order of their errors, until one keeps the budget at the full size.
    #[test]
    fn where_nothing_keeps_the_budget_what_did_on_smaller_pictures_is_looked_at() {
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
        // And it ends where none does.
        let full = full.map(|(kind, rung, rmse, _)| (kind, rung, rmse, 5.0));
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

    /// Qualities are followed while they fit and lead on; one that lags far behind or would not fit is not looked at.
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
