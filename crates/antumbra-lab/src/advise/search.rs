//! The search: from all techniques on small pictures to a few on those that are asked for.
//!
//! **Halving.** In each round every technique that is left has about as many measurements, on pictures of twice the side of the
//! round before, and the worse half goes: sequential halving (Karnin, Koren and Somekh, *Almost Optimal Exploration in
//! Multi-Armed Bandits*, ICML 2013), with fidelity for a resource as Jamieson and Talwalkar have it (*Non-stochastic Best Arm
//! Identification and Hyperparameter Optimization*, AISTATS 2016). Here an arm is a technique and its pulls are not
//! random but chosen.
//!
//! **Choosing.** About a technique's best configuration so far, every parameter is moved by one step of its declaration. With e the error
//! and t the time, move m has a ratio e_m / e and a difference t_m − t. Where moves did not bear on one another, errors would multiply
//! and times add: passes follow one another. Under that assumption all sets of moves on different parameters that none beats in both are found
//! parameter by parameter, and those that promise least error within the budget are measured, which makes up for what
//! the assumption leaves out.
//!
//! **Time on small pictures** is a lower bound of what is asked for: a technique's best configuration is timed there at the full
//! size too, pass by pass, and the passes of its others are taken for longer in the same ratios: a light map takes as long
//! for any picture.

use std::collections::{BTreeMap, HashMap};

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;

use super::Limits;
use super::bench::{Bench, FULL};
use super::space::{Config, QUALITIES, Stride, axes, set_by_qualities, steps};
use super::store::{Measured, Store};
use crate::error::LabError;
use crate::progress::Progress;

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
/// Combinations that are measured, by the part of the budget that they may take as predicted.
const TARGETS: [f64; 3] = [0.97, 0.8, 0.6];
/// A move whose error differs by less, and that saves less time, is not tried again on larger pictures.
const RELEVANT: f64 = 0.01;
const RELEVANT_SAVING: f64 = 0.08;
/// A move gains something where error falls by so much, or time.
const WORTH: f64 = 0.003;
const WORTH_SAVING: f64 = 0.08;
/// So many parameters of a technique are tried again, those that did most.
const MOST_RELEVANT: usize = 6;
/// At the full size a better configuration is started from again where the score falls to this part.
const LEADS_ON: f64 = 0.95;
/// From what takes more than so many times the budget only ways down are looked for, so many times.
const TOO_DEAR: f64 = 1.3;
const DESCENTS: usize = 3;
/// One stays that takes no more of the budget than this: what others will take at the full size is not known yet.
const SURELY_FITS: f64 = 0.7;
/// Where nothing keeps the budget at the full size in the end, so many of what did on smaller pictures are looked at.
const MOST_FALLBACKS: usize = 8;
/// Techniques of which all parameters are looked at.
const LOOKED_AT_IN_FULL: usize = 2;
/// So many measurements after one another are taken for of one pace.
const PACE_EVERY: usize = 12;
/// Frames by which `pcf` is timed then: every load is divided by it, and three frames of a few milliseconds are a fifth off.
const PACE_FRAMES: u32 = 9;
/// The pace is the median of so many looks.
const PACES: usize = 3;
/// Turns of so many frames for the budget itself.
const BASE_TURNS: usize = 5;
/// Sums of moves that are kept on the way.
const MOST_SUMS: usize = 48;

/// By how much a technique's time grows from a rung to the full size, measured with one of its configurations.
#[derive(Clone, Debug, PartialEq)]
struct Growth {
    by_pass: BTreeMap<String, f64>,
    /// Of all of it, and of what is in no pass.
    whole: f64,
}

impl Growth {
    /// `None` where one took no time. No pass is taken for one that grows faster than the pictures, nor for one that shrinks:
    /// software renderers date some as nothing.
    fn between(small: &Measured, full: &Measured, budget_ms: &[f64], pixels: f64) -> Option<Self> {
        let (load, load_full) = (small.load(budget_ms), full.load(budget_ms));
        if !(load > 0.0 && load_full > 0.0) {
            return None;
        }
        let whole = (load_full / load).max(1.0);
        let of_pass = |(label, full_ms): (&String, &f64)| {
            let small_ms = small.pass_ms.get(label).copied().unwrap_or(0.0);
            (label.clone(), if small_ms > 0.0 { (full_ms / small_ms).clamp(1.0, pixels.max(1.0)) } else { whole })
        };
        Some(Self { by_pass: full.pass_ms.iter().map(of_pass).collect(), whole })
    }

    /// Of one that was measured on the rung.
    fn of(&self, measured: &Measured) -> f64 {
        let passes_ms: f64 = measured.pass_ms.values().sum();
        // Time between passes, which timestamps leave out.
        let rest_ms = (measured.ms.iter().sum::<f64>() - passes_ms).max(0.0);
        let all_ms = passes_ms + rest_ms;
        if all_ms <= 0.0 {
            return self.whole;
        }
        let grown = |(label, ms): (&String, &f64)| ms * self.by_pass.get(label).unwrap_or(&self.whole);
        (measured.pass_ms.iter().map(grown).sum::<f64>() + rest_ms * self.whole) / all_ms
    }
}

/// A search under way.
pub(super) struct Search<'s, 'a> {
    pub(super) bench: &'s Bench<'a>,
    pub(super) store: &'s mut Store,
    pub(super) progress: &'s dyn Progress,
    /// By view, at the full size.
    pub(super) budget_ms: Vec<f64>,
    pub(super) limits: Limits,
    /// How much longer a technique's passes take at the full size than on a rung.
    scale: HashMap<(TechniqueKind, usize), Growth>,
    /// What `pcf` took at first, by view, where the budget is counted in it: the pace that all times are stated at.
    pub(super) pcf_ms: Option<Vec<f64>>,
    /// How much slower the machine is now: the median of the last few looks, as a short frame of `pcf` is easily a fifth off.
    pace: f64,
    paces: Vec<f64>,
    /// Measurements until that is looked at again.
    until_pace: usize,
    /// All that was measured, by rung.
    pub(super) tried: [Vec<Config>; FULL + 1],
}

/// A step of one parameter, and what came of it.
#[derive(Clone, Debug)]
pub(super) struct Move {
    pub(super) key: &'static str,
    pub(super) value: String,
    /// The natural logarithm of the errors' ratio.
    pub(super) error: f64,
    /// Parts of the budget.
    pub(super) load: f64,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(
        bench: &'s Bench<'a>,
        store: &'s mut Store,
        progress: &'s dyn Progress,
        budget_ms: Vec<f64>,
        limits: Limits,
    ) -> Self {
        Self {
            bench,
            store,
            progress,
            budget_ms,
            limits,
            scale: HashMap::new(),
            pcf_ms: None,
            pace: 1.0,
            paces: Vec::new(),
            until_pace: 0,
            tried: Default::default(),
        }
    }

    /// A measurement, made or known.
    pub(super) fn measure(&mut self, config: &Config, rung: usize) -> Result<Measured, LabError> {
        let place = self.bench.place(rung);
        if !self.tried[rung].contains(config) {
            self.tried[rung].push(config.clone());
        }
        if let Some(known) = self.store.get(config, &place) {
            return Ok(known.clone());
        }
        self.look_at_pace()?;
        let measured = Measured { pace: self.pace, ..self.bench.measure(config, rung)? };
        self.store.insert(config, &place, measured.clone())?;
        Ok(measured)
    }

    /// `pcf` at its defaults at the full size, which budgets are counted in: the median of several turns of more frames than others have.
    pub(super) fn measure_base(&mut self) -> Result<Measured, LabError> {
        let (pcf, place) = (Config::default_of(TechniqueKind::Pcf), self.bench.place(FULL));
        if let Some(known) = self.store.get(&pcf, &place) {
            return Ok(known.clone());
        }
        let mut base = Measured { pace: self.pace, ..self.bench.measure(&pcf, FULL)? };
        let count = if base.refused.is_some() { 0 } else { BASE_TURNS };
        let turns: Vec<Measured> =
            (0..count).map(|_| self.bench.measure_frames(&pcf, FULL, PACE_FRAMES)).collect::<Result<_, LabError>>()?;
        for (view, ms) in base.ms.iter_mut().enumerate() {
            let mut times: Vec<f64> = turns.iter().map(|turn| turn.ms[view]).collect();
            times.sort_by(f64::total_cmp);
            (*ms, base.spread_ms[view]) = (times[BASE_TURNS / 2], [times[0], times[BASE_TURNS - 1]]);
        }
        base.spent_s += turns.iter().map(|turn| turn.spent_s).sum::<f64>();
        self.store.insert(&pcf, &place, base.clone())?;
        Ok(base)
    }

    /// Times `pcf` now and then where the budget is counted in it: a machine that others use too is not always as fast.
    fn look_at_pace(&mut self) -> Result<(), LabError> {
        let Some(base_ms) = self.pcf_ms.as_ref().map(|of_views| of_views.iter().sum::<f64>()) else { return Ok(()) };
        if self.until_pace > 0 {
            self.until_pace -= 1;
            return Ok(());
        }
        self.until_pace = PACE_EVERY;
        let now = self.bench.measure_frames(&Config::default_of(TechniqueKind::Pcf), FULL, PACE_FRAMES)?;
        self.paces.push((now.ms.iter().sum::<f64>() / base_ms.max(1e-9)).clamp(0.1, 10.0));
        self.pace = median_of_last(&self.paces);
        Ok(())
    }

    pub(super) fn known(&self, config: &Config, rung: usize) -> Option<&Measured> {
        self.store.get(config, &self.bench.place(rung)).filter(|measured| measured.refused.is_none())
    }

    /// The part of the budget that a configuration is expected to take at the full size.
    pub(super) fn load(&self, kind: TechniqueKind, rung: usize, measured: &Measured) -> f64 {
        let growth = self.scale.get(&(kind, rung)).map_or(1.0, |growth| growth.of(measured));
        measured.load(&self.budget_ms) * growth
    }

    /// Error, raised in the ratio in which it is beyond budget and limits. (Samples buy error by the root of their number; what has to come
    /// down far seldom pays.)
    fn score(&self, kind: TechniqueKind, rung: usize, measured: &Measured) -> f64 {
        let excess = self.limits.excess(measured.memory_bytes, measured.roughness());
        measured.error() * self.load(kind, rung, measured).max(1.0) * excess.max(1.0)
    }

    /// Of what was tried of a technique on a rung, the best so many.
    pub(super) fn best(&self, kind: TechniqueKind, rung: usize, count: usize) -> Vec<(Config, f64)> {
        let scored = self.tried[rung].iter().filter(|config| config.kind == kind);
        let mut scored: Vec<(Config, f64)> = scored
            .filter_map(|config| Some((config.clone(), self.score(kind, rung, self.known(config, rung)?))))
            .collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        scored.truncate(count);
        scored
    }

    /// Runs all rounds; what came of it is in `tried` and in the store.
    pub(super) fn run(&mut self, kinds: &[TechniqueKind]) -> Result<(), LabError> {
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

    /// Moves every parameter of a technique's best by a step (or those of some keys), then several at once as the moves promise.
    /// Which keys mattered.
    fn refine(
        &mut self,
        kind: TechniqueKind,
        rung: usize,
        keys: Option<&[&'static str]>,
        stride: Stride,
    ) -> Result<Vec<&'static str>, LabError> {
        self.descend(kind, rung)?;
        let Some((centre, score)) = self.best(kind, rung, 1).pop() else { return Ok(Vec::new()) };
        let load = self.known(&centre, rung).map_or(0.0, |measured| self.load(kind, rung, measured));
        if load > TOO_DEAR {
            return Ok(Vec::new());
        }
        let is_wanted = |spec: &&'static ParamSpec| keys.is_none_or(|keys| keys.contains(&spec.key));
        let specs: Vec<&'static ParamSpec> = axes(kind).filter(is_wanted).collect();
        let moves = self.moves(&centre, rung, &specs, stride, |_, _| true)?;
        let here = self.known(&centre, rung).map_or(0.0, Measured::error).max(1e-9);
        let best = self.best(kind, rung, 1).pop().map_or(f64::INFINITY, |(_, score)| score);
        for chosen in combinations(&moves, load) {
            // What moves promise together has to be less than what is found.
            if chosen.iter().map(|step| step.error).sum::<f64>() >= (best / here).ln() {
                continue;
            }
            let config = chosen.iter().fold(centre.clone(), |config, step| config.with(step.key, &step.value));
            self.measure(&config, rung)?;
        }
        let matters = |spec: &&&'static ParamSpec| {
            let of_key = moves.iter().filter(|step| step.key == spec.key);
            of_key.into_iter().any(|step| step.error.abs() > RELEVANT || step.load < -RELEVANT_SAVING * load)
        };
        let mut relevant: Vec<&'static str> = specs.iter().filter(matters).map(|spec| spec.key).collect();
        let weight = |key: &&'static str| {
            let of_key = moves.iter().filter(|step| step.key == *key);
            of_key.map(|step| step.error.abs().max(-step.load)).fold(0.0, f64::max)
        };
        relevant.sort_by(|a, b| weight(b).total_cmp(&weight(a)));
        relevant.truncate(MOST_RELEVANT);
        // At the full size once more from where that led, for as long as it leads on.
        if rung == FULL
            && let Some((_, better)) = self.best(kind, rung, 1).pop()
            && better < LEADS_ON * score
        {
            self.refine(kind, rung, Some(&relevant), stride)?;
        }
        Ok(relevant)
    }

    /// Looks for ways down from a best configuration that is beyond the budget: less of every number that qualities set.
    fn descend(&mut self, kind: TechniqueKind, rung: usize) -> Result<(), LabError> {
        for _ in 0..DESCENTS {
            let Some((centre, _)) = self.best(kind, rung, 1).pop() else { return Ok(()) };
            let load = self.known(&centre, rung).map_or(0.0, |measured| self.load(kind, rung, measured));
            if load <= TOO_DEAR {
                return Ok(());
            }
            let specs: Vec<&'static ParamSpec> = set_by_qualities(kind).into_iter().map(|(spec, _)| spec).collect();
            let moves =
                self.moves(&centre, rung, &specs, Stride::Whole, |value, next| match (value.parse(), next.parse()) {
                    (Ok::<f64, _>(value), Ok::<f64, _>(next)) => next < value,
                    _ => false,
                })?;
            for chosen in combinations(&moves, load) {
                let config = chosen.iter().fold(centre.clone(), |config, step| config.with(step.key, &step.value));
                self.measure(&config, rung)?;
            }
        }
        Ok(())
    }

    /// Every step from a configuration along some parameters, from one value to the next, that is wanted.
    fn moves(
        &mut self,
        centre: &Config,
        rung: usize,
        specs: &[&'static ParamSpec],
        stride: Stride,
        is_wanted: impl Fn(&str, &str) -> bool,
    ) -> Result<Vec<Move>, LabError> {
        let at_centre = self.measure(centre, rung)?;
        let (error, load) = (at_centre.error(), self.load(centre.kind, rung, &at_centre));
        let mut moves = Vec::new();
        for spec in specs {
            let here = centre.value(spec);
            for value in steps(spec, &here, stride).into_iter().filter(|next| is_wanted(&here, next)) {
                let measured = self.measure(&centre.with(spec.key, &value), rung)?;
                if measured.refused.is_none() {
                    moves.push(Move {
                        key: spec.key,
                        value,
                        error: (measured.error().max(1e-9) / error.max(1e-9)).ln(),
                        load: self.load(centre.kind, rung, &measured) - load,
                    });
                }
            }
        }
        Ok(moves)
    }
}

/// The pace after so many looks, of which there is at least one.
fn median_of_last(paces: &[f64]) -> f64 {
    let mut last = paces[paces.len().saturating_sub(PACES)..].to_vec();
    last.sort_by(f64::total_cmp);
    last[last.len() / 2]
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

/// Moves that are made at once, with what they are predicted to sum up to.
#[derive(Clone, Debug, Default)]
struct Sum {
    error: f64,
    load: f64,
    moves: Vec<usize>,
}

/// Sets of moves on different parameters that promise the least error within parts of the budget, from a configuration that takes
/// `load` of it; where none keeps it, the one that saves most.
fn combinations(moves: &[Move], load: f64) -> Vec<Vec<Move>> {
    let mut keys: Vec<&str> = moves.iter().map(|step| step.key).collect();
    keys.dedup();
    let mut sums = vec![Sum::default()];
    for key in keys {
        // What is lost in the noise of times is no gain.
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
    let least_error = |within: f64| {
        let fits = sums.iter().filter(|sum| load + sum.load <= within);
        fits.min_by(|a, b| a.error.total_cmp(&b.error))
    };
    let cheapest = || sums.iter().min_by(|a, b| a.load.total_cmp(&b.load));
    let mut chosen: Vec<&Sum> = TARGETS.iter().filter_map(|target| least_error(*target)).collect();
    if chosen.is_empty() {
        chosen.extend(cheapest());
    }
    let mut sets: Vec<Vec<usize>> = chosen.into_iter().map(|sum| sum.moves.clone()).collect();
    // One move alone has been measured.
    sets.retain(|set| set.len() > 1);
    sets.dedup();
    sets.into_iter().map(|set| set.into_iter().map(|i| moves[i].clone()).collect()).collect()
}

/// The sums that none beats in both error and load, thinned evenly where they are many.
fn front(mut sums: Vec<Sum>) -> Vec<Sum> {
    sums.sort_by(|a, b| a.load.total_cmp(&b.load).then(a.error.total_cmp(&b.error)));
    let mut least = f64::INFINITY;
    sums.retain(|sum| {
        let is_front = sum.error < least;
        least = least.min(sum.error);
        is_front
    });
    let count = sums.len();
    if count <= MOST_SUMS {
        return sums;
    }
    (0..MOST_SUMS).map(|i| sums[i * (count - 1) / (MOST_SUMS - 1)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::request;
    use super::super::{Budget, about};
    use super::*;
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

    /// A map takes as long for any picture, so that what spares time there spares as much at the full size, and taps save more.
    #[test]
    fn passes_grow_each_by_itself() {
        let measured = |map_ms: f64, resolve_ms: f64, rest_ms: f64| Measured {
            ms: vec![map_ms + resolve_ms + rest_ms],
            pass_ms: [("map".to_owned(), map_ms), ("resolve".to_owned(), resolve_ms)].into(),
            ..Measured::default()
        };
        let (small, full) = (measured(4.0, 1.0, 0.0), measured(4.0, 16.0, 0.0));
        let growth = Growth::between(&small, &full, &[10.0], 16.0).unwrap();
        assert_eq!(growth.of(&small), 4.0);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} for {b}");
        close(growth.of(&measured(1.0, 1.0, 0.0)) * 2.0, 17.0);
        close(growth.of(&measured(4.0, 0.5, 0.0)) * 4.5, 12.0);
        // What no pass has goes as the whole; so does a pass that was not there, or was dated as nothing.
        close(growth.of(&measured(0.0, 0.0, 3.0)), 4.0);
        let late = Growth::between(&measured(4.0, 0.0, 1.0), &full, &[10.0], 16.0).unwrap();
        assert_eq!(late.by_pass["resolve"], 4.0);
        // Nothing grows faster than the pictures or shrinks.
        let odd = Growth::between(&measured(4.0, 0.01, 1.0), &measured(3.0, 16.0, 1.0), &[10.0], 16.0).unwrap();
        assert_eq!((odd.by_pass["map"], odd.by_pass["resolve"]), (1.0, 16.0));
        assert_eq!(Growth::between(&Measured::default(), &full, &[10.0], 16.0), None);
    }

    #[test]
    fn switches_are_what_qualities_choose() {
        assert_eq!(switches_of_qualities(TechniqueKind::Pcss), [("means", "ranges".to_owned())]);
        assert!(switches_of_qualities(TechniqueKind::Vsm).is_empty());
    }

    fn step(key: &'static str, value: &str, error: f64, load: f64) -> Move {
        Move { key, value: value.into(), error, load }
    }

    /// Time saved on what does not matter pays for what does.
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
        // Beyond what moves can mend, all that saves is taken.
        assert_eq!(values(&combinations(&moves, 1.5)[0]), ["512", "32"]);
        assert!(combinations(&[], 0.5).is_empty());
    }

    /// A saving of time that is noise is not joined to others; one of which the same error is left pays.
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
    fn one_slow_look_changes_no_pace() {
        assert_eq!(median_of_last(&[1.0, 1.1, 3.0]), 1.1);
        assert_eq!(median_of_last(&[9.0, 9.0, 1.0, 1.2, 1.1]), 1.1, "what was long ago is past");
        assert_eq!(median_of_last(&[1.3]), 1.3);
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

    #[test]
    fn fronts_are_thinned_but_keep_their_ends() {
        let sum = |i: usize| Sum { error: -(i as f64), load: i as f64, moves: Vec::new() };
        let thinned = front((0..1000).map(sum).chain([Sum { error: 0.5, load: 3.0, moves: Vec::new() }]).collect());
        assert_eq!((thinned.len(), thinned[0].load, thinned[MOST_SUMS - 1].load), (MOST_SUMS, 0.0, 999.0));
    }
}
