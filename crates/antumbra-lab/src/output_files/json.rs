//! JSON files.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::FileError;

/// Reads a value from a file.
///
/// # Errors
/// If the file cannot be read, or has another kind of value; the message then ends with `remedy`.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path, remedy: &str) -> Result<T, FileError> {
    let text = std::fs::read_to_string(path).map_err(|error| FileError::from_read(path, &error))?;
    serde_json::from_str(&text).map_err(|error| FileError::bad_content(path, error.to_string(), remedy))
}
