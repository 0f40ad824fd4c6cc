//! Runs a row of an exhibit.

use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

use antumbra_reference::VisibilityOptions;
use antumbra_scene::{LoadOptions, Setup, load};
use glam::UVec2;
use serde::Serialize;

use super::exhibit::{Measure, Row};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::metrics::compare_visibility;
use crate::progress::Silent;
use crate::technique_run::{TechniqueChoice, Timing, create};
use crate::truth::trace;
use crate::view::View;

/// What came of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Milliseconds.
    Ms(f64),
    /// Frames a second, of the shadows alone.
    Fps(f64),
    /// Errors against the truth.
    Error {
        /// Root of the mean squared error.
        rmse: Option<f64>,
        /// Mean visibility where the truth is umbra.
        umbra_leak: Option<f64>,
    },
    /// The library does not have this technique yet.
    NotYet(&'static str),
    /// It could be run, but not here: why.
    Skipped(String),
}

impl fmt::Display for Outcome {
    /// For a table, with its unit.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: &Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.4}"));
        match self {
            Self::Ms(ms) => write!(f, "{ms:.3} ms"),
            Self::Fps(fps) => write!(f, "{fps:.2} fps"),
            Self::Error { rmse, umbra_leak } => {
                write!(f, "rmse {}, umbra leak {}", number(rmse), number(umbra_leak))
            }
            Self::NotYet(technique) => write!(f, "not yet: needs {technique}"),
            Self::Skipped(reason) => write!(f, "skipped: {reason}"),
        }
    }
}

/// The environment variable that names the folder with scenes that are files.
const SCENES_VARIABLE: &str = "ANTUMBRA_SCENES";

/// Light points of the truth: the reference's own. Its noise, below 0.002 rmse but in foliage, is what remains of frames
/// that add up.
const TRUTH_SAMPLES: u32 = 1024;

/// Runs a row, with `frames` timed frames.
///
/// # Errors
/// Where the scene cannot be loaded, or the device fails.
pub fn run_row(lab: &LabDevice, row: &Row, frames: u32) -> Result<Outcome, LabError> {
    let Some(kind) = row.kind() else { return Ok(Outcome::NotYet(row.technique)) };
    let Some(spec) = scene_spec(row.scene) else {
        return Ok(Outcome::Skipped(format!("set {SCENES_VARIABLE} to a folder with {}", row.scene)));
    };
    let settings = row.settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let choice = TechniqueChoice::with_settings(kind, settings);
    let mut technique = match create(&lab.gpu(), &choice) {
        Ok(technique) => technique,
        Err(error @ antumbra::Error::Unsupported { .. }) => return Ok(Outcome::Skipped(error.to_string())),
        Err(error) => return Err(error.into()),
    };
    let scene = load(&spec, &LoadOptions::default())?;
    let mut setup = Setup::for_scene(&scene);
    setup.lights[0] = setup.lights[0].scaled(row.light_scale);
    let size_px = UVec2::new(row.size_px.0, row.size_px.1);
    let timing = if row.frames > 1 {
        Timing { warm_up: 0, frames: row.frames, at_most: Duration::MAX }
    } else {
        Timing { warm_up: frames.min(2), frames, at_most: Duration::from_secs(20) }
    };
    let view = View::new(lab, &scene, &setup, size_px)?;
    let run = view.run(&mut technique, 0, &timing)?;
    Ok(match row.measure {
        Measure::Ms { passes: "", .. } => Outcome::Ms(run.timings.total_ms),
        Measure::Ms { passes, .. } => {
            let meant = run.timings.passes.iter().filter(|pass| pass.label.contains(passes));
            if run.timings.passes.iter().any(|pass| pass.label.contains(passes)) {
                Outcome::Ms(meant.map(|pass| pass.ms).sum())
            } else {
                Outcome::Skipped("this device does not time single passes".to_owned())
            }
        }
        Measure::Fps { .. } => Outcome::Fps(1e3 / run.timings.total_ms.max(f64::MIN_POSITIVE)),
        Measure::Error | Measure::FilteredError => {
            let exact = choice.filtered_truth().filter(|_| row.measure == Measure::FilteredError);
            // Of a filtered truth the tracer tells no more than which pixels are judged.
            let samples = if exact.is_some() { 1 } else { TRUTH_SAMPLES };
            let options = VisibilityOptions { samples, ..VisibilityOptions::default() };
            let one_light = Setup { camera: setup.camera, lights: vec![setup.lights[0].clone()] };
            let mut truths = trace(&scene, &one_light, size_px, &options, &Silent)?;
            truths[0].judge_what_is_seen(&view.surface_points()?, setup.camera.eye);
            let truth = match &exact {
                Some(exact) => &view.run(&mut view.create(exact)?, 0, &Timing { frames: 1, ..timing })?.visibility,
                None => &truths[0].visibility,
            };
            let metrics = compare_visibility(truth, &run.visibility, &truths[0].judged)?;
            Outcome::Error { rmse: metrics.rmse, umbra_leak: metrics.umbra_leak }
        }
    })
}

/// What to load for a row's scene: a built-in, or a file that is here.
fn scene_spec(scene: &str) -> Option<String> {
    if scene.starts_with("builtin:") {
        return Some(scene.to_owned());
    }
    let file = PathBuf::from(std::env::var_os(SCENES_VARIABLE)?).join(scene);
    file.is_file().then(|| file.display().to_string())
}
