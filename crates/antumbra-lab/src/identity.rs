//! Identity of results: everything that they depend on. A file is resumed only if all of it is equal.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::device::LabDevice;
use crate::error::LabError;
use crate::output_files::{FileError, read_json};

/// Program, adapter and settings of a run, as stored in its file: `antumbra` (the version), `commit`,
/// `adapter`, `driver`, `backend`, `settings`.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity(Map<String, Value>);

impl Identity {
    /// Creates the identity of a run from device, commit of the program, and settings (an object).
    pub fn new(lab: &LabDevice, commit: &str, settings: &Value) -> Self {
        let adapter = &lab.adapter;
        let map = json!({
            "antumbra": env!("CARGO_PKG_VERSION"),
            "commit": commit,
            "adapter": adapter.name,
            "driver": adapter.driver_and_version(),
            "backend": adapter.backend.to_string(),
            "settings": settings,
        });
        let Value::Object(map) = map else { unreachable!("it is written as an object") };
        Self(map)
    }

    /// Returns the keys and values for a file.
    pub fn entries(&self) -> impl Iterator<Item = (&String, &Value)> {
        self.0.iter()
    }

    /// Returns the settings as stored in a file.
    pub fn settings(&self) -> &Value {
        &self.0["settings"]
    }

    /// Checks that the file at `path`, with the keys `there`, belongs to this run.
    ///
    /// # Errors
    /// A line with the first key that differs, its two values, and a remedy.
    pub fn check(&self, path: &Path, there: &Value) -> Result<(), LabError> {
        let Some((key, there, here)) = self.difference(there) else { return Ok(()) };
        Err(LabError::Request(format!(
            "--resume {}: its {key} is {}, but this run has {}; repeat the command that wrote it, or omit --resume to measure again",
            path.display(),
            short(&there),
            short(&here)
        )))
    }

    /// Returns the first key that differs from a file, and its values there and here; for settings, the nested key.
    fn difference(&self, there: &Value) -> Option<(String, Value, Value)> {
        let differs = |(key, here): &(&String, &Value)| there.get(key.as_str()) != Some(here);
        let (key, here) = self.0.iter().find(differs)?;
        let there = there.get(key.as_str()).cloned().unwrap_or_default();
        if let (Value::Object(here), Value::Object(there)) = (here, &there) {
            let keys = here.keys().chain(there.keys());
            let key = keys.into_iter().find(|key| here.get(key.as_str()) != there.get(key.as_str()))?;
            let of = |map: &Map<String, Value>| map.get(key.as_str()).cloned().unwrap_or_default();
            return Some((key.replace('_', " "), of(there), of(here)));
        }
        Some((key.clone(), there, here.clone()))
    }
}

/// Returns a value as one line, truncated to 80 characters.
fn short(value: &Value) -> String {
    let text = match value {
        Value::Null => return "none".to_owned(),
        value => value.to_string(),
    };
    if text.chars().count() > 80 { format!("{}…", text.chars().take(79).collect::<String>()) } else { text }
}

/// Reads a file's JSON; `None` if there is no such file, so that the same command line also starts a new run.
///
/// # Errors
/// If the file cannot be read, or is not JSON of this format.
pub fn read_to_resume(path: &Path, format: &str) -> Result<Option<Value>, LabError> {
    const REMEDY: &str = "omit --resume to measure again, or name another file";
    if !path.exists() {
        return Ok(None);
    }
    let value: Value = read_json(path, REMEDY)?;
    if value["format"] != format {
        return Err(FileError::bad_content(path, format!("it is not a file of the format {format}"), REMEDY).into());
    }
    Ok(Some(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        let map = json!({ "antumbra": "1.0.0", "commit": "abc", "adapter": "card", "settings": { "frames": 5, "size": [64, 36] } });
        Identity(map.as_object().unwrap().clone())
    }

    #[test]
    fn what_differs_is_said_in_one_line() {
        let same = json!({ "rows": [], "settings": { "size": [64, 36], "frames": 5 }, "adapter": "card", "commit": "abc", "antumbra": "1.0.0" });
        let refused = |key: &str, value: Value| {
            let mut there = same.clone();
            there[key] = value;
            identity().check(Path::new("t.json"), &there).unwrap_err().to_string()
        };
        identity().check(Path::new("t.json"), &same).unwrap();
        assert!(refused("commit", json!("def")).starts_with(
            "--resume t.json: its commit is \"def\", but this run has \"abc\"; repeat the command that wrote it, or omit --resume"
        ));
        assert!(refused("adapter", json!("other")).contains("its adapter is \"other\", but this run has \"card\""));
        assert!(refused("antumbra", json!("0.9.0")).contains("its antumbra is \"0.9.0\""));
        let frames = refused("settings", json!({ "frames": 9, "size": [64, 36] }));
        assert!(frames.contains("its frames is 9, but this run has 5"), "{frames}");
        let more = refused("settings", json!({ "frames": 5, "size": [64, 36], "other_key": 1 }));
        assert!(more.contains("its other key is 1, but this run has none"), "{more}");
        assert!(refused("settings", Value::Null).contains("its settings is none"));
    }

    #[test]
    fn only_files_of_the_format_are_resumed() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("t.json");
        assert_eq!(read_to_resume(&path, "antumbra-test").unwrap(), None);
        for text in ["", "[]", "{}", r#"{"format":"antumbra-other"}"#] {
            std::fs::write(&path, text).unwrap();
            let error = read_to_resume(&path, "antumbra-test").unwrap_err().to_string();
            assert!(error.ends_with("name another file") && !error.contains('\n'), "{error}");
        }
        std::fs::write(&path, r#"{"format":"antumbra-test","rows":[]}"#).unwrap();
        assert!(read_to_resume(&path, "antumbra-test").unwrap().is_some());
    }
}
