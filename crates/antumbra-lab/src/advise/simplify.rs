//! Removal of settings that change nothing in this scene, found by rendering with and without them.
//!
//! A parameter may depend on another one (`layers` of `pcss` on `attach_contacts`), on the light, on the casters, or on what the camera
//! happens to see. Such dependencies are measured, not declared, so they cannot become outdated. A setting that leaves every pixel of
//! every view unchanged, and saves no time above noise, is dropped.

use super::bench::FULL;
use super::candidate::candidate;
use super::search::Search;
use super::turns::in_turns;
use super::{Candidate, Config, Prefer};
use crate::error::LabError;

/// Minimum relative gain in error or in time for a setting that changes the mask to be kept.
const GAINS_ERROR: f64 = 0.005;
const GAINS_TIME: f64 = 0.08;

/// Effect of one of the recommendation's settings in this scene, relative to the parameter's default.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Setting {
    pub(super) key: &'static str,
    pub(super) value: String,
    pub(super) default: String,
    /// Ratio of the recommendation's error to the error with the default.
    pub(super) error: f64,
    /// Ratio of the times; `None` if they cannot be told apart.
    pub(super) time: Option<f64>,
}

impl Setting {
    fn gains_nothing(&self) -> bool {
        self.error > 1.0 - GAINS_ERROR && self.time.is_none_or(|time| time > 1.0 - GAINS_TIME)
    }
}

/// Returns a configuration without the settings that change no mask and save no time. Small images are compared first.
pub(super) fn simplest(search: &mut Search<'_, '_>, config: &Config) -> Result<Config, LabError> {
    without_idle(search, config, &[0, FULL])
}

/// Drops idle settings, comparing masks at the given sizes.
fn without_idle(search: &mut Search<'_, '_>, config: &Config, size_indices: &[usize]) -> Result<Config, LabError> {
    let mut plain = config.clone();
    loop {
        let before = plain.clone();
        for (key, _) in &before.settings {
            let other = plain.without(key);
            if draws_the_same(search, &plain, &other, size_indices)? && !saves_time(search, &plain, &other)? {
                plain = other;
            }
        }
        // Repeat, because a setting may have depended on another that is gone.
        if plain == before {
            return Ok(plain);
        }
    }
}

fn draws_the_same(
    search: &mut Search<'_, '_>,
    a: &Config,
    b: &Config,
    size_indices: &[usize],
) -> Result<bool, LabError> {
    for size_index in size_indices {
        let [a, b] = [search.measure(a, *size_index)?, search.measure(b, *size_index)?];
        let has_room = search.limits.memory_bytes.is_none_or(|most| b.memory_bytes <= most.max(a.memory_bytes));
        if a.refused.is_some() || b.refused.is_some() || a.masks != b.masks || !has_room {
            return Ok(false);
        }
    }
    Ok(true)
}

fn saves_time(search: &Search<'_, '_>, config: &Config, other: &Config) -> Result<bool, LabError> {
    let times = in_turns(search, &[config, other])?;
    Ok(times[0].saves(&times[1]))
}

/// Returns a candidate with another name for the same work: times and error stay.
fn renamed(one: &Candidate, plain: &Candidate) -> Candidate {
    Candidate {
        name: plain.name.clone(),
        parameters: plain.parameters.clone(),
        memory_bytes: plain.memory_bytes,
        config: plain.config.clone(),
        ..one.clone()
    }
}

/// Returns a candidate without idle settings.
pub(super) fn simplest_candidate(search: &mut Search<'_, '_>, one: &Candidate) -> Result<Candidate, LabError> {
    let config = simplest(search, &one.config)?;
    as_config(search, one, &config)
}

fn as_config(search: &mut Search<'_, '_>, one: &Candidate, config: &Config) -> Result<Candidate, LabError> {
    if *config == one.config {
        return Ok(one.clone());
    }
    let measured = search.measure(config, FULL)?;
    Ok(renamed(one, &candidate(config, &measured, &search.budget_ms)))
}

/// Drops the recommendation's settings that change nothing, then those that gain too little, and returns the effects of the others.
pub(super) fn simplified(search: &mut Search<'_, '_>, best: &mut Candidate) -> Result<Vec<Setting>, LabError> {
    let plain = without_idle(search, &best.config, &[FULL])?;
    *best = as_config(search, best, &plain)?;
    loop {
        let settings = what_settings_do(search, &best.config)?;
        // Flicker was measured with these settings only.
        if search.bench.request.prefer == Prefer::Motion {
            return Ok(settings);
        }
        let idle: Vec<&str> = settings.iter().filter(|one| one.gains_nothing()).map(|one| one.key).collect();
        let each = idle.iter().map(|key| vec![*key]);
        let mut found = None;
        for keys in std::iter::once(idle.clone()).chain(each).filter(|keys| !keys.is_empty()) {
            let config = keys.iter().fold(best.config.clone(), |config, key| config.without(key));
            found = as_good(search, best, &config)?;
            if found.is_some() {
                break;
            }
        }
        match found {
            Some(plain) => *best = plain,
            None => return Ok(settings),
        }
    }
}

/// Returns a simpler configuration if it is as good as the best in error, budget and memory.
fn as_good(search: &mut Search<'_, '_>, best: &Candidate, config: &Config) -> Result<Option<Candidate>, LabError> {
    let measured = search.measure(config, FULL)?;
    let is_within = search.limits.keep(measured.memory_bytes, measured.roughness());
    if measured.refused.is_some() || measured.error() > (1.0 + GAINS_ERROR) * best.rmse || !is_within {
        return Ok(None);
    }
    let mut one = candidate(config, &measured, &search.budget_ms);
    in_turns(search, &[config])?[0].give(&mut one, &search.budget_ms);
    let keeps = one.load <= best.load.max(1.0) && one.highest_load <= best.highest_load.max(1.0);
    Ok(keeps.then_some(one))
}

fn what_settings_do(search: &mut Search<'_, '_>, best: &Config) -> Result<Vec<Setting>, LabError> {
    let here = search.measure(best, FULL)?;
    let mut others = Vec::new();
    for (key, value) in &best.settings {
        let config = best.without(key);
        let other = search.measure(&config, FULL)?;
        if other.refused.is_none() {
            others.push((*key, value.clone(), config, other.error()));
        }
    }
    let configs: Vec<&Config> = std::iter::once(best).chain(others.iter().map(|(_, _, config, _)| config)).collect();
    let times = if others.is_empty() { Vec::new() } else { in_turns(search, &configs)? };
    let setting = |(i, (key, value, _, error)): (usize, &(&'static str, String, Config, f64))| Setting {
        key,
        value: value.clone(),
        default: best.default_of_key(key),
        error: here.error() / error.max(1e-9),
        time: times[0].over(&times[i + 1]),
    };
    Ok(others.iter().enumerate().map(setting).collect())
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;

    use super::super::bench::Bench;
    use super::super::store::Store;
    use super::super::tests::request;
    use super::super::{Budget, about};
    use super::*;
    use crate::advise::Limits;
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;

    /// Without contact attachment, `pcss` has one layer whatever is requested; with it, `layers` takes effect.
    #[test]
    fn settings_without_effect_are_dropped() {
        let Some(lab) = lab_or_skip() else { return };
        let request = request("builtin:overlap", &[TechniqueKind::Pcss], Budget::Ms(1e3));
        let bench = Bench::new(lab, &request, &Silent).unwrap();
        let mut store = Store::open(None, about(lab, &request)).unwrap();
        let mut search = Search::new(&bench, &mut store, &Silent, vec![1e3], Limits::default());
        let small = Config::default_of(TechniqueKind::Pcss).with("map_size", "128");
        let detached = small.with("attach_contacts", "false");
        let idle = detached.with("layers", "4").with("means", "ranges");
        assert_eq!(simplest(&mut search, &idle).unwrap(), detached);
        let layered = small.with("layers", "1");
        assert_eq!(simplest(&mut search, &layered).unwrap(), layered);
        // The recommendation omits idle settings and stays consistent.
        let measured = search.measure(&idle, FULL).unwrap();
        let mut best = candidate(&idle, &measured, &[1e3]);
        let settings = simplified(&mut search, &mut best).unwrap();
        assert!(best.config.settings.iter().all(|(key, _)| *key != "layers" && *key != "means"), "{best:?}");
        assert_eq!(best.name, best.config.to_string());
        let keys: Vec<&str> = settings.iter().map(|setting| setting.key).collect();
        assert_eq!(keys, best.config.settings.iter().map(|(key, _)| *key).collect::<Vec<_>>());
    }

    /// Masks are compared bit by bit, so every technique must reproduce its mask.
    #[test]
    fn every_technique_draws_the_same_mask_again() {
        let Some(lab) = lab_or_skip() else { return };
        let request = request("builtin:overlap", TechniqueKind::ALL, Budget::Ms(1e3));
        let bench = Bench::new(lab, &request, &Silent).unwrap();
        for kind in TechniqueKind::ALL.iter().copied() {
            // Small maps suffice.
            let has = |key: &str| kind.param_specs().iter().any(|spec| spec.key == key);
            let small = [("map_size", "256"), ("view_size", "128")].into_iter().filter(|(key, _)| has(key));
            let config = small.fold(Config::default_of(kind), |config, (key, value)| config.with(key, value));
            let [first, again] = [(); 2].map(|()| bench.measure_frames(&config, 0, 1).unwrap());
            assert_eq!((first.masks.len(), &first.masks), (1, &again.masks), "{kind}");
        }
    }
}
