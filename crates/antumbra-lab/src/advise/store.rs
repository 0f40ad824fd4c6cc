//! Measurements of a search in a file, from which interrupted searches resume.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::space::Config;
use crate::error::LabError;
use crate::stopwatch::FrameCount;
use crate::store;

/// Name of the file in an advice's folder.
pub const MEASUREMENTS_NAME: &str = "measurements.json";

const KIND: store::Kind = store::Kind { format: "antumbra-measurements", version: 3 };

/// A configuration measured at one size, on every view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Reason why the measurement failed; all other fields are empty then.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub refused: Option<String>,
    /// Root mean square error of each view.
    pub rmse: Vec<f64>,
    /// Visible artefacts (roughness) of each view.
    pub roughness: Vec<f64>,
    /// Median time per frame of each view, milliseconds.
    pub ms: Vec<f64>,
    /// 10th and 90th percentiles of the times, by view.
    pub spread_ms: Vec<[f64; 2]>,
    /// Number of timed and warm-up frames of the view that has fewest.
    pub count: FrameCount,
    /// Fingerprint of each view's mask. Equal masks have equal fingerprints.
    pub masks: Vec<String>,
    /// Median milliseconds of each pass by label, summed over views; empty without timestamps.
    #[serde(default)]
    pub pass_ms: BTreeMap<String, f64>,
    /// Slowdown of the machine since the start, measured with `pcf`; 1 if the budget is in milliseconds.
    pub pace: f64,
    /// Maximum GPU memory over the views, bytes.
    pub memory_bytes: u64,
    /// Duration of the measurement, seconds.
    pub spent_s: f64,
}

impl Measured {
    /// Returns the error over all views: root of the mean square.
    pub fn error(&self) -> f64 {
        root_mean_square(&self.rmse)
    }

    /// Returns the roughness over all views: root of the mean square.
    pub fn roughness(&self) -> f64 {
        root_mean_square(&self.roughness)
    }

    /// Returns the slowdown of the machine; 1 if it was not measured.
    pub(super) fn pace(&self) -> f64 {
        if self.pace > 0.0 { self.pace } else { 1.0 }
    }

    /// Returns the largest fraction of the budget over all views.
    pub fn load(&self, budget_ms: &[f64]) -> f64 {
        self.ms.iter().zip(budget_ms).map(|(ms, budget)| ms / budget / self.pace()).fold(0.0, f64::max)
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

/// All measurements of a search.
#[derive(Debug)]
pub(super) struct Store(store::Store<Measured>);

impl Store {
    /// Opens the store of a folder with its earlier measurements, or a store in memory. `about` is what measurements depend on.
    ///
    /// # Errors
    /// If the folder's file belongs to another request, or cannot be read or written.
    pub(super) fn open(dir: Option<&Path>, about: Value) -> Result<Self, LabError> {
        Ok(Self(store::Store::open(dir.map(|dir| dir.join(MEASUREMENTS_NAME)), KIND, about)?))
    }

    pub(super) fn get(&self, config: &Config, place: &str) -> Option<&Measured> {
        self.0.get(&key(config, place))
    }

    pub(super) fn insert(&mut self, config: &Config, place: &str, measured: Measured) -> Result<(), LabError> {
        self.0.insert(key(config, place), measured)
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Measured> {
        self.0.rows()
    }

    /// Returns the number of measurements made in this run.
    #[cfg(test)]
    pub(super) fn fresh(&self) -> usize {
        self.0.fresh
    }

    pub(super) fn write(&self) -> Result<(), LabError> {
        self.0.write()
    }
}

fn key(config: &Config, place: &str) -> String {
    let settings: String = config.settings.iter().map(|(key, value)| format!(" {key}={value}")).collect();
    format!("{place} {}{settings}", config.kind)
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use serde_json::json;

    use super::*;

    #[test]
    fn measurements_are_found_again_and_others_refused() {
        let dir = tempfile::tempdir().unwrap();
        let about = json!({ "commit": "abc", "scene": "builtin:tree" });
        let pcss = Config::default_of(TechniqueKind::Pcss).with("map_size", "512");
        let size = "64x36/64";
        let measured = Measured { rmse: vec![0.3, 0.4], ms: vec![1.0, 2.0], ..Measured::default() };
        let mut store = Store::open(Some(dir.path()), about.clone()).unwrap();
        store.insert(&pcss, size, measured.clone()).unwrap();
        store.write().unwrap();
        let again = Store::open(Some(dir.path()), about).unwrap();
        assert_eq!(again.get(&pcss, size), Some(&measured));
        assert_eq!(again.get(&pcss, "64x36/256"), None);
        assert!((measured.error() - 0.125_f64.sqrt()).abs() < 1e-12 && measured.load(&[4.0, 1.0]) == 2.0);
    }
}
