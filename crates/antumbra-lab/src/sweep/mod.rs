//! Sweep: comparisons too large for one machine. Many scenes, sizes and settings are independent jobs in files.
//!
//! ```text
//! plan.json ─► shard 1/n ─► results/00000.json … ─┐
//!          └─► shard 2/n ─► results/00400.json … ─┴─► merged: one file
//! ```
//!
//! There is no scheduler and no state but files. A shard runs those of its jobs that have no result yet, and each result appears
//! completely or not at all. So a cluster's job array, GNU parallel or a loop may start and restart shards. A shard consists of
//! consecutive jobs, so that jobs with the same scene and size share its ground truth.

mod merge;
mod plan;
mod run;
#[cfg(test)]
mod tests;

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use merge::{Merged, merge};
pub use plan::{Job, Plan, PlannedScene, Shard};
pub use run::{Done, run_shard};

use crate::device::LabDevice;
use crate::output_files::{FileError, read_json};

/// File name of the plan in a sweep's folder.
pub const PLAN_NAME: &str = "plan.json";
/// Folder name of the results beside it.
const RESULTS_NAME: &str = "results";

/// Origin of a result. Results of different origins are not merged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Origin {
    commit: String,
    adapter: String,
    driver: String,
    backend: String,
    software: bool,
}

impl Origin {
    fn here(lab: &LabDevice, commit: &str) -> Self {
        Self {
            commit: commit.to_owned(),
            adapter: lab.adapter.name.clone(),
            driver: lab.adapter.driver_and_version(),
            backend: lab.adapter.backend.to_string(),
            software: lab.adapter.is_software(),
        }
    }

    /// Returns the first difference to another origin: its name, and the values there and here.
    fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        let pairs = [
            ("commit", &other.commit, &self.commit),
            ("adapter", &other.adapter, &self.adapter),
            ("driver", &other.driver, &self.driver),
            ("backend", &other.backend, &self.backend),
        ];
        pairs
            .into_iter()
            .find(|(_, there, here)| there != here)
            .map(|(what, there, here)| (what, there.clone(), here.clone()))
    }
}

/// Result of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct JobResult {
    format: String,
    version: u32,
    /// Fingerprint of the plan's text.
    plan: String,
    #[serde(flatten)]
    origin: Origin,
    job: Job,
    /// Reason why the job could not run; the following fields are empty then.
    skipped: Option<String>,
    parameters: Map<String, Value>,
    metrics: Value,
    timings: Value,
    memory_bytes: Option<u64>,
    /// Sizes of maps whose size is `auto`; missing in older results.
    #[serde(default)]
    auto_map_sizes: Vec<u32>,
}

const RESULT_FORMAT: &str = "antumbra-sweep-result";
const VERSION: u32 = 1;

fn read_result(path: &Path) -> Result<JobResult, FileError> {
    const REMEDY: &str = "remove the file and run its shard again";
    let result: JobResult = read_json(path, REMEDY)?;
    if result.format != RESULT_FORMAT || result.version != VERSION {
        return Err(FileError::bad_content(path, "it is not a result of this version", REMEDY));
    }
    Ok(result)
}

/// Reads all results of a folder in the order of jobs; empty before the first shard has run.
fn results_in(dir: &Path) -> Result<Vec<JobResult>, FileError> {
    let folder = dir.join(RESULTS_NAME);
    let Ok(entries) = std::fs::read_dir(&folder) else { return Ok(Vec::new()) };
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    // Hidden files are unfinished.
    let is_result = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.ends_with(".json") && !name.starts_with('.')
    };
    paths.retain(is_result);
    paths.sort();
    paths.iter().map(|path| read_result(path)).collect()
}
