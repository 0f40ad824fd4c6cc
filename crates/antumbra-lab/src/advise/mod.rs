//! Search for the technique and settings with the least error for a scene within a budget.
//!
//! ```text
//! declarations ─► space ─┐
//! scene, light ─► bench ─┴─► search ─► a few at full size ─► timed in turns ─► advice, words, preset
//! ```
//!
//! Errors are deterministic: light points and parameters' seeds are fixed. Times are medians, and those on which the advice rests are
//! taken in turns with one another and with `pcf`, so that a machine that slows down slows all of them. Where the budget is counted in
//! what `pcf` takes, all times are stated as they would be if `pcf` always took what it took at first: so times, budget and the part
//! of it that is taken are one statement.

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

/// What may be spent on a frame's shadows of the judged light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Milliseconds, on every view.
    Ms(f64),
    /// So many times what `pcf` takes at its defaults, on each view.
    TimesPcf(f64),
}

/// What must be kept besides the budget.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// GPU memory that a technique may hold, bytes.
    pub memory_bytes: Option<u64>,
    /// Visible artefacts, as [`Metrics::roughness`](crate::metrics::Metrics::roughness), over all views.
    pub roughness: Option<f64>,
}

impl Limits {
    /// How many times the most that is allowed; at most 1 where both limits are kept.
    pub fn excess(&self, memory_bytes: u64, roughness: f64) -> f64 {
        let memory = self.memory_bytes.map_or(0.0, |most| memory_bytes as f64 / most as f64);
        memory.max(self.roughness.map_or(0.0, |most| roughness / most))
    }

    /// Whether both are kept.
    pub fn keep(&self, memory_bytes: u64, roughness: f64) -> bool {
        self.excess(memory_bytes, roughness) <= 1.0
    }
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
    /// What a technique may hold, and how rough its picture may be.
    pub limits: Limits,
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
    /// Visible artefacts: the root of the mean square over the views.
    pub roughness: f64,
    /// Median milliseconds, by view.
    pub ms: Vec<f64>,
    /// The least and the most that was seen of those medians, or of frames where it was timed once.
    pub spread_ms: Vec<[f64; 2]>,
    /// Turns in which it was timed, and of each the median was taken; 1 where it was timed once.
    pub turns: u32,
    /// Frames of each turn, and those before them; of the turn that had fewest.
    #[serde(flatten)]
    pub count: FrameCount,
    /// The largest part of its budget that a view takes.
    pub load: f64,
    /// The most that was seen of that.
    pub highest_load: f64,
    /// The view that takes it.
    pub heaviest_view: usize,
    /// GPU memory, bytes.
    pub memory_bytes: u64,
    /// Flicker under a moving camera, where it was asked for.
    pub flicker: Option<f64>,
    /// Itself.
    #[serde(skip)]
    pub config: Config,
}

impl Candidate {
    /// Milliseconds of the view that takes the largest part of its budget.
    pub fn worst_ms(&self) -> f64 {
        self.ms.get(self.heaviest_view).copied().unwrap_or(0.0)
    }

    /// The spread of that view.
    pub fn worst_spread_ms(&self) -> [f64; 2] {
        self.spread_ms.get(self.heaviest_view).copied().unwrap_or_default()
    }

    /// `median of 9 frames after 1`, or of 5 turns of them.
    pub fn counted(&self) -> String {
        match self.turns {
            0 | 1 => self.count.to_string(),
            turns => format!("median of {turns} turns, each {}", self.count),
        }
    }

    /// The same for a table: `5 turns of 9 frames`.
    pub fn counted_briefly(&self) -> String {
        let frames = match self.count.frames {
            1 => "1 frame".to_owned(),
            frames => format!("{frames} frames"),
        };
        if self.turns > 1 { format!("{} turns of {frames}", self.turns) } else { frames }
    }

    /// Holds its times against the budget, by view.
    fn weigh(&mut self, budget_ms: &[f64]) {
        let loads = self.ms.iter().zip(budget_ms).map(|(ms, budget)| ms / budget).enumerate();
        let heaviest = loads.max_by(|a, b| a.1.total_cmp(&b.1));
        (self.heaviest_view, self.load) = heaviest.unwrap_or_default();
        let highest = self.spread_ms.iter().zip(budget_ms).map(|([_, most], budget)| most / budget);
        self.highest_load = highest.fold(0.0, f64::max);
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
    /// What `pcf` takes, milliseconds, by view; none where it does not run here.
    pub pcf_ms: Vec<f64>,
    /// GPU memory that it may hold, bytes.
    pub memory_limit_bytes: Option<u64>,
    /// How rough its picture may be.
    pub roughness_limit: Option<f64>,
    /// What the error is of.
    pub prefer: Prefer,
    /// What each view is like.
    pub facts: Vec<SceneFacts>,
    /// The recommendation, or what comes nearest.
    pub best: Candidate,
    /// Whether that keeps the budget and the limits.
    pub keeps_budget: bool,
    /// Whether the spread of its times crosses the budget.
    pub is_too_noisy_to_tell: bool,
    /// Why.
    pub reasons: Vec<Reason>,
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
    let mut warm =
        Search::new(&bench, &mut store, progress, vec![f64::INFINITY; request.views.len()], Limits::default());
    let base = warm.measure_base()?;
    if let (Some(why), Budget::TimesPcf(_)) = (&base.refused, request.budget) {
        return Err(LabError::Request(format!("--budget: pcf does not run here ({why}); give milliseconds")));
    }
    let budget_ms: Vec<f64> = match request.budget {
        Budget::Ms(ms) => vec![ms; request.views.len()],
        Budget::TimesPcf(times) => base.ms.iter().map(|ms| times * ms).collect(),
    };
    bench.most_ms.set(budget_ms.iter().copied().fold(0.0, f64::max));
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

/// What measurements depend on: all but budget and techniques.
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
