//! File of `bench --json`: complete after each measurement, and resumable.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::{BenchRow, BenchRows, Frames};
use crate::device::AdapterReport;
use crate::error::LabError;
use crate::identity::{Identity, read_to_resume};
use crate::output_files::FileError;

/// Format name of the file.
pub const FORMAT: &str = "antumbra-bench";
/// Format version. It rises when a key changes its meaning or is removed.
const VERSION: u32 = 1;

/// Returns the file's content: identity, rows, and names of missing rows. During the run, it lists only rows with a result. At the end, it
/// lists every planned row; missing ones state that no time was left.
pub fn file_json(
    identity: &Identity,
    adapter: &AdapterReport,
    frames: Frames,
    rows: &BenchRows,
    is_over: bool,
) -> Value {
    let mut json = Map::new();
    json.insert("format".into(), FORMAT.into());
    json.insert("version".into(), VERSION.into());
    json.extend(identity.entries().map(|(key, value)| (key.clone(), value.clone())));
    json.insert("software".into(), adapter.is_software().into());
    json.insert("warm_up".into(), frames.warm_up.into());
    json.insert("frames".into(), frames.timed.into());
    json.insert("missing".into(), json!(rows.missing_names()));
    json.insert("rows".into(), json!(if is_over { rows.all() } else { rows.rows.clone() }));
    Value::Object(json)
}

/// Reads the rows with a result from a file of the same run; empty if there is no file.
///
/// # Errors
/// If the file cannot be read, belongs to another run, or has other content.
pub fn rows_to_resume(path: &Path, identity: &Identity) -> Result<Vec<BenchRow>, LabError> {
    let Some(json) = read_to_resume(path, FORMAT)? else { return Ok(Vec::new()) };
    identity.check(path, &json)?;
    let missing: BTreeSet<String> = serde_json::from_value(json["missing"].clone()).unwrap_or_default();
    Ok(rows_in(path, &json)?.into_iter().filter(|row| !missing.contains(&row.name)).collect())
}

/// Returns the rows of a file of `bench --json` or `bench --share`.
///
/// # Errors
/// If the file has no such rows.
pub fn rows_in(path: &Path, json: &Value) -> Result<Vec<BenchRow>, FileError> {
    let remedy = "give a file that `antumbra bench` wrote";
    serde_json::from_value(json["rows"].clone())
        .map_err(|error| FileError::bad_content(path, error.to_string(), remedy))
}
