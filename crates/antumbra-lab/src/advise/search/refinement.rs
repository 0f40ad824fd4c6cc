//! Refinement of a technique: steps of its parameters from its best configuration, alone and several at once.

use antumbra::TechniqueKind;
use antumbra::contract::ParamSpec;

use super::Search;
use super::combinations::{Move, combinations};
use crate::advise::bench::FULL;
use crate::advise::space::{Config, Stride, axes, set_by_qualities, steps};
use crate::advise::store::Measured;
use crate::error::LabError;

/// A move whose error differs by less, and that saves less time, is not tried again on larger pictures.
const RELEVANT: f64 = 0.01;
const RELEVANT_SAVING: f64 = 0.08;
/// So many parameters of a technique are tried again, those that did most.
const MOST_RELEVANT: usize = 6;
/// At the full size a better configuration is started from again where the score falls to this part.
const LEADS_ON: f64 = 0.95;
/// From what takes more than so many times the budget only ways down are looked for, so many times.
const TOO_DEAR: f64 = 1.3;
const DESCENTS: usize = 3;

impl Search<'_, '_> {
    /// Moves every parameter of a technique's best by a step (or those of some keys), then several at once as the moves promise.
    /// Which keys mattered.
    pub(super) fn refine(
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
