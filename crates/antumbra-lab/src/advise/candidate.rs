//! Candidates from measurements.

use antumbra::contract::ParamValue;
use serde_json::{Map, Value};

use super::{Candidate, Config, Measured};

/// Returns the candidate of a configuration that was timed once.
pub(super) fn candidate(config: &Config, measured: &Measured, budget_ms: &[f64]) -> Candidate {
    let choice = config.choice();
    let parameters: Map<String, Value> = choice
        .settings
        .iter()
        .map(|(key, value)| {
            let spec = config.kind.param_specs().iter().find(|spec| spec.key == key);
            let is_text = spec.is_none_or(|spec| {
                spec.range.is_none() && matches!(spec.default, ParamValue::Choice(_) | ParamValue::List(_))
            });
            let number = serde_json::from_str(value).ok().filter(|_| !is_text);
            (key.clone(), number.unwrap_or_else(|| Value::String(value.clone())))
        })
        .collect();
    let pace = measured.pace();
    let mut one = Candidate {
        name: config.to_string(),
        technique: config.kind.name(),
        parameters,
        rmse: measured.error(),
        rmse_of_views: measured.rmse.clone(),
        roughness: measured.roughness(),
        ms: measured.ms.iter().map(|ms| ms / pace).collect(),
        spread_ms: measured.spread_ms.iter().map(|spread| spread.map(|ms| ms / pace)).collect(),
        turns: 1,
        count: measured.count,
        load: 0.0,
        highest_load: 0.0,
        heaviest_view: 0,
        memory_bytes: measured.memory_bytes,
        flicker: None,
        config: config.clone(),
    };
    one.weigh(budget_ms);
    one
}
