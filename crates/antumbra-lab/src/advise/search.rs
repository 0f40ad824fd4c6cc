//! Search from all techniques on small images to a few on images of the requested size.
//!
//! **Halving.** In each round every remaining technique gets about as many measurements, on images of twice the side of the previous
//! round, and the worse half is dropped: sequential halving (Karnin, Koren and Somekh, *Almost Optimal Exploration in Multi-Armed
//! Bandits*, ICML 2013), with fidelity for a resource as in Jamieson and Talwalkar (*Non-stochastic Best Arm Identification and
//! Hyperparameter Optimization*, AISTATS 2016). Here an arm is a technique, and its pulls are chosen, not random.
//!
//! **Choosing.** From a technique's best configuration so far, every parameter is moved by one step of its declaration. With error e and
//! time t, move m has a ratio e_m / e and a difference t_m − t. The search assumes that moves are independent: errors multiply and times
//! add, because passes follow one another. Under this assumption it builds the Pareto front of all sets of moves on different parameters,
//! parameter by parameter. It then measures the sets that promise least error within the budget, which corrects for the assumption.
//!
//! **Time on small images** is a lower bound of the time at full size. A technique's best configuration is therefore
//! timed at full size too, pass by pass, and the passes of its other configurations are scaled by the same ratios: a
//! light map takes as long for any image size.

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

/// Number of consecutive measurements that share one pace.
const PACE_EVERY: usize = 12;
/// Timed frames of `pcf` for the pace. Every load is divided by it, and three frames of a few milliseconds are off by up to a fifth.
const PACE_FRAMES: u32 = 9;
/// Number of pace measurements of which the median is used.
const PACES: usize = 3;
/// Number of turns with which the budget itself is measured.
const BASE_TURNS: usize = 5;

/// State of a search.
pub(super) struct Search<'s, 'a> {
    pub(super) bench: &'s Bench<'a>,
    pub(super) store: &'s mut Store,
    pub(super) progress: &'s dyn Progress,
    /// Budget of each view at full size, milliseconds.
    pub(super) budget_ms: Vec<f64>,
    pub(super) limits: Limits,
    /// Ratio of a technique's pass times at full size to those at a smaller size.
    scale: HashMap<(TechniqueKind, usize), Growth>,
    /// First time of `pcf`, by view, if the budget is a multiple of it. All times are scaled to it.
    pub(super) pcf_ms: Option<Vec<f64>>,
    /// Current slowdown of the machine: median of the last few measurements, because a short frame of `pcf` is easily a fifth off.
    pace: f64,
    paces: Vec<f64>,
    /// Measurements left until the pace is measured again.
    until_pace: usize,
    /// All measured configurations, by measurement size.
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

    /// Returns a measurement from the store, or makes it.
    pub(super) fn measure(&mut self, config: &Config, size_index: usize) -> Result<Measured, LabError> {
        let place = self.bench.place(size_index);
        if !self.tried[size_index].contains(config) {
            self.tried[size_index].push(config.clone());
        }
        if let Some(known) = self.store.get(config, &place) {
            return Ok(known.clone());
        }
        self.look_at_pace()?;
        let measured = Measured { pace: self.pace, ..self.bench.measure(config, size_index)? };
        self.store.insert(config, &place, measured.clone())?;
        Ok(measured)
    }

    /// Measures `pcf` with its defaults at full size, the unit of budgets: the median of several turns with more frames than usual.
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

    /// Measures `pcf` at intervals if the budget is a multiple of its time, because a shared machine varies in speed.
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

    pub(super) fn known(&self, config: &Config, size_index: usize) -> Option<&Measured> {
        self.store.get(config, &self.bench.place(size_index)).filter(|measured| measured.refused.is_none())
    }

    /// Returns the expected load (fraction of the budget) of a configuration at full size.
    pub(super) fn load(&self, kind: TechniqueKind, size_index: usize, measured: &Measured) -> f64 {
        let growth = self.scale.get(&(kind, size_index)).map_or(1.0, |growth| growth.of(measured));
        measured.load(&self.budget_ms) * growth
    }

    /// Returns the error times the excesses over budget and limits. (Error falls with the root of the number of samples, so a
    /// configuration far beyond the budget seldom pays.)
    fn score(&self, kind: TechniqueKind, size_index: usize, measured: &Measured) -> f64 {
        let excess = self.limits.excess(measured.memory_bytes, measured.roughness());
        measured.error() * self.load(kind, size_index, measured).max(1.0) * excess.max(1.0)
    }

    /// Returns the best `count` configurations of a technique at a measurement size, with their scores.
    pub(super) fn best(&self, kind: TechniqueKind, size_index: usize, count: usize) -> Vec<(Config, f64)> {
        let scored = self.tried[size_index].iter().filter(|config| config.kind == kind);
        let mut scored: Vec<(Config, f64)> = scored
            .filter_map(|config| Some((config.clone(), self.score(kind, size_index, self.known(config, size_index)?))))
            .collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        scored.truncate(count);
        scored
    }
}

/// Returns the median of the last few paces; needs at least one.
fn median_of_last(paces: &[f64]) -> f64 {
    let mut last = paces[paces.len().saturating_sub(PACES)..].to_vec();
    last.sort_by(f64::total_cmp);
    last[last.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_ignores_a_single_slow_measurement() {
        assert_eq!(median_of_last(&[1.0, 1.1, 3.0]), 1.1);
        assert_eq!(median_of_last(&[9.0, 9.0, 1.0, 1.2, 1.1]), 1.1, "what was long ago is past");
        assert_eq!(median_of_last(&[1.3]), 1.3);
    }
}
