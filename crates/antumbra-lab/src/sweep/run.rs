//! Running of a shard.

use std::path::Path;
use std::time::Duration;

use antumbra_reference::VisibilityOptions;
use antumbra_scene::{LoadOptions, Setup, load};
use glam::UVec2;
use serde_json::{Map, Value, json};

use super::plan::{Job, Plan, Shard};
use super::{JobResult, Origin, PLAN_NAME, RESULT_FORMAT, RESULTS_NAME, VERSION, results_in};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::metrics::compare_visibility;
use crate::output_files::{FileError, write_atomically};
use crate::progress::Progress;
use crate::technique_run::{Timing, create, parameters_of};
use crate::truth::{LightTruth, trace};
use crate::view::View;

/// Maximum total time of a job's timed frames, whatever their number.
const AT_MOST: Duration = Duration::from_secs(3);
/// Minimum total time of a job's timed frames, whatever their number.
const AT_LEAST: Duration = Duration::from_millis(250);

/// Progress of a shard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// Number of jobs that this call ran.
    pub ran: usize,
    /// Number of the shard's jobs that had results already.
    pub had: usize,
}

/// Runs those of a shard's jobs that have no result, and writes each result when it is available.
///
/// # Errors
/// If the folder has no plan, the plan or earlier results have another commit or adapter, a scene has changed, or the device fails. A
/// technique that the device cannot run is a result with the reason.
pub fn run_shard(
    lab: &LabDevice,
    dir: &Path,
    shard: Shard,
    commit: &str,
    progress: &dyn Progress,
) -> Result<Done, LabError> {
    let (plan, fingerprint) = Plan::read(dir)?;
    let here = Origin::here(lab, commit);
    let refuse = |what: &str, there: &str, here: &str| {
        let name = dir.join(PLAN_NAME);
        LabError::Request(format!(
            "{}: its {what} is {there}, but this run has {here}; create a new plan",
            name.display()
        ))
    };
    if plan.commit != commit {
        return Err(refuse("commit", &plan.commit, commit));
    }
    // Checked before hours of work that could not be merged.
    for result in results_in(dir)? {
        if let Some((what, there, here)) = here.difference(&result.origin) {
            return Err(refuse(&format!("results' {what}"), &there, &here));
        }
        if result.plan != fingerprint {
            return Err(refuse("results' plan", &result.plan, &fingerprint));
        }
    }
    let folder = dir.join(RESULTS_NAME);
    std::fs::create_dir_all(&folder).map_err(|error| FileError::from_write(&folder, &error))?;

    let jobs = &plan.jobs[shard.range(plan.jobs.len())];
    let lacking: Vec<&Job> = jobs.iter().filter(|job| !job.result_path(dir).exists()).collect();
    let had = jobs.len() - lacking.len();
    let mut ran = 0;
    for group in lacking.chunk_by(|a, b| (a.scene, a.size) == (b.scene, b.size)) {
        let bench = Bench::new(lab, &plan, group[0], progress)?;
        progress.begin(&format!("shard {shard}, {}", plan.scenes[group[0].scene].scene), jobs.len() as u64);
        for job in group {
            progress.reach((had + ran) as u64);
            let mut result = bench.run(job)?;
            (result.plan, result.origin) = (fingerprint.clone(), here.clone());
            let text = serde_json::to_string_pretty(&result).expect("a result has text");
            write_atomically(&job.result_path(dir), format!("{text}\n").as_bytes())?;
            ran += 1;
        }
        progress.end();
    }
    Ok(Done { ran, had })
}

/// A scene at one size, with its ground truth.
struct Bench<'a> {
    lab: &'a LabDevice,
    scene: antumbra_scene::Scene,
    setup: Setup,
    /// Index of the judged light in the setup.
    light: usize,
    size_px: UVec2,
    truth: LightTruth,
    timing: Timing,
}

impl<'a> Bench<'a> {
    fn new(lab: &'a LabDevice, plan: &Plan, job: &Job, progress: &dyn Progress) -> Result<Self, LabError> {
        let planned = &plan.scenes[job.scene];
        let mut scene = load(&planned.scene, &LoadOptions { time_s: planned.time_s })?;
        if planned.ground {
            scene.add_ground();
        }
        if scene.triangle_count() != planned.triangles {
            return Err(LabError::Request(format!(
                "{}: it has {} triangles, but had {} when it was planned; create a new plan",
                planned.scene,
                scene.triangle_count(),
                planned.triangles
            )));
        }
        let setup = Setup::from_toml(&planned.setup, Path::new(PLAN_NAME))?;
        let anchor = setup.camera.anchor();
        scene.count_from(anchor);
        let setup = setup.relative_to(anchor);
        let Some(light) = setup.lights.iter().position(|light| light.name == planned.light) else {
            return Err(LabError::Request(format!(
                "{PLAN_NAME}: there is no light `{}`; create a new plan",
                planned.light
            )));
        };
        let size_px = UVec2::from_array(job.size);
        let options = VisibilityOptions { samples: plan.samples, ..VisibilityOptions::default() };
        // All lights are traced, so that pixels have the same light samples as in `compare`.
        let mut truth = trace(&scene, &setup, size_px, &options, progress)?.swap_remove(light);
        let seen = View::new(lab, &scene, &setup, size_px)?.surface_points()?;
        truth.unjudge_mismatched_surfaces(&seen, setup.camera.eye);
        let timing = Timing { warm_up: 1, frames: plan.frames, at_least: AT_LEAST, at_most: AT_MOST, end: None };
        Ok(Self { lab, scene, setup, light, size_px, truth, timing })
    }

    /// Returns a job's result, without plan and origin.
    fn run(&self, job: &Job) -> Result<JobResult, LabError> {
        let choice = job.choice().expect("a plan that was read has techniques");
        let mut result = JobResult {
            format: RESULT_FORMAT.into(),
            version: VERSION,
            plan: String::new(),
            origin: Origin::here(self.lab, ""),
            job: job.clone(),
            skipped: None,
            parameters: Map::new(),
            metrics: Value::Null,
            timings: Value::Null,
            memory_bytes: None,
            auto_map_sizes: Vec::new(),
        };
        let view = View::new(self.lab, &self.scene, &self.setup, self.size_px)?;
        let run = create(&self.lab.gpu(), &choice).map_err(LabError::from).and_then(|mut technique| {
            result.parameters = parameters_of(&technique);
            view.run(&mut technique, self.light, &self.timing)
        });
        match run {
            Ok(run) => {
                let metrics = compare_visibility(&self.truth.visibility, &run.visibility, &self.truth.judged)?;
                (result.metrics, result.timings) = (json!(metrics), json!(run.timings));
                result.memory_bytes = Some(run.memory_bytes);
                result.auto_map_sizes = run.auto_map_sizes;
            }
            Err(LabError::Technique(error @ antumbra::Error::Unsupported { .. })) => {
                result.skipped = Some(error.to_string());
            }
            Err(error @ LabError::NoRoom { .. }) => result.skipped = Some(error.to_string()),
            Err(error) => return Err(error),
        }
        Ok(result)
    }
}
