//! Search for the technique and settings with the least error for a scene within a budget.
//!
//! ```text
//! declarations ─► space ─┐
//! scene, light ─► bench ─┴─► search ─► finalists at full size ─► timed in turns ─► advice, reasons, preset
//! ```
//!
//! Errors are deterministic: light samples and parameters' seeds are fixed. Times are medians. The times behind the recommendation are
//! measured in turns with one another and with `pcf`, so that a machine that slows down slows all of them. If the budget is a multiple of
//! `pcf`'s time, all times are scaled to the first measurement of `pcf`, so times, budget and load are consistent.

mod bench;
mod candidate;
mod finalists;
mod grid;
mod reasons;
mod search;
mod simplify;
mod space;
mod store;
#[cfg(test)]
mod tests;
mod turns;

use std::path::Path;

use antumbra::TechniqueKind;
use antumbra_scene::{Scene, Setup};
use glam::UVec2;
use image::RgbImage;
use serde::Serialize;
use serde_json::{Map, Value, json};

pub use reasons::Reason;
pub use space::Config;
pub use store::{MEASUREMENTS_NAME, Measured};

use crate::adapter_info::AdapterInfo;
use crate::device::LabDevice;
use crate::error::LabError;
use crate::progress::Progress;
use crate::scene_facts::SceneFacts;
use crate::stopwatch::FrameCount;
use bench::Bench;
use search::Search;
use store::Store;

/// Time budget of the judged light's shadows per frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Milliseconds, on every view.
    Ms(f64),
    /// Multiple of the time of `pcf` with default parameters, on each view.
    TimesPcf(f64),
}

/// Limits besides the time budget.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// GPU memory that a technique may hold, bytes.
    pub memory_bytes: Option<u64>,
    /// Visible artefacts over all views, see [`Metrics::roughness`](crate::metrics::Metrics::roughness).
    pub roughness: Option<f64>,
}

impl Limits {
    /// Returns the largest ratio of a value to its limit: at most 1 if both limits are kept.
    pub fn excess(&self, memory_bytes: u64, roughness: f64) -> f64 {
        let memory = self.memory_bytes.map_or(0.0, |most| memory_bytes as f64 / most as f64);
        memory.max(self.roughness.map_or(0.0, |most| roughness / most))
    }

    /// Returns whether both limits are kept.
    pub fn keep(&self, memory_bytes: u64, roughness: f64) -> bool {
        self.excess(memory_bytes, roughness) <= 1.0
    }
}

/// Error that the search minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Prefer {
    /// Error of still images.
    #[default]
    Still,
    /// Error of still images and flicker under a moving camera: root of the sum of their squares.
    /// Flicker is measured for the finalists only.
    Motion,
}

/// A view for which the advice holds.
#[derive(Clone, Debug)]
pub struct AdviseView {
    /// Name for display.
    pub name: String,
    /// Index into the request's scenes.
    pub scene: usize,
    /// Camera and lights.
    pub setup: Setup,
    /// Index of the judged light in the setup.
    pub light: usize,
}

/// Request for advice.
#[derive(Clone, Debug)]
pub struct AdviseRequest<'a> {
    /// Scene as named on the command line.
    pub spec: &'a str,
    /// The scene at one or several times.
    pub scenes: Vec<Scene>,
    /// The views.
    pub views: Vec<AdviseView>,
    /// Width and height of the images, pixels.
    pub size_px: UVec2,
    /// Light samples of the ground truth.
    pub samples: u32,
    /// Techniques to choose among.
    pub kinds: &'a [TechniqueKind],
    /// Time budget per frame.
    pub budget: Budget,
    /// Limits of memory and roughness.
    pub limits: Limits,
    /// Error to minimise.
    pub prefer: Prefer,
    /// Whether to measure every combination of a grid instead of searching.
    pub exhaustive: bool,
    /// The command line.
    pub command: String,
    /// Arguments that select scene, camera and light, for commands that use the result.
    pub scene_arguments: String,
    /// Commit of the program.
    pub commit: &'a str,
}

/// A configuration measured at full size.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Name for display: `pcss map_size=512`.
    pub name: String,
    /// The technique.
    pub technique: &'static str,
    /// Parameters that differ from their defaults.
    pub parameters: Map<String, Value>,
    /// Error: root of the mean square over the views.
    pub rmse: f64,
    /// Error of each view.
    pub rmse_of_views: Vec<f64>,
    /// Visible artefacts: root of the mean square over the views.
    pub roughness: f64,
    /// Median time of each view, milliseconds.
    pub ms: Vec<f64>,
    /// Minimum and maximum over the turns of those medians; 10th and 90th percentile of frames if timed once.
    pub spread_ms: Vec<[f64; 2]>,
    /// Number of turns, each with its own median; 1 if timed once.
    pub turns: u32,
    /// Number of timed and warm-up frames of the turn that has fewest.
    #[serde(flatten)]
    pub count: FrameCount,
    /// Largest fraction of the budget over all views.
    pub load: f64,
    /// Largest observed fraction of the budget.
    pub highest_load: f64,
    /// Index of the view with the largest fraction.
    pub heaviest_view: usize,
    /// GPU memory, bytes.
    pub memory_bytes: u64,
    /// Flicker under a moving camera; `None` if not measured.
    pub flicker: Option<f64>,
    /// Configuration.
    #[serde(skip)]
    pub config: Config,
}

impl Candidate {
    /// Returns the median time of the heaviest view, milliseconds.
    pub fn worst_ms(&self) -> f64 {
        self.ms.get(self.heaviest_view).copied().unwrap_or(0.0)
    }

    /// Returns the time spread of the heaviest view, milliseconds.
    pub fn worst_spread_ms(&self) -> [f64; 2] {
        self.spread_ms.get(self.heaviest_view).copied().unwrap_or_default()
    }

    /// Describes the number of frames: `median of 9 frames after 1`, or `median of 5 turns, each …`.
    pub fn counted(&self) -> String {
        match self.turns {
            0 | 1 => self.count.to_string(),
            turns => format!("median of {turns} rounds of {}", self.count),
        }
    }

    /// Describes the number of frames for a table: `5 turns of 9 frames`.
    pub fn counted_briefly(&self) -> String {
        let frames = match self.count.frames {
            1 => "1 frame".to_owned(),
            frames => format!("{frames} frames"),
        };
        if self.turns > 1 { format!("{} turns of {frames}", self.turns) } else { frames }
    }

    /// Updates the loads from times and budget, both by view.
    fn weigh(&mut self, budget_ms: &[f64]) {
        let loads = self.ms.iter().zip(budget_ms).map(|(ms, budget)| ms / budget).enumerate();
        let heaviest = loads.max_by(|a, b| a.1.total_cmp(&b.1));
        (self.heaviest_view, self.load) = heaviest.unwrap_or_default();
        let highest = self.spread_ms.iter().zip(budget_ms).map(|([_, most], budget)| most / budget);
        self.highest_load = highest.fold(0.0, f64::max);
    }

    /// Returns the value to minimise.
    pub fn objective(&self) -> f64 {
        self.rmse.hypot(self.flicker.unwrap_or(0.0))
    }
}

/// Cost of the advice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SearchCost {
    /// Number of measured configurations at any size, in this run and in those that it resumes.
    pub measurements: usize,
    /// Run time of techniques, seconds, without the ground truth.
    pub seconds: f64,
    /// Number of skipped grid combinations: a cheaper one took more than twice the budget.
    pub left_out: usize,
}

/// Advice: the recommendation, its reasons and alternatives.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// Scene as named on the command line.
    pub scene: String,
    /// Names of the views.
    pub views: Vec<String>,
    /// The command line.
    pub command: String,
    /// Adapter on which times were measured.
    pub adapter: AdapterInfo,
    /// Commit of the program.
    pub commit: String,
    /// Date and time, UTC.
    pub date: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Light samples of the ground truth.
    pub samples: u32,
    /// Budget of each view, milliseconds.
    pub budget_ms: Vec<f64>,
    /// Time of `pcf` on each view, milliseconds; empty if it does not run here.
    pub pcf_ms: Vec<f64>,
    /// Limit of GPU memory, bytes.
    pub memory_limit_bytes: Option<u64>,
    /// Limit of roughness.
    pub roughness_limit: Option<f64>,
    /// Error that was minimised.
    pub prefer: Prefer,
    /// Scene facts of each view.
    pub facts: Vec<SceneFacts>,
    /// Recommendation, or the nearest candidate if none keeps budget and limits.
    pub best: Candidate,
    /// Whether the recommendation keeps budget and limits.
    pub keeps_budget: bool,
    /// Whether the spread of its times crosses the budget.
    pub is_too_noisy_to_tell: bool,
    /// Reasons of the recommendation.
    pub reasons: Vec<Reason>,
    /// Best candidate of each other technique.
    pub runners_up: Vec<Candidate>,
    /// Cheapest candidate that errs less and exceeds the budget.
    pub next_step: Option<Candidate>,
    /// Pareto front of error and time among all candidates measured at full size.
    pub front: Vec<Candidate>,
    /// Cost of the search.
    pub spent: SearchCost,
    /// First view, shaded with the ground truth.
    #[serde(skip)]
    pub true_picture: RgbImage,
    /// First view, shaded with the recommendation.
    #[serde(skip)]
    pub picture: RgbImage,
    /// Error map of the recommendation on the first view.
    #[serde(skip)]
    pub error_picture: RgbImage,
}

/// Searches for the best technique and settings. With `dir`, measurements are stored there, and stored ones are reused.
///
/// # Errors
/// If a scene cannot be traced, the folder belongs to another run, no technique can run, or the device fails.
pub fn advise(
    lab: &LabDevice,
    request: &AdviseRequest<'_>,
    dir: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Advice, LabError> {
    let mut store = Store::open(dir, about(lab, request))?;
    let bench = Bench::new(lab, request, progress)?;
    if !bench.judges_something()? {
        let why = "the light reaches no visible surface, so techniques cannot be compared; choose another camera or light with --setup";
        return Err(LabError::Request(why.into()));
    }
    let mut warm =
        Search::new(&bench, &mut store, progress, vec![f64::INFINITY; request.views.len()], Limits::default());
    let base = warm.measure_base()?;
    if let (Some(why), Budget::TimesPcf(_)) = (&base.refused, request.budget) {
        return Err(LabError::Request(format!(
            "--budget: pcf does not run on this adapter ({why}); give the budget in milliseconds"
        )));
    }
    let budget_ms: Vec<f64> = match request.budget {
        Budget::Ms(ms) => vec![ms; request.views.len()],
        Budget::TimesPcf(times) => base.ms.iter().map(|ms| times * ms).collect(),
    };
    bench.max_ms.set(budget_ms.iter().copied().fold(0.0, f64::max));
    let mut search = Search::new(&bench, &mut store, progress, budget_ms, request.limits);
    search.pcf_ms = matches!(request.budget, Budget::TimesPcf(_)).then(|| base.ms.clone());
    let left_out = if request.exhaustive {
        search.run_grid(request.kinds)?
    } else {
        search.run(request.kinds)?;
        0
    };
    let advice = finalists::choose(lab, &mut search, base.ms, left_out)?;
    store.write()?;
    Ok(advice)
}

/// Returns everything that measurements depend on: the request without budget and techniques.
fn about(lab: &LabDevice, request: &AdviseRequest<'_>) -> Value {
    let views = request.views.iter().map(|view| {
        json!({
            "name": view.name,
            "light": view.setup.lights[view.light].name,
            "setup": view.setup.to_toml(),
        })
    });
    json!({
        "adapter": lab.adapter.name,
        "driver": lab.adapter.driver_and_version(),
        "backend": lab.adapter.backend.to_string(),
        "commit": request.commit,
        "scene": request.spec,
        "triangles": request.scenes.iter().map(Scene::triangle_count).collect::<Vec<_>>(),
        "size": request.size_px.to_array(),
        "samples": request.samples,
        "views": views.collect::<Vec<_>>(),
    })
}
