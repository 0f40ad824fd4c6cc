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

mod combinations;
mod growth;
mod refinement;
mod rounds;

use std::collections::HashMap;

use antumbra::TechniqueKind;

use super::Limits;
use super::bench::{Bench, FULL};
use super::space::Config;
use super::store::{Measured, Store};
use crate::error::LabError;
use crate::progress::Progress;
use growth::Growth;

/// So many measurements after one another are taken for of one pace.
const PACE_EVERY: usize = 12;
/// Frames by which `pcf` is timed then: every load is divided by it, and three frames of a few milliseconds are a fifth off.
const PACE_FRAMES: u32 = 9;
/// The pace is the median of so many looks.
const PACES: usize = 3;
/// Turns of so many frames for the budget itself.
const BASE_TURNS: usize = 5;

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
}

/// The pace after so many looks, of which there is at least one.
fn median_of_last(paces: &[f64]) -> f64 {
    let mut last = paces[paces.len().saturating_sub(PACES)..].to_vec();
    last.sort_by(f64::total_cmp);
    last[last.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_slow_look_changes_no_pace() {
        assert_eq!(median_of_last(&[1.0, 1.1, 3.0]), 1.1);
        assert_eq!(median_of_last(&[9.0, 9.0, 1.0, 1.2, 1.1]), 1.1, "what was long ago is past");
        assert_eq!(median_of_last(&[1.3]), 1.3);
    }
}
