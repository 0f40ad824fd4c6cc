//! Measurements of a search in a file, from which interrupted work is resumed.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::space::Config;
use crate::error::LabError;
use crate::stopwatch::FrameCount;
use crate::store;

/// The file in the folder of an advice.
pub const MEASUREMENTS_NAME: &str = "measurements.json";

const KIND: store::Kind = store::Kind { format: "antumbra-measurements", version: 3 };

/// A configuration measured at one size, on every view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Why it could not be; the rest is empty then.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub refused: Option<String>,
    /// Root mean square error against the truth, by view.
    pub rmse: Vec<f64>,
    /// Visible artefacts, by view.
    pub roughness: Vec<f64>,
    /// Median milliseconds a frame, by view.
    pub ms: Vec<f64>,
    /// Their 10th and 90th percentiles.
    pub spread_ms: Vec<[f64; 2]>,
    /// Of how many frames these are, and after how many; of the view that had fewest.
    pub count: FrameCount,
    /// Fingerprint of the mask by view: equal where every pixel is.
    pub masks: Vec<String>,
    /// Median milliseconds of each pass, over all views together, by label; where the device has timestamps.
    #[serde(default)]
    pub pass_ms: BTreeMap<String, f64>,
    /// How much slower than at first the machine was, by `pcf`'s time; 1 where the budget is in milliseconds.
    pub pace: f64,
    /// GPU memory, bytes, at the most.
    pub memory_bytes: u64,
    /// What measuring it took, seconds.
    pub spent_s: f64,
}

impl Measured {
    /// Over all views: the root of the mean square.
    pub fn error(&self) -> f64 {
        root_mean_square(&self.rmse)
    }

    /// Visible artefacts over all views: the root of the mean square.
    pub fn roughness(&self) -> f64 {
        root_mean_square(&self.roughness)
    }

    /// How many times as long as at the machine's first pace its times are.
    pub(super) fn pace(&self) -> f64 {
        if self.pace > 0.0 { self.pace } else { 1.0 }
    }

    /// The largest part of the budget that a view takes.
    pub fn load(&self, budget_ms: &[f64]) -> f64 {
        self.ms.iter().zip(budget_ms).map(|(ms, budget)| ms / budget / self.pace()).fold(0.0, f64::max)
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

/// All measurements.
#[derive(Debug)]
pub(super) struct Store(store::Store<Measured>);

impl Store {
    /// That of a folder, with what stands there from before; without one, of memory alone. `about` is what measurements depend on.
    ///
    /// # Errors
    /// Where the folder's file is of something else, or cannot be read or written.
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

    /// How many this run has measured itself.
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
