//! Refinement of a technique: parameter steps from its best configuration, singly and combined.

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;

use super::Search;
use super::combinations::{Move, combinations};
use crate::advise::bench::FULL;
use crate::advise::space::{Config, StepSize, axes, set_by_qualities, steps};
use crate::advise::store::Measured;
use crate::error::LabError;

/// Minimum change of the error's logarithm, or of the relative time, for a parameter to be tried again on larger images.
const RELEVANT: f64 = 0.01;
const RELEVANT_SAVING: f64 = 0.08;
/// Maximum number of a technique's parameters tried again, those with the largest effect.
const MAX_RELEVANT: usize = 6;
/// Score ratio below which the refinement at full size restarts from the better configuration.
const LEADS_ON: f64 = 0.95;
/// Multiple of the budget above which only cheaper settings are tried, and the number of such descents.
const TOO_DEAR: f64 = 1.3;
const DESCENTS: usize = 3;

impl Search<'_, '_> {
    /// Moves every parameter (or those in `keys`) of a technique's best configuration by a step, then measures the most promising
    /// combinations. Returns the keys that mattered.
    pub(super) fn refine(
        &mut self,
        kind: TechniqueKind,
        size_index: usize,
        keys: Option<&[&'static str]>,
        stride: StepSize,
    ) -> Result<Vec<&'static str>, LabError> {
        self.descend(kind, size_index)?;
        let Some((centre, score)) = self.best(kind, size_index, 1).pop() else { return Ok(Vec::new()) };
        let load = self.known(&centre, size_index).map_or(0.0, |measured| self.load(kind, size_index, measured));
        if load > TOO_DEAR {
            return Ok(Vec::new());
        }
        let is_wanted = |spec: &&'static ParamSpec| keys.is_none_or(|keys| keys.contains(&spec.key));
        let specs: Vec<&'static ParamSpec> = axes(kind).filter(is_wanted).collect();
        let moves = self.moves(&centre, size_index, &specs, stride, |_, _| true)?;
        let here = self.known(&centre, size_index).map_or(0.0, Measured::error).max(1e-9);
        let best = self.best(kind, size_index, 1).pop().map_or(f64::INFINITY, |(_, score)| score);
        for chosen in combinations(&moves, load) {
            // A combination is measured only if its predicted error is below the best score.
            if chosen.iter().map(|step| step.error).sum::<f64>() >= (best / here).ln() {
                continue;
            }
            let config = chosen.iter().fold(centre.clone(), |config, step| config.with(step.key, &step.value));
            self.measure(&config, size_index)?;
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
        relevant.truncate(MAX_RELEVANT);
        // At full size, refine again from a clearly better configuration.
        if size_index == FULL
            && let Some((_, better)) = self.best(kind, size_index, 1).pop()
            && better < LEADS_ON * score
        {
            self.refine(kind, size_index, Some(&relevant), stride)?;
        }
        Ok(relevant)
    }

    /// Descends from a best configuration beyond the budget by reducing the numbers that qualities set.
    fn descend(&mut self, kind: TechniqueKind, size_index: usize) -> Result<(), LabError> {
        for _ in 0..DESCENTS {
            let Some((centre, _)) = self.best(kind, size_index, 1).pop() else { return Ok(()) };
            let load = self.known(&centre, size_index).map_or(0.0, |measured| self.load(kind, size_index, measured));
            if load <= TOO_DEAR {
                return Ok(());
            }
            let specs: Vec<&'static ParamSpec> = set_by_qualities(kind).into_iter().map(|(spec, _)| spec).collect();
            let moves = self.moves(&centre, size_index, &specs, StepSize::Whole, |value, next| {
                match (value.parse(), next.parse()) {
                    (Ok::<f64, _>(value), Ok::<f64, _>(next)) => next < value,
                    _ => false,
                }
            })?;
            for chosen in combinations(&moves, load) {
                let config = chosen.iter().fold(centre.clone(), |config, step| config.with(step.key, &step.value));
                self.measure(&config, size_index)?;
            }
        }
        Ok(())
    }

    /// Measures every wanted step of some parameters from a configuration.
    fn moves(
        &mut self,
        centre: &Config,
        size_index: usize,
        specs: &[&'static ParamSpec],
        stride: StepSize,
        is_wanted: impl Fn(&str, &str) -> bool,
    ) -> Result<Vec<Move>, LabError> {
        let at_centre = self.measure(centre, size_index)?;
        let (error, load) = (at_centre.error(), self.load(centre.kind, size_index, &at_centre));
        let mut moves = Vec::new();
        for spec in specs {
            let here = centre.value(spec);
            for value in steps(spec, &here, stride).into_iter().filter(|next| is_wanted(&here, next)) {
                let measured = self.measure(&centre.with(spec.key, &value), size_index)?;
                if measured.refused.is_none() {
                    moves.push(Move {
                        key: spec.key,
                        value,
                        error: (measured.error().max(1e-9) / error.max(1e-9)).ln(),
                        load: self.load(centre.kind, size_index, &measured) - load,
                    });
                }
            }
        }
        Ok(moves)
    }
}
