//! Timing of every pass of every technique: scenes × sizes × techniques.

mod file;

use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::{Duration, Instant};

use antumbra_scene::{Scene, Setup};
use glam::UVec2;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use file::{FORMAT, file_json, rows_in, rows_to_resume};

use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::limits::{Limits, Pace, Planned};
use crate::names::numbered;
use crate::progress::Progress;
use crate::technique_run::{StartUp, TechniqueChoice, TechniqueRun, Timing, Timings, create, parameters_of};
use crate::view::View;

/// Scene to measure.
#[derive(Clone, Debug)]
pub struct BenchScene {
    /// Scene as named on the command line: `builtin:street`, a path.
    pub spec: String,
    /// Geometry and materials.
    pub scene: Scene,
    /// Camera and lights.
    pub setup: Setup,
    /// Index of the measured light.
    pub light: usize,
}

/// Number of frames of a measurement, if time permits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// Number of warm-up frames.
    pub warm_up: u32,
    /// Number of timed frames.
    pub timed: u32,
}

/// Request for measurements.
#[derive(Clone, Copy, Debug)]
pub struct BenchRequest<'a> {
    /// Scenes to measure.
    pub scenes: &'a [BenchScene],
    /// Techniques to measure.
    pub choices: &'a [TechniqueChoice],
    /// Image sizes, pixels.
    pub sizes_px: &'a [UVec2],
    /// Frames of a measurement.
    pub frames: Frames,
    /// Total time, shared equally by the measurements.
    pub at_most: Duration,
    /// Deadline of the run, and time limit per technique.
    pub limits: Limits,
}

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchRow {
    /// Name: `builtin:street, 640x360, pcss`. Techniques of the same name with other settings are numbered: `pcss, 2`.
    #[serde(default)]
    pub name: String,
    /// Scene as named on the command line.
    pub scene: String,
    /// Number of drawn triangles.
    pub triangles: usize,
    /// Name of the light.
    pub light: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Name of the technique.
    pub technique: String,
    /// All parameters with their values.
    pub parameters: Map<String, Value>,
    /// Time limit that cut the measurement short, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cut_short_s: Option<f64>,
    /// Total duration of the measurement, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Outcome of the measurement.
    #[serde(flatten)]
    pub outcome: BenchOutcome,
}

/// Outcome of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BenchOutcome {
    /// The measurement ran.
    Ran {
        /// Times of frames and passes.
        timings: Timings,
        /// GPU memory that the technique holds, bytes.
        memory_bytes: u64,
        /// Side of each map whose size is `auto`, texels.
        #[serde(default)]
        auto_map_sizes: Vec<u32>,
        /// Time before the first result.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        start_up: Option<StartUp>,
    },
    /// Reason why there is no result: unsupported by the device, unsuitable scene, or no time left.
    Skipped(String),
}

/// Reason of rows for which no time was left.
const NO_TIME: &str = "no time was left";

/// Rows of a run in progress.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BenchRows {
    /// Measured or unsupported rows, in the plan's order.
    pub rows: Vec<BenchRow>,
    /// Rows not measured yet, in the plan's order; each states that no time was left.
    pub missing: Vec<BenchRow>,
}

impl BenchRows {
    /// Returns all rows, including those for which no time was left.
    pub fn all(&self) -> Vec<BenchRow> {
        self.rows.iter().chain(&self.missing).cloned().collect()
    }

    /// Returns the names of the missing rows.
    pub fn missing_names(&self) -> Vec<&str> {
        self.missing.iter().map(|row| row.name.as_str()).collect()
    }
}

/// A planned measurement.
struct Job<'a> {
    name: String,
    size_px: UVec2,
    choice: &'a TechniqueChoice,
}

/// Measures every scene at every size with every technique, except `earlier` rows, within `at_most` plus the last running measurement.
/// Each measurement gets an equal share of the remaining time, so time that fast ones do not use goes to slow ones. Rows without time are
/// missing. `each` receives the rows after every measurement.
///
/// # Errors
/// If a parameter is wrong, the device fails, or `each` fails. A technique that the device cannot run is a skipped row.
pub fn bench(
    lab: &LabDevice,
    request: &BenchRequest<'_>,
    earlier: Vec<BenchRow>,
    each: &mut dyn FnMut(&BenchRows) -> Result<(), LabError>,
    progress: &dyn Progress,
) -> Result<BenchRows, LabError> {
    let mut run = Run::new(lab, request, earlier);
    let steps = (request.scenes.len() * request.sizes_px.len() * request.choices.len()) as u64;
    progress.begin("measuring", steps);
    for scene in request.scenes {
        let planned = jobs(request, scene);
        if planned.iter().flatten().all(|job| run.done.contains_key(&job.name)) {
            continue;
        }
        let gpu_scene = Rc::new(GpuScene::upload(lab, &scene.scene));
        for jobs in planned {
            let size_px = jobs[0].size_px;
            let view = View::of_uploaded(lab, &gpu_scene, &scene.setup, size_px)?;
            for job in jobs {
                if run.done.contains_key(&job.name) {
                    continue;
                }
                if let Some(row) = run.measure(&view, scene, &job)? {
                    run.done.insert(job.name, row);
                    each(&run.rows())?;
                }
                progress.reach(run.done.len() as u64);
            }
        }
    }
    progress.end();
    Ok(run.rows())
}

/// Returns a row's name before duplicates are numbered: `builtin:street, 640x360, pcss`.
pub(crate) fn plain_name(scene: &str, size_px: UVec2, technique: &str) -> String {
    format!("{scene}, {}x{}, {technique}", size_px.x, size_px.y)
}

/// Returns the measurements of a scene, by size. Techniques of the same name are numbered.
fn jobs<'a>(request: &BenchRequest<'a>, scene: &BenchScene) -> Vec<Vec<Job<'a>>> {
    let of_size = |&size_px: &UVec2| {
        let names = request.choices.iter().map(|choice| plain_name(&scene.spec, size_px, &choice.name()));
        let names = numbered(names, ", ");
        request.choices.iter().zip(names).map(|(choice, name)| Job { name, size_px, choice }).collect()
    };
    request.sizes_px.iter().map(of_size).collect()
}

/// State of a run.
struct Run<'a> {
    lab: &'a LabDevice,
    request: &'a BenchRequest<'a>,
    /// Time at which the shared time ends.
    over: Instant,
    pace: Pace,
    done: BTreeMap<String, BenchRow>,
}

impl<'a> Run<'a> {
    fn new(lab: &'a LabDevice, request: &'a BenchRequest<'a>, earlier: Vec<BenchRow>) -> Self {
        let mut pace = Pace::new(request.limits);
        let mut done = BTreeMap::new();
        for row in earlier {
            if let Some(seconds) = row.seconds {
                pace.took(Planned::new(&row.technique, UVec2::from_array(row.size)), seconds);
            }
            if !pace.is_longer_than(row.cut_short_s) {
                done.insert(row.name.clone(), row);
            }
        }
        Self { lab, request, over: Instant::now() + request.at_most, pace, done }
    }

    /// Makes one measurement; `None` if no time is left.
    fn measure(&mut self, view: &View<'_>, scene: &BenchScene, job: &Job<'_>) -> Result<Option<BenchRow>, LabError> {
        let left = self.over.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(None);
        }
        let Self { lab, request, pace, .. } = self;
        let all = request.scenes.len() * request.sizes_px.len() * request.choices.len();
        let share = left / (all - self.done.len()).max(1) as u32;
        let Frames { warm_up, timed } = request.frames;
        let began = Instant::now();
        let technique = job.choice.name();
        let ran = pace.measure(Planned::new(&technique, job.size_px), |end| {
            let mut technique = create(&lab.gpu(), job.choice)?;
            let timing = Timing { warm_up, frames: timed, at_least: Duration::ZERO, at_most: share, end };
            Ok((parameters_of(&technique), view.run(&mut technique, scene.light, &timing)?))
        });
        let mut row = empty_row(scene, view, job);
        row.seconds = Some(began.elapsed().as_secs_f64());
        match ran {
            Ok(None) => return Ok(None),
            Ok(Some((parameters, run))) => {
                let TechniqueRun { timings, memory_bytes, auto_map_sizes, start_up, cut_short_s, .. } = run;
                (row.parameters, row.cut_short_s) = (parameters, cut_short_s);
                row.outcome = BenchOutcome::Ran { timings, memory_bytes, auto_map_sizes, start_up: Some(start_up) };
            }
            Err(error) => {
                let Some(why) = error.why_skipped() else { return Err(error) };
                (row.outcome, row.cut_short_s) = (BenchOutcome::Skipped(why), error.limit_s());
            }
        }
        Ok(Some(row))
    }

    fn rows(&self) -> BenchRows {
        let mut rows = BenchRows::default();
        for scene in self.request.scenes {
            for job in jobs(self.request, scene).into_iter().flatten() {
                match self.done.get(&job.name) {
                    Some(row) => rows.rows.push(row.clone()),
                    None => rows.missing.push(unmeasured(scene, &job)),
                }
            }
        }
        rows
    }
}

fn empty_row(scene: &BenchScene, view: &View<'_>, job: &Job<'_>) -> BenchRow {
    BenchRow { triangles: view.triangle_count(), ..unmeasured(scene, job) }
}

/// Returns the row of a measurement for which no time is left.
fn unmeasured(scene: &BenchScene, job: &Job<'_>) -> BenchRow {
    BenchRow {
        name: job.name.clone(),
        scene: scene.spec.clone(),
        triangles: scene.scene.triangle_count(),
        light: scene.setup.lights[scene.light].name.clone(),
        size: job.size_px.to_array(),
        technique: job.choice.name(),
        parameters: Map::new(),
        cut_short_s: None,
        seconds: None,
        outcome: BenchOutcome::Skipped(NO_TIME.into()),
    }
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use antumbra_scene::{LoadOptions, load};

    use super::*;
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;

    const SIZES_PX: [UVec2; 1] = [UVec2::new(32, 18)];

    fn scenes() -> [BenchScene; 1] {
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let setup = Setup::for_scene(&scene);
        [BenchScene { spec: "builtin:overlap".into(), scene, setup, light: 0 }]
    }

    fn outcomes(rows: &BenchRows) -> Vec<String> {
        let of = |row: BenchRow| match row.outcome {
            BenchOutcome::Ran { timings, .. } => format!("{} {}", row.technique, timings.frames),
            BenchOutcome::Skipped(why) => why,
        };
        rows.all().into_iter().map(of).collect()
    }

    #[test]
    fn rows_without_time_are_reported_and_measured_on_resume() {
        let Some(lab) = lab_or_skip() else { return };
        let scenes = scenes();
        let choices = [TechniqueKind::Hard, TechniqueKind::Pcf].map(TechniqueChoice::default_of);
        let request = |at_most, limits| BenchRequest {
            scenes: &scenes,
            choices: &choices,
            sizes_px: &SIZES_PX,
            frames: Frames { warm_up: 1, timed: 3 },
            at_most,
            limits,
        };
        let minute = Duration::from_secs(60);
        let run = |request, earlier| bench(lab, &request, earlier, &mut |_| Ok(()), &Silent).unwrap();
        let none = run(request(Duration::ZERO, Limits::default()), Vec::new());
        assert_eq!((outcomes(&none), none.missing.len()), (vec![NO_TIME.to_owned(); 2], 2));
        let over = Limits { deadline: Some(Instant::now()), technique: None };
        assert_eq!(run(request(minute, over), Vec::new()).missing_names()[1], "builtin:overlap, 32x18, pcf");
        let all = run(request(minute, Limits::default()), Vec::new());
        assert_eq!((outcomes(&all), all.missing.len()), (vec!["hard 3".to_owned(), "pcf 3".to_owned()], 0));
        // Existing rows stay unchanged.
        let resumed = run(request(minute, Limits::default()), all.rows[..1].to_vec());
        assert_eq!((&resumed.rows[0], outcomes(&resumed)), (&all.rows[0], outcomes(&all)));
    }

    #[test]
    fn a_technique_beyond_its_limit_is_cut_short_and_said() {
        let Some(lab) = lab_or_skip() else { return };
        let scenes = scenes();
        let choices = [TechniqueKind::Hard, TechniqueKind::Pcf].map(TechniqueChoice::default_of);
        let of = |technique| BenchRequest {
            scenes: &scenes,
            choices: &choices,
            sizes_px: &SIZES_PX,
            frames: Frames { warm_up: 1, timed: 10_000 },
            at_most: Duration::from_secs(600),
            limits: Limits { deadline: None, technique: Some(technique) },
        };
        let run = |limit, earlier| bench(lab, &of(limit), earlier, &mut |_| Ok(()), &Silent).unwrap();
        let nothing = run(Duration::ZERO, Vec::new());
        assert!(outcomes(&nothing).iter().all(|why| why.contains("cut short by the limit of 0 s")), "{nothing:?}");
        let some = run(Duration::from_secs(3), nothing.rows.clone());
        for row in &some.rows {
            let BenchOutcome::Ran { timings, .. } = &row.outcome else { panic!("{row:?}") };
            assert!((1..10_000).contains(&timings.frames) && row.cut_short_s == Some(3.0), "{row:?}");
        }
        assert_eq!(
            run(Duration::from_secs(2), some.rows.clone()).rows,
            some.rows,
            "a shorter limit repeats no measurement"
        );
    }
}
