//! Baselines of `antumbra compare`.

use std::path::{Path, PathBuf};

use antumbra_lab::baseline::{Baseline, Source};
use antumbra_lab::compare::CompareRequest;
use antumbra_lab::error::LabError;
use antumbra_lab::report::METRICS_PATH;
use serde_json::json;

use crate::args::CompareArgs;
use crate::failure::Failure;

/// Reads the baseline of each scene: the given file, or for several scenes the files in the given folder.
pub(super) fn baselines(args: &CompareArgs, folders: &[String]) -> Result<Vec<Option<BaselineFile>>, Failure> {
    let Some(given) = &args.run.baseline else { return Ok(vec![None; folders.len()]) };
    if folders.len() > 1 && given.is_file() {
        let why = format!(
            "--baseline {}: it contains one scene, but this run has several; give the folder that `compare` wrote for the same scenes",
            given.display()
        );
        return Err(Failure::Input(why));
    }
    let read = |folder: &String| {
        let path = if given.is_dir() { given.join(folder).join(METRICS_PATH) } else { given.clone() };
        let baseline = Baseline::read(&path, Source::Compare)?;
        Ok(Some(BaselineFile { path, baseline }))
    };
    folders.iter().map(read).collect()
}

/// A baseline with its path.
#[derive(Clone)]
pub(super) struct BaselineFile {
    pub(super) path: PathBuf,
    pub(super) baseline: Baseline,
}

/// Refuses a baseline of another scene or view.
pub(super) fn check_view(path: &Path, baseline: &Baseline, request: &CompareRequest<'_>) -> Result<(), LabError> {
    let name = request.scene_name();
    let setup = request.setup.relative_to(-request.anchor).to_toml();
    let view = [("name", json!(name)), ("size", json!(request.size_px.to_array())), ("setup", json!(setup))];
    baseline.check_view(path, &view)
}
