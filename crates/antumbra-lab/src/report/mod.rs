//! A comparison as a folder: a page that opens from disk, the numbers as JSON, the pictures.

mod date;
mod model;

pub use date::utc_now;
pub use model::{
    AdapterInfo, IndexEntry, IndexTechnique, Measurement, Outcome, PassTime, Reference, ReferenceInfo, Report, Row,
    SceneInfo,
};

use std::path::Path;

use crate::output_files::FileError;

/// Writes `index.html`, `metrics.json` and the pictures of a report into the folder `dir`, which must exist.
pub fn write_report(_dir: &Path, _report: &Report) -> Result<(), FileError> {
    Ok(())
}

/// Writes an `index.html` that links several reports.
pub fn write_index(_dir: &Path, _entries: &[IndexEntry]) -> Result<(), FileError> {
    Ok(())
}
