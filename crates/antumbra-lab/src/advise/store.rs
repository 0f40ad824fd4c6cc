//! What has been measured, in memory and in a file, so that work that was stopped goes on.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::space::Config;
use crate::error::LabError;
use crate::output_files::{FileError, write_atomically};

/// The file in the folder of an advice.
pub const MEASUREMENTS_NAME: &str = "measurements.json";

const FORMAT: &str = "antumbra-measurements";
const VERSION: u32 = 1;

/// The file is written no oftener.
const WRITE_EVERY: Duration = Duration::from_secs(1);

/// A configuration measured at one size, on every view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Why it could not be; the rest is empty then.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub refused: Option<String>,
    /// Root mean square error against the truth, by view.
    pub rmse: Vec<f64>,
    /// Median milliseconds a frame, by view.
    pub ms: Vec<f64>,
    /// Their 10th and 90th percentiles.
    pub spread_ms: Vec<[f64; 2]>,
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
        let squares: f64 = self.rmse.iter().map(|rmse| rmse * rmse).sum();
        (squares / self.rmse.len().max(1) as f64).sqrt()
    }

    /// The largest part of the budget that a view takes.
    pub fn load(&self, budget_ms: &[f64]) -> f64 {
        let pace = if self.pace > 0.0 { self.pace } else { 1.0 };
        self.ms.iter().zip(budget_ms).map(|(ms, budget)| ms / budget / pace).fold(0.0, f64::max)
    }
}

#[derive(Debug, Serialize, Deserialize)]
struct File {
    format: String,
    version: u32,
    about: Value,
    rows: BTreeMap<String, Measured>,
}

/// All measurements.
#[derive(Debug)]
pub(super) struct Store {
    path: Option<PathBuf>,
    file: File,
    written: Instant,
    /// What this run has measured itself.
    pub(super) fresh: usize,
}

impl Store {
    /// That of a folder, with what stands there from before; without one, of memory alone. `about` is what measurements hang on.
    ///
    /// # Errors
    /// Where the folder's file is of something else, or cannot be read or written.
    pub(super) fn open(dir: Option<&Path>, about: Value) -> Result<Self, LabError> {
        let path = dir.map(|dir| dir.join(MEASUREMENTS_NAME));
        let mut file = File { format: FORMAT.into(), version: VERSION, about, rows: BTreeMap::new() };
        if let Some(path) = path.as_deref().filter(|path| path.exists()) {
            let there = read(path)?;
            if let Some(why) = difference(&there.about, &file.about) {
                return Err(LabError::Request(format!("{}: {why}; name another folder", path.display())));
            }
            file.rows = there.rows;
        }
        let store = Self { path, file, written: Instant::now(), fresh: 0 };
        store.write()?;
        Ok(store)
    }

    pub(super) fn get(&self, config: &Config, place: &str) -> Option<&Measured> {
        self.file.rows.get(&key(config, place))
    }

    pub(super) fn insert(&mut self, config: &Config, place: &str, measured: Measured) -> Result<(), LabError> {
        self.file.rows.insert(key(config, place), measured);
        self.fresh += 1;
        if self.written.elapsed() >= WRITE_EVERY {
            self.write()?;
            self.written = Instant::now();
        }
        Ok(())
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Measured> {
        self.file.rows.values()
    }

    pub(super) fn write(&self) -> Result<(), LabError> {
        let Some(path) = &self.path else { return Ok(()) };
        let text = serde_json::to_string_pretty(&self.file).expect("JSON has text");
        Ok(write_atomically(path, format!("{text}\n").as_bytes())?)
    }
}

fn key(config: &Config, place: &str) -> String {
    let settings: String = config.settings.iter().map(|(key, value)| format!(" {key}={value}")).collect();
    format!("{place} {}{settings}", config.kind)
}

fn read(path: &Path) -> Result<File, FileError> {
    const REMEDY: &str = "name another folder, or move the file away";
    let text = std::fs::read_to_string(path).map_err(|error| FileError::from_read(path, &error))?;
    let file: File =
        serde_json::from_str(&text).map_err(|error| FileError::bad_content(path, error.to_string(), REMEDY))?;
    if file.format != FORMAT || file.version != VERSION {
        return Err(FileError::bad_content(path, "it holds no measurements of this version", REMEDY));
    }
    Ok(file)
}

/// The first key in which two descriptions differ.
fn difference(there: &Value, here: &Value) -> Option<String> {
    let keys = here.as_object()?.keys();
    let differs = |key: &&String| there.get(key.as_str()) != here.get(key.as_str());
    let short = |value: Option<&Value>| {
        let text = value.map_or_else(|| "none".to_owned(), Value::to_string);
        if text.chars().count() > 60 { format!("{}…", text.chars().take(59).collect::<String>()) } else { text }
    };
    keys.into_iter()
        .find(differs)
        .map(|key| format!("its {key} is {}, and here it is {}", short(there.get(key)), short(here.get(key))))
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
        let other = Store::open(Some(dir.path()), json!({ "commit": "def" })).unwrap_err().to_string();
        assert!(other.contains("its commit is \"abc\", and here it is \"def\"; name another folder"), "{other}");
        std::fs::write(dir.path().join(MEASUREMENTS_NAME), "{}").unwrap();
        assert!(Store::open(Some(dir.path()), json!({})).unwrap_err().to_string().contains("move the file away"));
    }
}
