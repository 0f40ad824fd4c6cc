//! Which technique, with what settings, for a scene and a budget: searched, not guessed.
//!
//! ```text
//! declarations ─► space ─┐
//! scene, light ─► bench ─┴─► search ─► a few at full size ─► timed in turns ─► advice, words, preset
//! ```
//!
//! Errors are deterministic: light points and parameters' seeds are fixed. Times are medians, and those on which the advice rests are
//! taken in turns with one another and with `pcf`, so that a machine that slows down slows all of them.

mod bench;
mod finalists;
mod grid;
mod search;
mod space;
mod store;
#[cfg(test)]
mod tests;
mod words;

use std::path::Path;

use antumbra::TechniqueKind;
use antumbra_scene::{Scene, Setup};
use glam::UVec2;
use image::RgbImage;
use serde::Serialize;
use serde_json::{Map, Value, json};

pub use space::Config;
pub use store::{MEASUREMENTS_NAME, Measured};

use crate::device::LabDevice;
use crate::error::LabError;
use crate::progress::Progress;
use crate::report::AdapterInfo;
use crate::scene_facts::SceneFacts;
use bench::Bench;
use search::Search;
use store::Store;

/// What may be spent on a frame's shadows of the judged light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Milliseconds, on every view.
    Ms(f64),
    /// So many times what `pcf` takes as it comes, on each view.
    TimesPcf(f64),
}

/// What the error is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Prefer {
    /// The picture as it stands.
    #[default]
    Still,
    /// The picture and its flicker while the camera moves, as the root of the sum of their squares. Looked at for
    /// the last few alone.
    Motion,
}

/// One of the views that an advice holds for.
#[derive(Clone, Debug)]
pub struct AdviseView {
    /// For readers.
    pub name: String,
    /// Index into the request's scenes.
    pub scene: usize,
    /// Camera and lights.
    pub setup: Setup,
    /// Which light is judged.
    pub light: usize,
}

/// What is asked.
#[derive(Clone, Debug)]
pub struct AdviseRequest<'a> {
    /// How the scene was named.
    pub spec: &'a str,
    /// The scene, at one time or several.
    pub scenes: Vec<Scene>,
    /// The views.
    pub views: Vec<AdviseView>,
    /// Width and height of the pictures, pixels.
    pub size_px: UVec2,
    /// Light points of the truth.
    pub samples: u32,
    /// The techniques among which to choose.
    pub kinds: &'a [TechniqueKind],
    /// What a frame may take.
    pub budget: Budget,
    /// GPU memory that a technique may hold, bytes.
    pub memory_bytes: Option<u64>,
    /// What the error is of.
    pub prefer: Prefer,
    /// Every combination of a grid in place of the search.
    pub exhaustive: bool,
    /// The command line.
    pub command: String,
    /// The arguments that say what is seen, for commands that use the result.
    pub scene_arguments: String,
    /// The commit of the program.
    pub commit: &'a str,
}

/// A configuration at the full size.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// As people read it: `pcss map_size=512`.
    pub name: String,
    /// The technique.
    pub technique: &'static str,
    /// What differs from its defaults.
    pub parameters: Map<String, Value>,
    /// The root of the mean square over the views.
    pub rmse: f64,
    /// By view.
    pub rmse_of_views: Vec<f64>,
    /// Median milliseconds, by view.
    pub ms: Vec<f64>,
    /// The least and the most that was seen of those medians, or of frames where it was timed once.
    pub spread_ms: Vec<[f64; 2]>,
    /// The largest part of the budget that a view takes.
    pub load: f64,
    /// The most that was seen of that.
    pub highest_load: f64,
    /// GPU memory, bytes.
    pub memory_bytes: u64,
    /// Flicker under a moving camera, where it was asked for.
    pub flicker: Option<f64>,
    /// Itself.
    #[serde(skip)]
    pub config: Config,
}

impl Candidate {
    /// Of the view that takes longest.
    pub fn worst_ms(&self) -> f64 {
        self.ms.iter().copied().fold(0.0, f64::max)
    }

    /// The spread of that view.
    pub fn worst_spread_ms(&self) -> [f64; 2] {
        let longest = self.spread_ms.iter().zip(&self.ms).max_by(|a, b| a.1.total_cmp(b.1));
        longest.map_or([0.0; 2], |(spread, _)| *spread)
    }

    /// What is to be small.
    pub fn objective(&self) -> f64 {
        self.rmse.hypot(self.flicker.unwrap_or(0.0))
    }
}

/// What an advice cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spent {
    /// Configurations measured, at any size, by this call or those that it goes on from.
    pub measurements: usize,
    /// Seconds that techniques ran for, truth not counted.
    pub seconds: f64,
    /// Configurations of a grid that were left out: some cheaper one of them took more than twice the budget.
    pub left_out: usize,
}

/// The answer.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// How the scene was named.
    pub scene: String,
    /// The views' names.
    pub views: Vec<String>,
    /// The command line.
    pub command: String,
    /// The adapter whose times these are.
    pub adapter: AdapterInfo,
    /// The program's.
    pub commit: String,
    /// When.
    pub date: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Light points of the truth.
    pub samples: u32,
    /// The budget, milliseconds, by view.
    pub budget_ms: Vec<f64>,
    /// What `pcf` takes, milliseconds, by view.
    pub pcf_ms: Vec<f64>,
    /// GPU memory that it may hold, bytes.
    pub memory_limit_bytes: Option<u64>,
    /// What the error is of.
    pub prefer: Prefer,
    /// What each view is like.
    pub facts: Vec<SceneFacts>,
    /// The recommendation, or what comes nearest.
    pub best: Candidate,
    /// Whether that keeps budget and memory.
    pub keeps_budget: bool,
    /// Whether the spread of its times crosses the budget.
    pub is_too_noisy_to_tell: bool,
    /// Why, in words.
    pub reasons: Vec<String>,
    /// The next best, one for each other technique.
    pub runners_up: Vec<Candidate>,
    /// The cheapest that errs less and costs more than may be spent.
    pub next_step: Option<Candidate>,
    /// All that was measured at the full size and that none beats in both error and time.
    pub front: Vec<Candidate>,
    /// What it cost.
    pub spent: Spent,
    /// The first view, shaded with the truth.
    #[serde(skip)]
    pub true_picture: RgbImage,
    /// The first view, shaded with the recommendation.
    #[serde(skip)]
    pub picture: RgbImage,
    /// The recommendation's error on the first view.
    #[serde(skip)]
    pub error_picture: RgbImage,
}

/// Searches, and writes measurements into `dir` as it goes, where there is one; what stands there is not measured again.
///
/// # Errors
/// Where a scene cannot be traced, the folder is of something else, no technique can run, or the device fails.
pub fn advise(
    lab: &LabDevice,
    request: &AdviseRequest<'_>,
    dir: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Advice, LabError> {
    let mut store = Store::open(dir, about(lab, request))?;
    let bench = Bench::new(lab, request, progress)?;
    if !bench.judges_something()? {
        let why = "the light shines on nothing that a camera sees: there is nothing to choose a technique by";
        return Err(LabError::Request(why.into()));
    }
    let mut warm = Search::new(&bench, &mut store, progress, vec![f64::INFINITY; request.views.len()], None);
    let base = warm.measure_base()?;
    if let (Some(why), Budget::TimesPcf(_)) = (&base.refused, request.budget) {
        return Err(LabError::Request(format!("--budget: pcf does not run here ({why}); give milliseconds")));
    }
    let budget_ms: Vec<f64> = match request.budget {
        Budget::Ms(ms) => vec![ms; request.views.len()],
        Budget::TimesPcf(times) => base.ms.iter().map(|ms| times * ms).collect(),
    };
    bench.most_ms.set(budget_ms.iter().copied().fold(0.0, f64::max));
    let mut search = Search::new(&bench, &mut store, progress, budget_ms, request.memory_bytes);
    search.pcf_ms = matches!(request.budget, Budget::TimesPcf(_)).then(|| base.ms.iter().sum());
    let left_out = if request.exhaustive {
        search.run_grid(request.kinds)?
    } else {
        search.run(request.kinds)?;
        0
    };
    let advice = finalists::choose(lab, &mut search, left_out)?;
    store.write()?;
    Ok(advice)
}

/// What measurements hang on: all but budget and techniques.
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
