//! Content of a report as plain data, which a comparison fills in.

use image::RgbImage;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::paths::stems_of;
use crate::adapter_info::AdapterInfo;
use crate::baseline::{Against, Figures, numbers};
use crate::metrics::Metrics;
use crate::motion::{MotionFigures, TrueMotion};
use crate::names::numbered;
use crate::picture::Visibility;
use crate::scene_facts::SceneFacts;
use crate::stopwatch::FrameCount;

/// One scene, one camera, one light, held by several techniques against the traced truth.
#[derive(Clone, Debug)]
pub struct Report {
    /// What was rendered.
    pub scene: SceneInfo,
    /// What the scene is like for shadows; `None` where no truth was traced.
    pub facts: Option<SceneFacts>,
    /// What it was rendered on.
    pub adapter: AdapterInfo,
    /// The commit of Antumbra that rendered it, or its version where the commit is unknown.
    pub commit: String,
    /// When, as [`utc_now`](super::utc_now) writes it.
    pub date: String,
    /// The command line that makes this report again.
    pub command: String,
    /// The truth.
    pub reference: Reference,
    /// The techniques, in the order to show them.
    pub rows: Vec<Row>,
    /// How things moved, where they did.
    pub motion: Option<MotionInfo>,
    /// What it depends on beside program and adapter: a report is resumed only with the same.
    pub settings: Value,
    /// Names of what there was no time for, as `pcss` or `pcss, camera in motion`.
    pub missing: Vec<String>,
    /// The same rows of another run, where one was given.
    pub baseline: Option<Against>,
    /// What the reader should know of the whole comparison, one line each: repairs of the loader, limits of this run.
    pub warnings: Vec<String>,
}

impl Report {
    /// A name for each row's files and anchor: the technique's, numbered where it comes more than once.
    pub(super) fn stems(&self) -> Vec<String> {
        stems_of(self.rows.iter().map(|row| row.technique.as_str()))
    }

    /// Figures of its measured rows, to hold beside another run's.
    pub fn figures(&self) -> Vec<Figures> {
        let rows = self.rows.iter().zip(self.names());
        let figures = rows.filter_map(|(row, name)| match &row.outcome {
            Outcome::Measured(measured) => {
                let errors = serde_json::to_value(&measured.metrics).ok();
                let errors = errors.and_then(|errors| errors.as_object().cloned()).unwrap_or_default();
                Some(Figures { name, ms: measured.total_ms, errors: numbers(errors) })
            }
            Outcome::Skipped(_) => None,
        });
        figures.collect()
    }

    /// A name for each row: the technique's, numbered where it comes more than once: `pcss`, `pcss-2`.
    pub fn names(&self) -> Vec<String> {
        numbered(self.rows.iter().map(|row| row.technique.clone()), "-")
    }
}

/// A scene, as far as a report names it.
#[derive(Clone, Debug, Default)]
pub struct SceneInfo {
    /// Its name, e.g. `builtin:overlap` or a file's stem.
    pub name: String,
    /// One sentence on what it is or shows; may be empty.
    pub summary: String,
    /// Triangles of all instances.
    pub triangles: u64,
    /// The setup file (TOML) that reproduces camera and lights.
    pub setup_toml: String,
}

/// The traced truth, its picture, and the pixels over which techniques are judged.
#[derive(Clone, Debug)]
pub struct Reference {
    /// True visibility; its size is that of all images of the report.
    pub visibility: Visibility,
    /// The scene shaded with true visibility, 8-bit sRGB.
    pub shaded: RgbImage,
    /// Pixels with geometry that faces the light's centre, `width · height`.
    pub judged: Vec<bool>,
    /// How it was traced.
    pub info: ReferenceInfo,
}

/// How the truth was traced.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct ReferenceInfo {
    /// Light points for each pixel.
    pub samples: u32,
    /// Occlusion rays traced.
    pub rays: u64,
    /// Time that tracing took, seconds.
    pub seconds: f64,
}

impl ReferenceInfo {
    /// Occlusion rays a second, where the time was measured.
    pub fn rays_per_second(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.rays as f64 / self.seconds)
    }
}

/// Motions in which techniques were looked at.
#[derive(Clone, Debug)]
pub struct MotionInfo {
    /// Frames that moved.
    pub frames: u32,
    /// Metres a frame.
    pub step_m: f32,
    /// Light points for each pixel of each frame's truth.
    pub samples: u32,
    /// The truth of each motion, in the order to show them.
    pub truths: Vec<TrueMotion>,
}

/// A technique with its parameters, and what became of it.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name on the command line.
    pub technique: String,
    /// Its name for readers, e.g. `Percentage-closer soft shadows`.
    pub title: String,
    /// Every parameter by name, defaults included.
    pub parameters: Map<String, Value>,
    /// The command line that renders this row again.
    pub command: String,
    /// What was measured, or why nothing was.
    pub outcome: Outcome,
    /// What a reader should know, one line each: overflow, a fallback that was taken.
    pub warnings: Vec<String>,
    /// Remarks, one line each.
    pub notes: Vec<String>,
    /// It was not measured yet.
    pub is_missing: bool,
    /// The limit of a technique, seconds, where it cut this short.
    pub cut_short_s: Option<f64>,
    /// Time that it took in all, seconds.
    pub seconds: f64,
}

/// What became of a row.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It ran.
    Measured(Box<Measurement>),
    /// It did not, for the reason given.
    Skipped(String),
}

/// What a technique made, and what that took.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Its visibility.
    pub visibility: Visibility,
    /// The scene shaded with it, 8-bit sRGB.
    pub shaded: RgbImage,
    /// How far from the truth, `flip` included.
    pub metrics: Metrics,
    /// The truth that it was held against, where that is not the report's.
    pub own_truth: Option<Visibility>,
    /// GPU times, in the order of execution.
    pub passes: Vec<PassTime>,
    /// Time of the whole frame's shadows, milliseconds; `None` where the adapter has no timestamps.
    pub total_ms: Option<f64>,
    /// How many frames all of these times are the median of, and after how many.
    pub count: FrameCount,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: Option<u64>,
    /// Texels along a side of each map whose size is `auto`; none where sizes are given.
    pub auto_map_sizes: Vec<u32>,
    /// What it did in motion.
    pub motions: Vec<MotionFigures>,
}

/// GPU time of one pass over several frames.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PassTime {
    /// The pass's label.
    pub name: String,
    /// Median, milliseconds.
    pub median_ms: f64,
    /// 10th percentile, milliseconds.
    pub p10_ms: Option<f64>,
    /// 90th percentile, milliseconds.
    pub p90_ms: Option<f64>,
    /// Bytes that the pass writes or holds, where it says so.
    pub bytes: Option<u64>,
}

/// A report among several, for [`write_index`](super::write_index).
#[derive(Clone, Debug, Default)]
pub struct IndexEntry {
    /// The folder of the report, relative to the index, e.g. `overlap`.
    pub folder: String,
    /// The scene's name.
    pub scene: String,
    /// One sentence on the scene; may be empty.
    pub summary: String,
    /// Triangles of all instances.
    pub triangles: u64,
    /// The adapter whose times these are.
    pub adapter: AdapterInfo,
    /// The commit of Antumbra that rendered it.
    pub commit: String,
    /// When.
    pub date: String,
    /// Techniques that were measured, with their metrics and times, in the report's order.
    pub techniques: Vec<IndexTechnique>,
}

/// A technique in an [`IndexEntry`].
#[derive(Clone, Debug, Default)]
pub struct IndexTechnique {
    /// Its name on the command line.
    pub technique: String,
    /// Begin of its images' names.
    pub stem: String,
    /// How far from the truth.
    pub metrics: Metrics,
    /// Time of the whole frame's shadows, milliseconds.
    pub total_ms: Option<f64>,
    /// Of how many frames it is the median, and after how many.
    pub count: FrameCount,
}

impl IndexEntry {
    /// The entry of a report that was written into `folder`, relative to the index.
    pub fn of(folder: &str, report: &Report) -> Self {
        let rows = report.rows.iter().zip(report.stems());
        let techniques = rows.filter_map(|(row, stem)| match &row.outcome {
            Outcome::Skipped(_) => None,
            Outcome::Measured(measured) => Some(IndexTechnique {
                technique: row.technique.clone(),
                stem,
                metrics: measured.metrics.clone(),
                total_ms: measured.total_ms,
                count: measured.count,
            }),
        });
        Self {
            folder: folder.into(),
            scene: report.scene.name.clone(),
            summary: report.scene.summary.clone(),
            triangles: report.scene.triangles,
            adapter: report.adapter.clone(),
            commit: report.commit.clone(),
            date: report.date.clone(),
            techniques: techniques.collect(),
        }
    }
}
