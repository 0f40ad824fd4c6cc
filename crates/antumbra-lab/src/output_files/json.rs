//! JSON of a file.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::FileError;

/// The value that a file holds.
///
/// # Errors
/// Where it cannot be read, or holds another kind of value: then `remedy` says what would be right.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path, remedy: &str) -> Result<T, FileError> {
    let text = std::fs::read_to_string(path).map_err(|error| FileError::from_read(path, &error))?;
    serde_json::from_str(&text).map_err(|error| FileError::bad_content(path, error.to_string(), remedy))
}
