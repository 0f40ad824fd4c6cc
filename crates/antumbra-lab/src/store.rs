//! Measurements in memory and in a file, from which interrupted work resumes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::LabError;
use crate::output_files::{FileError, read_json, write_atomically};

/// Minimum time between writes of the file.
const WRITE_EVERY: Duration = Duration::from_secs(1);

/// Kind of file: format of one command, in this program's version.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    /// Format name in the file.
    pub(crate) format: &'static str,
    /// Version of the format.
    pub(crate) version: u32,
}

#[derive(Debug, Serialize, Deserialize)]
struct File<R> {
    format: String,
    version: u32,
    about: Value,
    rows: BTreeMap<String, R>,
}

/// All measurements by name.
#[derive(Debug)]
pub(crate) struct Store<R> {
    path: Option<PathBuf>,
    file: File<R>,
    written: Instant,
    /// Number of measurements made in this run.
    pub(crate) fresh: usize,
}

impl<R: Serialize + DeserializeOwned> Store<R> {
    /// Opens the store of a file with its earlier measurements, or a store in memory. `about` is what measurements depend on.
    ///
    /// # Errors
    /// If the file belongs to another run, or cannot be read or written.
    pub(crate) fn open(path: Option<PathBuf>, kind: Kind, about: Value) -> Result<Self, LabError> {
        let mut file = File { format: kind.format.into(), version: kind.version, about, rows: BTreeMap::new() };
        if let Some(path) = path.as_deref().filter(|path| path.exists()) {
            let there = read(path, kind)?;
            if let Some(why) = difference(&there.about, &file.about) {
                return Err(LabError::Request(format!("{}: {why}; name another folder", path.display())));
            }
            file.rows = there.rows;
        }
        let store = Self { path, file, written: Instant::now(), fresh: 0 };
        store.write()?;
        Ok(store)
    }

    pub(crate) fn get(&self, key: &str) -> Option<&R> {
        self.file.rows.get(key)
    }

    pub(crate) fn insert(&mut self, key: String, measured: R) -> Result<(), LabError> {
        self.file.rows.insert(key, measured);
        self.fresh += 1;
        if self.written.elapsed() >= WRITE_EVERY {
            self.write()?;
            self.written = Instant::now();
        }
        Ok(())
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = &R> {
        self.file.rows.values()
    }

    pub(crate) fn write(&self) -> Result<(), LabError> {
        let Some(path) = &self.path else { return Ok(()) };
        let text = serde_json::to_string_pretty(&self.file).expect("JSON has text");
        Ok(write_atomically(path, format!("{text}\n").as_bytes())?)
    }
}

/// FNV-1a hash of 64 bits (Fowler, Noll, Vo). It distinguishes contents, and is not cryptographic.
pub(crate) fn fingerprint(bytes: impl IntoIterator<Item = u8>) -> String {
    let hash = bytes
        .into_iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
}

fn read<R: DeserializeOwned>(path: &Path, kind: Kind) -> Result<File<R>, FileError> {
    const REMEDY: &str = "name another folder, or move the file away";
    let file: File<R> = read_json(path, REMEDY)?;
    if file.format != kind.format || file.version != kind.version {
        return Err(FileError::bad_content(path, "it contains no measurements of this version", REMEDY));
    }
    Ok(file)
}

/// Returns the first key in which two descriptions differ, with both values.
fn difference(there: &Value, here: &Value) -> Option<String> {
    let keys = here.as_object()?.keys();
    let differs = |key: &&String| there.get(key.as_str()) != here.get(key.as_str());
    let short = |value: Option<&Value>| {
        let text = value.map_or_else(|| "none".to_owned(), Value::to_string);
        if text.chars().count() > 60 { format!("{}…", text.chars().take(59).collect::<String>()) } else { text }
    };
    keys.into_iter()
        .find(differs)
        .map(|key| format!("its {key} is {}, but this run has {}", short(there.get(key)), short(here.get(key))))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const KIND: Kind = Kind { format: "antumbra-test", version: 1 };

    #[test]
    fn fingerprints_are_the_published_ones() {
        assert_eq!(
            [&b""[..], b"a", b"foobar"].map(|bytes| fingerprint(bytes.iter().copied())),
            ["cbf29ce484222325", "af63dc4c8601ec8c", "85944171f73967e8"]
        );
    }

    #[test]
    fn measurements_are_found_again_and_others_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("rows.json");
        let open = |kind, about| Store::<f64>::open(Some(path.clone()), kind, about);
        let about = json!({ "commit": "abc", "scene": "builtin:tree" });
        let mut store = open(KIND, about.clone()).unwrap();
        store.insert("a".to_owned(), 0.25).unwrap();
        store.write().unwrap();
        let again = open(KIND, about.clone()).unwrap();
        assert_eq!((again.get("a"), again.get("b"), again.fresh), (Some(&0.25), None, 0));
        let other = open(KIND, json!({ "commit": "def" })).unwrap_err().to_string();
        assert!(other.contains("its commit is \"abc\", but this run has \"def\"; name another folder"), "{other}");
        let newer = open(Kind { version: 2, ..KIND }, about).unwrap_err().to_string();
        assert!(newer.contains("no measurements of this version"), "{newer}");
        std::fs::write(&path, "{}").unwrap();
        assert!(open(KIND, json!({})).unwrap_err().to_string().contains("move the file away"));
    }
}
