//! Suite: all measurements of BENCHMARKS, run in slices, with the results in one file.
//!
//! ```text
//! plan ─► jobs missing in the file ─► one after the other, the file written after each ─► tables
//! ```
//!
//! A slice starts no job after its time is over, so a few minutes on a machine are enough; the same call resumes it. A file belongs to one
//! adapter and one commit. A job's name has its table, scene and technique.

mod plan;
mod tables;

use std::path::Path;
use std::time::{Duration, Instant};

use antumbra_reference::VisibilityOptions;
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::UVec2;
use serde::Serialize;
use serde_json::{Map, Value, json};

pub use plan::{Group, PaperRow, Part, Plan, Work};
pub use tables::markdown;

use crate::device::LabDevice;
use crate::error::LabError;
use crate::metrics::compare_visibility;
use crate::motion::{MotionOptions, MotionTruth, MovingScene};
use crate::output_files::{FileError, read_json, write_atomically};
use crate::progress::Progress;
use crate::report::utc_now;
use crate::reproduce::{Bench as Rows, Form, RunOptions};
use crate::technique_run::{TechniqueChoice, Timing, create};
use crate::truth::{LightTruth, trace};
use crate::view::View;

/// Name and version of the file's format.
const FORMAT: &str = "antumbra-suite";
const VERSION: u32 = 1;

/// Light samples of every ground truth.
const TRUTH_SAMPLES: u32 = 1024;
/// Timing: medians of five frames after at least three, or of as many as fit into a minute.
const TIMING: Timing =
    Timing { warm_up: 3, frames: 5, at_least: Duration::ZERO, at_most: Duration::from_secs(60), end: None };
/// Number of frames of motions, and metres per frame.
const MOTION_FRAMES: u32 = 16;
const MOTION_STEP_M: f32 = 0.15;

/// Results in a file.
#[derive(Clone, Debug)]
pub struct Results(Map<String, Value>);

/// Progress of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// Number of jobs with results.
    pub jobs: usize,
    /// Number of all jobs.
    pub of: usize,
}

/// Origin of results: a file has only those of one adapter and one commit.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
struct Origin {
    adapter: String,
    driver: String,
    backend: String,
    software: bool,
    commit: String,
}

impl Results {
    /// Reads a file of results.
    ///
    /// # Errors
    /// If the file cannot be read or has other content.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        const REMEDY: &str = "give a file that `antumbra bench --suite` wrote";
        match read_json(path, REMEDY)? {
            Value::Object(map)
                if map.get("format") == Some(&FORMAT.into()) && map.get("version") == Some(&VERSION.into()) =>
            {
                Ok(Self(map))
            }
            _ => Err(FileError::bad_content(path, "it contains no results of a suite", REMEDY)),
        }
    }

    /// Returns the file's results, or none yet. A file of another adapter or commit is an error.
    fn of(path: &Path, origin: &Origin) -> Result<Self, LabError> {
        let about = json!(origin);
        if !path.exists() {
            let mut map = Map::new();
            map.insert("format".into(), FORMAT.into());
            map.insert("version".into(), VERSION.into());
            map.insert("begun".into(), utc_now().into());
            map.insert("rows".into(), Map::new().into());
            map.extend(about.as_object().expect("a struct is an object").clone());
            return Ok(Self(map));
        }
        let read = Self::read(path)?;
        for (key, here) in about.as_object().expect("a struct is an object") {
            let there = read.0.get(key).unwrap_or(&Value::Null);
            if there != here {
                return Err(LabError::Request(format!(
                    "--suite {}: its {key} is {there}, but this run has {here}; name another file",
                    path.display()
                )));
            }
        }
        Ok(read)
    }

    /// Returns a job's result.
    pub fn row(&self, id: &str) -> Option<&Value> {
        self.0.get("rows")?.get(id)
    }

    /// Returns all results.
    fn rows(&self) -> impl Iterator<Item = &Value> {
        self.0.get("rows").and_then(Value::as_object).into_iter().flat_map(Map::values)
    }

    /// Returns the names of all results.
    fn ids(&self) -> impl Iterator<Item = &str> {
        self.0.get("rows").and_then(Value::as_object).into_iter().flat_map(Map::keys).map(String::as_str)
    }

    /// Returns a property of the file: `adapter`, `commit`, `begun`.
    pub fn about(&self, key: &str) -> &str {
        self.0.get(key).and_then(Value::as_str).unwrap_or_default()
    }

    /// Returns whether the adapter was a software renderer.
    pub fn is_of_software(&self) -> bool {
        self.0.get("software") == Some(&true.into())
    }

    fn insert(&mut self, id: String, row: Value) {
        if let Some(Value::Object(rows)) = self.0.get_mut("rows") {
            rows.insert(id, row);
        }
    }

    fn write(&self, path: &Path) -> Result<(), LabError> {
        let text = serde_json::to_string_pretty(&self.0).expect("JSON has text");
        Ok(write_atomically(path, format!("{text}\n").as_bytes())?)
    }

    /// Returns the progress of a plan.
    pub fn done(&self, plan: &Plan) -> Done {
        let (done, missing): (Vec<_>, Vec<_>) = plan.ids().partition(|id| self.row(id).is_some());
        Done { jobs: done.len(), of: done.len() + missing.len() }
    }
}

/// Runs jobs of a plan that `path` lacks, for `at_most` plus the last running job, and writes the file after each job.
///
/// # Errors
/// If the file belongs to another adapter or commit or cannot be written, or the device fails. A technique that the device
/// cannot run is a result with the reason.
pub fn run_slice(
    lab: &LabDevice,
    plan: &Plan,
    path: &Path,
    commit: &str,
    at_most: Duration,
    progress: &dyn Progress,
) -> Result<Done, LabError> {
    let deadline = Instant::now() + at_most;
    let origin = Origin {
        adapter: lab.adapter.name.clone(),
        driver: lab.adapter.driver_and_version(),
        backend: lab.adapter.backend.to_string(),
        software: lab.adapter.is_software(),
        commit: commit.to_owned(),
    };
    let mut results = Results::of(path, &origin)?;
    for group in &plan.groups {
        let lacks = |job: &&(String, TechniqueChoice)| results.row(&group.id(&job.0)).is_none();
        let missing: Vec<_> = group.jobs.iter().filter(lacks).collect();
        if missing.is_empty() || Instant::now() >= deadline {
            continue;
        }
        let bench = Bench::new(lab, group, progress)?;
        let Done { jobs, of } = results.done(plan);
        progress.begin(&format!("{}, {}", group.part.name(), group.scene), of as u64);
        for (finished, (job, choice)) in (jobs..).zip(missing) {
            progress.reach(finished as u64);
            if Instant::now() >= deadline {
                break;
            }
            let row = match bench.run(choice) {
                Ok(row) => row,
                Err(LabError::Technique(error @ antumbra::Error::Unsupported { .. })) => {
                    json!({ "skipped": error.to_string() })
                }
                Err(error @ LabError::NoRoom { .. }) => json!({ "skipped": error.to_string() }),
                Err(error) => return Err(error),
            };
            results.insert(group.id(job), row);
            results.write(path)?;
        }
        progress.end();
    }
    let mut rows = Rows::new(lab, RunOptions::for_device(lab, TIMING.frames));
    for paper in &plan.papers {
        if results.row(&paper.id()).is_some() || Instant::now() >= deadline {
            continue;
        }
        progress.begin(&paper.id(), 0);
        let here = rows.run(paper.row, Form::Published, false, None)?.outcome;
        results.insert(paper.id(), paper.kept(&here.text(&paper.row.measure)));
        results.write(path)?;
        progress.end();
    }
    Ok(results.done(plan))
}

/// Scene of a group with the state that its jobs share.
struct Bench<'a> {
    lab: &'a LabDevice,
    scene: Scene,
    /// Setup with the first light only.
    setup: Setup,
    size_px: UVec2,
    truth: SharedTruth,
}

/// Reference that the jobs of a group share.
enum SharedTruth {
    /// No reference: only times are measured.
    None,
    /// Ground truth of one frame.
    Still(LightTruth),
    /// Ground truth of a motion.
    Moving(MotionOptions, MotionTruth),
}

impl<'a> Bench<'a> {
    fn new(lab: &'a LabDevice, group: &Group, progress: &dyn Progress) -> Result<Self, LabError> {
        let scene = load(&format!("builtin:{}", group.scene), &LoadOptions::default())?;
        let Setup { camera, mut lights } = Setup::for_scene(&scene);
        lights.truncate(1);
        lights[0] = lights[0].scaled(group.light_scale);
        let (setup, size_px) = (Setup { camera, lights }, group.size_px);
        let truth = match group.work {
            Work::Time => SharedTruth::None,
            Work::Error => {
                let options = VisibilityOptions { samples: TRUTH_SAMPLES, ..VisibilityOptions::default() };
                let mut truth = trace(&scene, &setup, size_px, &options, progress)?.swap_remove(0);
                let seen = View::new(lab, &scene, &setup, size_px)?.surface_points()?;
                truth.unjudge_mismatched_surfaces(&seen, setup.camera.eye);
                SharedTruth::Still(truth)
            }
            Work::Motion(motion) => {
                let (frames, step_m) = (MOTION_FRAMES, MOTION_STEP_M);
                let options = MotionOptions { motions: vec![motion], frames, step_m, caster: None, path: Vec::new() };
                let mut moving = MovingScene::new(lab, &scene, &setup, 0, size_px, &options)?;
                let truth = moving.trace(motion, TRUTH_SAMPLES, progress)?;
                SharedTruth::Moving(options, truth)
            }
        };
        Ok(Self { lab, scene, setup, size_px, truth })
    }

    fn run(&self, choice: &TechniqueChoice) -> Result<Value, LabError> {
        let Self { lab, scene, setup, size_px, truth } = self;
        if let SharedTruth::Moving(options, truth) = truth {
            let mut moving = MovingScene::new(lab, scene, setup, 0, *size_px, options)?;
            let figures = moving.run(truth, &mut create(&lab.gpu(), choice)?)?;
            return Ok(json!({
                "flicker": figures.flicker,
                "ratio": figures.ratio,
                "lag_frames": figures.lag_frames,
                "truth_change": truth.summary.change,
            }));
        }
        let view = View::new(lab, scene, setup, *size_px)?;
        let run = view.run(&mut view.create(choice)?, 0, &TIMING)?;
        let metrics = match truth {
            SharedTruth::Still(truth) => Some(compare_visibility(&truth.visibility, &run.visibility, &truth.judged)?),
            _ => None,
        };
        Ok(json!({
            "triangles": view.triangle_count(),
            "metrics": metrics,
            "timings": run.timings,
            "memory_bytes": run.memory_bytes,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use crate::test_support::lab_or_skip;

    fn small() -> Plan {
        let wanted = |group: &Group| group.part == Part::Errors && group.scene == "overlap";
        let mut group = Plan::whole().groups.into_iter().find(wanted).unwrap();
        group.size_px = UVec2::new(48, 27);
        group.jobs.retain(|(job, _)| ["hard", "pcf"].contains(&job.as_str()));
        Plan { groups: vec![group], papers: Vec::new() }
    }

    #[test]
    fn a_slice_goes_on_where_the_last_one_stopped() {
        let Some(lab) = lab_or_skip() else { return };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.json");
        let minute = Duration::from_secs(60);
        let all = small();
        let mut first = all.clone();
        first.groups[0].jobs.truncate(1);
        assert_eq!(run_slice(lab, &first, &path, "abc", minute, &Silent).unwrap(), Done { jobs: 1, of: 1 });
        let hard = Results::read(&path).unwrap().row("errors/overlap/hard").unwrap().clone();
        assert!(
            hard["metrics"]["rmse"].as_f64().unwrap() > 0.05 && hard["timings"]["total_ms"].as_f64().unwrap() > 0.0
        );
        // A slice without time runs nothing, and loses nothing.
        assert_eq!(run_slice(lab, &all, &path, "abc", Duration::ZERO, &Silent).unwrap(), Done { jobs: 1, of: 2 });
        assert_eq!(run_slice(lab, &all, &path, "abc", minute, &Silent).unwrap(), Done { jobs: 2, of: 2 });
        let results = Results::read(&path).unwrap();
        assert_eq!(results.row("errors/overlap/hard"), Some(&hard), "it is not measured again");
        let other = run_slice(lab, &all, &path, "def", minute, &Silent).unwrap_err().to_string();
        assert!(other.contains("its commit is \"abc\", but this run has \"def\"; name another file"), "{other}");
        let tables = markdown(&results);
        assert!(tables.contains("| `hard` | 0.") && tables.contains("2 of "), "{tables}");
    }

    #[test]
    fn other_files_are_no_results() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.json");
        for text in ["", "{}", "[1]", r#"{"format":"antumbra-suite","version":99,"rows":{}}"#] {
            std::fs::write(&path, text).unwrap();
            let why = Results::read(&path).unwrap_err();
            assert!(
                why.is_bad_input && why.to_string().ends_with("give a file that `antumbra bench --suite` wrote"),
                "{why}"
            );
        }
    }

    /// The pages' figures are up to date with the result files.
    #[test]
    fn benchmarks_are_what_the_suite_says() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for (page, file) in [
            ("BENCHMARKS.md", "bench/results/nvidia-h200-2026-11-27.json"),
            ("bench/nvidia-h200-2026-11-26.md", "bench/results/nvidia-h200-2026-11-26.json"),
            ("bench/llvmpipe.md", "bench/results/llvmpipe-2026-11-29.json"),
            ("bench/llvmpipe-2026-11-25.md", "bench/results/llvmpipe-2026-11-25.json"),
        ] {
            let text = std::fs::read_to_string(root.join(page)).unwrap();
            let of_file = markdown(&Results::read(&root.join(file)).unwrap());
            assert!(
                text.trim_end() == of_file.trim_end(),
                "regenerate the page: antumbra bench --tables {file} > {page}"
            );
        }
    }
}
