//! Plan of a sweep, as a file.

use std::fmt;
use std::path::Path;

use antumbra_scene::{Scene, Setup};
use glam::UVec2;
use serde::{Deserialize, Serialize};

use super::{PLAN_NAME, RESULTS_NAME};
use crate::output_files::{FileError, write_atomically};
use crate::store::fingerprint;
use crate::technique_run::TechniqueChoice;

const FORMAT: &str = "antumbra-sweep";
const VERSION: u32 = 1;

/// Jobs of a sweep and their inputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    format: String,
    version: u32,
    /// Commit of the program. Another commit does not run this plan.
    pub commit: String,
    /// The command line.
    pub command: String,
    /// Light samples of every ground truth.
    pub samples: u32,
    /// Timed frames of every job.
    pub frames: u32,
    /// Scenes of the jobs.
    pub scenes: Vec<PlannedScene>,
    /// Jobs in the order of scenes and sizes.
    pub jobs: Vec<Job>,
}

/// A scene with its camera and lights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedScene {
    /// Scene: `builtin:street`, or a path as seen by shards.
    pub scene: String,
    /// Time at which animations are sampled, seconds.
    pub time_s: f32,
    /// Whether a ground plane was added to the scene.
    pub ground: bool,
    /// Number of triangles, which detects another file of the same name.
    pub triangles: usize,
    /// Text of the setup file.
    pub setup: String,
    /// Name of the judged light.
    pub light: String,
}

/// A technique with a scene and an image size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Index in the plan, and name of the result.
    pub id: usize,
    /// Index into the plan's scenes.
    pub scene: usize,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Name of the technique with its quality: `pcss:fast`.
    pub technique: String,
    /// Parameters as keys and values, set after those of the quality.
    pub settings: Vec<(String, String)>,
}

/// Part of the jobs: the first of four is 1/4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, from 1.
    pub index: usize,
    /// Number of shards.
    pub of: usize,
}

impl Shard {
    /// All jobs.
    pub const WHOLE: Self = Self { index: 1, of: 1 };

    /// Returns the range of jobs, out of `jobs`, that belong to the shard.
    pub fn range(self, jobs: usize) -> std::ops::Range<usize> {
        (self.index - 1) * jobs / self.of..self.index * jobs / self.of
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl PlannedScene {
    /// Creates the plan's description of a loaded scene.
    pub fn new(spec: &str, time_s: f32, ground: bool, scene: &Scene, setup: &Setup, light: usize) -> Self {
        Self {
            scene: spec.to_owned(),
            time_s,
            ground,
            triangles: scene.triangle_count(),
            setup: setup.to_toml(),
            light: setup.lights[light].name.clone(),
        }
    }
}

impl Plan {
    /// Creates a plan of every scene at every size with every technique.
    pub fn new(
        scenes: Vec<PlannedScene>,
        sizes_px: &[UVec2],
        choices: &[TechniqueChoice],
        samples: u32,
        frames: u32,
        command: String,
        commit: &str,
    ) -> Self {
        let mut jobs = Vec::new();
        for scene in 0..scenes.len() {
            for size_px in sizes_px {
                for choice in choices {
                    jobs.push(Job {
                        id: jobs.len(),
                        scene,
                        size: size_px.to_array(),
                        technique: choice.name(),
                        settings: choice.settings.clone(),
                    });
                }
            }
        }
        Self {
            format: FORMAT.into(),
            version: VERSION,
            commit: commit.to_owned(),
            command,
            samples,
            frames,
            scenes,
            jobs,
        }
    }

    /// Writes the plan into a folder.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), FileError> {
        let text = serde_json::to_string_pretty(self).expect("a plan has text");
        write_atomically(&dir.join(PLAN_NAME), format!("{text}\n").as_bytes())
    }

    /// Reads a folder's plan, and the fingerprint of its text.
    ///
    /// # Errors
    /// If there is no plan, or a technique or scene in it does not exist.
    pub fn read(dir: &Path) -> Result<(Self, String), FileError> {
        const REMEDY: &str = "give a folder that `antumbra sweep plan` wrote";
        let path = dir.join(PLAN_NAME);
        let text = std::fs::read_to_string(&path).map_err(|error| FileError::from_read(&path, &error))?;
        let bad = |why: String| FileError::bad_content(&path, why, REMEDY);
        let plan: Self = serde_json::from_str(&text).map_err(|error| bad(error.to_string()))?;
        if plan.format != FORMAT || plan.version != VERSION {
            return Err(bad("it is not a plan of this version".into()));
        }
        for (i, job) in plan.jobs.iter().enumerate() {
            if job.id != i || job.scene >= plan.scenes.len() {
                return Err(bad(format!("job {i} has a wrong number, or no scene")));
            }
            job.choice().ok_or_else(|| bad(format!("job {i}: there is no technique `{}`", job.technique)))?;
        }
        Ok((plan, fingerprint(text.bytes())))
    }
}

impl Job {
    /// Returns the technique choice to run; `None` if there is no such technique.
    pub fn choice(&self) -> Option<TechniqueChoice> {
        let choice = TechniqueChoice::from_name(&self.technique)?;
        Some(TechniqueChoice { settings: self.settings.clone(), ..choice })
    }

    /// Returns the path of its result in a sweep's folder.
    pub(super) fn result_path(&self, dir: &Path) -> std::path::PathBuf {
        dir.join(RESULTS_NAME).join(format!("{:05}.json", self.id))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_all_jobs_once() {
        for jobs in [0, 1, 7, 64] {
            for of in [1, 2, 3, 10] {
                let all: Vec<usize> = (1..=of).flat_map(|index| Shard { index, of }.range(jobs)).collect();
                assert_eq!(all, (0..jobs).collect::<Vec<_>>());
            }
        }
    }
}
