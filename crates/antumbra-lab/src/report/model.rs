//! Content of a report as plain data, filled in by a comparison.

use image::RgbImage;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::paths::stems_of;
use crate::adapter_info::AdapterInfo;
use crate::baseline::{BaselineComparison, Figures, numbers};
use crate::metrics::Metrics;
use crate::motion::{MotionFigures, TrueMotion};
use crate::names::numbered;
use crate::picture::Visibility;
use crate::scene_facts::SceneFacts;
use crate::stopwatch::FrameCount;

/// Comparison of several techniques with the traced ground truth, for one scene, camera and light.
#[derive(Clone, Debug)]
pub struct Report {
    /// Rendered scene.
    pub scene: SceneInfo,
    /// Scene facts; `None` without traced truth.
    pub facts: Option<SceneFacts>,
    /// Adapter that rendered it.
    pub adapter: AdapterInfo,
    /// Commit of Antumbra, or its version if the commit is unknown.
    pub commit: String,
    /// Date and time, as [`utc_now`](super::utc_now) writes it.
    pub date: String,
    /// Command line that reproduces this report.
    pub command: String,
    /// Ground truth.
    pub reference: Reference,
    /// Techniques in the order of display.
    pub rows: Vec<Row>,
    /// Motions, if measured.
    pub motion: Option<MotionInfo>,
    /// Settings that the report depends on besides program and adapter. Only a report with equal settings is resumed.
    pub settings: Value,
    /// Names of missing measurements, as `pcss` or `pcss, camera in motion`.
    pub missing: Vec<String>,
    /// Comparison with another run, if one was given.
    pub baseline: Option<BaselineComparison>,
    /// Warnings about the whole comparison, one line each: repairs by the loader, limits of this run.
    pub warnings: Vec<String>,
}

impl Report {
    /// Returns each row's name in files and anchors: that of the technique, with repeated ones numbered.
    pub(super) fn stems(&self) -> Vec<String> {
        stems_of(self.rows.iter().map(|row| row.technique.as_str()))
    }

    /// Returns the figures of the measured rows, for comparison with another run.
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

    /// Returns each row's name: that of the technique, with repeated ones numbered: `pcss`, `pcss-2`.
    pub fn names(&self) -> Vec<String> {
        numbered(self.rows.iter().map(|row| row.technique.clone()), "-")
    }
}

/// Description of a scene in a report.
#[derive(Clone, Debug, Default)]
pub struct SceneInfo {
    /// Name, e.g. `builtin:overlap` or a file's stem.
    pub name: String,
    /// Summary in one sentence; may be empty.
    pub summary: String,
    /// Number of triangles of all instances.
    pub triangles: u64,
    /// Setup file (TOML) that reproduces camera and lights.
    pub setup_toml: String,
}

/// Traced ground truth, its image, and the judged pixels.
#[derive(Clone, Debug)]
pub struct Reference {
    /// True visibility; all images of the report have its size.
    pub visibility: Visibility,
    /// The scene shaded with true visibility, 8-bit sRGB.
    pub shaded: RgbImage,
    /// Whether each pixel has geometry that faces the light's centre, `width · height`.
    pub judged: Vec<bool>,
    /// Cost of tracing.
    pub info: ReferenceInfo,
}

/// Cost of tracing the ground truth.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct ReferenceInfo {
    /// Light samples per pixel.
    pub samples: u32,
    /// Number of occlusion rays.
    pub rays: u64,
    /// Duration of tracing, seconds.
    pub seconds: f64,
}

impl ReferenceInfo {
    /// Returns the occlusion rays per second, if the time was measured.
    pub fn rays_per_second(&self) -> Option<f64> {
        (self.seconds > 0.0).then(|| self.rays as f64 / self.seconds)
    }
}

/// Motions in which techniques were measured.
#[derive(Clone, Debug)]
pub struct MotionInfo {
    /// Number of moving frames.
    pub frames: u32,
    /// Metres per frame.
    pub step_m: f32,
    /// Light samples per pixel of each frame's truth.
    pub samples: u32,
    /// Truth of each motion, in the order of display.
    pub truths: Vec<TrueMotion>,
}

/// A technique with its parameters and outcome.
#[derive(Clone, Debug)]
pub struct Row {
    /// Name on the command line.
    pub technique: String,
    /// Title, e.g. `Percentage-closer soft shadows`.
    pub title: String,
    /// All parameters by name, including defaults.
    pub parameters: Map<String, Value>,
    /// Command line that renders this row.
    pub command: String,
    /// Measurement, or the reason for its absence.
    pub outcome: Outcome,
    /// Warnings, one line each: overflow, a fallback.
    pub warnings: Vec<String>,
    /// Remarks, one line each.
    pub notes: Vec<String>,
    /// Whether it is not measured yet.
    pub is_missing: bool,
    /// Time limit that cut the measurement short, seconds.
    pub cut_short_s: Option<f64>,
    /// Total duration of the measurement, seconds.
    pub seconds: f64,
}

/// Outcome of a row.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// The technique ran.
    Measured(Box<Measurement>),
    /// The technique did not run, for the given reason.
    Skipped(String),
}

/// Results of a technique.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Visibility mask.
    pub visibility: Visibility,
    /// Scene shaded with the mask, 8-bit sRGB.
    pub shaded: RgbImage,
    /// Errors, `flip` included.
    pub metrics: Metrics,
    /// Reference of this technique if it differs from the report's.
    pub own_truth: Option<Visibility>,
    /// GPU times of the passes, in the order of execution.
    pub passes: Vec<PassTime>,
    /// Time of the whole frame's shadows, milliseconds; `None` if the adapter has no timestamps.
    pub total_ms: Option<f64>,
    /// Number of timed and warm-up frames of all these times.
    pub count: FrameCount,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: Option<u64>,
    /// Side of each map whose size is `auto`, texels; empty if sizes are given.
    pub auto_map_sizes: Vec<u32>,
    /// Results in motion.
    pub motions: Vec<MotionFigures>,
}

/// GPU time of one pass over several frames.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PassTime {
    /// Label of the pass.
    pub name: String,
    /// Median time, milliseconds.
    pub median_ms: f64,
    /// 10th percentile of the time, milliseconds.
    pub p10_ms: Option<f64>,
    /// 90th percentile of the time, milliseconds.
    pub p90_ms: Option<f64>,
    /// Bytes that the pass writes or holds, if known.
    pub bytes: Option<u64>,
}

/// Entry of a report in [`write_index`](super::write_index).
#[derive(Clone, Debug, Default)]
pub struct IndexEntry {
    /// Folder of the report, relative to the index, e.g. `overlap`.
    pub folder: String,
    /// Name of the scene.
    pub scene: String,
    /// Summary of the scene in one sentence; may be empty.
    pub summary: String,
    /// Number of triangles of all instances.
    pub triangles: u64,
    /// Adapter on which times were measured.
    pub adapter: AdapterInfo,
    /// Commit of Antumbra that rendered it.
    pub commit: String,
    /// Date and time.
    pub date: String,
    /// Measured techniques with their metrics and times, in the report's order.
    pub techniques: Vec<IndexTechnique>,
}

/// A technique in an [`IndexEntry`].
#[derive(Clone, Debug, Default)]
pub struct IndexTechnique {
    /// Name on the command line.
    pub technique: String,
    /// Prefix of its images' names.
    pub stem: String,
    /// Errors.
    pub metrics: Metrics,
    /// Time of the whole frame's shadows, milliseconds.
    pub total_ms: Option<f64>,
    /// Number of timed and warm-up frames of the median.
    pub count: FrameCount,
}

impl IndexEntry {
    /// Creates the entry of a report in `folder`, relative to the index.
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
