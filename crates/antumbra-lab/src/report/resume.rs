//! Reading of a report to resume: its numbers and images.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use super::model::{Measurement, MotionInfo, Outcome, PassTime, Reference, ReferenceInfo, Report, Row, SceneInfo};
use super::paths::{JUDGED_PATH, METRICS_PATH, REFERENCE_STEM, motion_path, shaded_path, visibility_exr_path};
use crate::adapter_info::AdapterInfo;
use crate::error::LabError;
use crate::identity::{Identity, read_to_resume};
use crate::image_io::{read_png, read_visibility_exr};
use crate::metrics::Metrics;
use crate::motion::{Motion, MotionFigures, TrueMotion};
use crate::output_files::FileError;
use crate::picture::Visibility;
use crate::scene_facts::SceneFacts;
use crate::stopwatch::FrameCount;

const REMEDY: &str = "omit --resume to measure again, or name another folder";

#[derive(Deserialize)]
struct MetricsFile {
    scene: SceneFile,
    scene_facts: Option<SceneFacts>,
    adapter: AdapterInfo,
    commit: String,
    date: String,
    command: String,
    reference: ReferenceInfo,
    motion: Option<MotionFile>,
    rows: Vec<RowFile>,
    settings: Value,
    warnings: Vec<String>,
}

#[derive(Deserialize)]
struct SceneFile {
    name: String,
    triangles: u64,
    setup: String,
}

#[derive(Deserialize)]
struct MotionFile {
    frames: u32,
    step_m: f32,
    samples: u32,
    motions: Map<String, Value>,
}

#[derive(Deserialize)]
struct RowFile {
    technique: String,
    title: String,
    status: String,
    skipped: Option<String>,
    cut_short_s: Option<f64>,
    seconds: f64,
    parameters: Map<String, Value>,
    command: String,
    metrics: Option<Metrics>,
    passes: Vec<PassTime>,
    total_ms: Option<f64>,
    frames: Option<u32>,
    warm_up: Option<u32>,
    memory_bytes: Option<u64>,
    auto_map_sizes: Vec<u32>,
    motion: Option<Map<String, Value>>,
    warnings: Vec<String>,
    notes: Vec<String>,
}

/// Truth of a motion; its keys are `truth_change`, `truth_noise`.
#[derive(Deserialize)]
struct TrueMotionFile {
    caster: Option<String>,
    truth_change: Option<f64>,
    truth_noise: Option<f64>,
}

#[derive(Deserialize)]
struct FiguresFile {
    flicker: Option<f64>,
    ratio: Option<f64>,
    lag_frames: Option<u32>,
    after_stop: Vec<f64>,
    frames_lacking_room: u32,
}

/// Reads the report in the folder `dir`, with its images, if it is of the same run; `None` if there is none yet.
///
/// # Errors
/// If it is of another run, or a file cannot be read.
pub fn report_to_resume(dir: &Path, identity: &Identity) -> Result<Option<Report>, LabError> {
    let path = dir.join(METRICS_PATH);
    let Some(json) = read_to_resume(&path, "antumbra-metrics")? else { return Ok(None) };
    let of_adapter = |key: &str| json["adapter"][key].clone();
    let there = json!({
        "antumbra": json["antumbra"], "commit": json["commit"], "settings": json["settings"],
        "adapter": of_adapter("name"), "driver": of_adapter("driver"), "backend": of_adapter("backend"),
    });
    identity.check(&path, &there)?;
    let file: MetricsFile = parse(&path, json)?;
    Ok(Some(Folder { dir, path: &path }.report(file)?))
}

fn parse<T: DeserializeOwned>(path: &Path, json: Value) -> Result<T, FileError> {
    serde_json::from_value(json).map_err(|error| FileError::bad_content(path, error.to_string(), REMEDY))
}

/// Folder of a report.
struct Folder<'a> {
    dir: &'a Path,
    path: &'a Path,
}

impl Folder<'_> {
    fn report(&self, file: MetricsFile) -> Result<Report, FileError> {
        let reference = self.reference(file.reference)?;
        let mut report = Report {
            scene: SceneInfo {
                name: file.scene.name,
                summary: String::new(),
                triangles: file.scene.triangles,
                setup_toml: file.scene.setup,
            },
            facts: file.scene_facts,
            adapter: file.adapter,
            commit: file.commit,
            date: file.date,
            command: file.command,
            reference,
            rows: Vec::new(),
            motion: file.motion.map(|motion| self.motion(motion)).transpose()?,
            settings: file.settings,
            missing: Vec::new(),
            baseline: None,
            warnings: file.warnings,
        };
        let (rows, figures): (Vec<Row>, Vec<_>) = file.rows.into_iter().map(row).unzip();
        report.rows = rows;
        let stems = report.stems();
        for ((row, (measured, motions)), stem) in report.rows.iter_mut().zip(figures).zip(stems) {
            if let Some(measured) = measured {
                row.outcome = Outcome::Measured(Box::new(self.measurement(*measured, motions, &stem)?));
            }
        }
        Ok(report)
    }

    fn reference(&self, info: ReferenceInfo) -> Result<Reference, FileError> {
        let judged = read_png(&self.dir.join(JUDGED_PATH))?;
        Ok(Reference {
            visibility: read_visibility_exr(&self.dir.join(visibility_exr_path(REFERENCE_STEM)))?,
            shaded: read_png(&self.dir.join(shaded_path(REFERENCE_STEM)))?,
            judged: judged.pixels().map(|pixel| pixel.0[0] > 127).collect(),
            info,
        })
    }

    fn motion(&self, file: MotionFile) -> Result<MotionInfo, FileError> {
        let MotionFile { frames, step_m, samples, motions } = file;
        let mut truths = Vec::new();
        for (name, json) in motions {
            let motion = self.motion_named(&name)?;
            let TrueMotionFile { caster, truth_change: change, truth_noise: noise } = parse(self.path, json)?;
            let strip = read_png(&self.dir.join(motion_path(REFERENCE_STEM, motion)))?;
            truths.push(TrueMotion { motion, caster, change, noise, strip });
        }
        Ok(MotionInfo { frames, step_m, samples, truths })
    }

    /// Completes the numbers of a measurement by its images and motions.
    fn measurement(
        &self,
        numbers: Measurement,
        motions: Map<String, Value>,
        stem: &str,
    ) -> Result<Measurement, FileError> {
        let mut figures = Vec::new();
        for (name, json) in motions {
            let motion = self.motion_named(&name)?;
            let FiguresFile { flicker, ratio, lag_frames, after_stop, frames_lacking_room } = parse(self.path, json)?;
            let strip = read_png(&self.dir.join(motion_path(stem, motion)))?;
            let lacking_room = frames_lacking_room;
            figures.push(MotionFigures { motion, flicker, ratio, lag_frames, after_stop, lacking_room, strip });
        }
        Ok(Measurement {
            visibility: read_visibility_exr(&self.dir.join(visibility_exr_path(stem)))?,
            shaded: read_png(&self.dir.join(shaded_path(stem)))?,
            motions: figures,
            ..numbers
        })
    }

    fn motion_named(&self, name: &str) -> Result<Motion, FileError> {
        let motion = Motion::ALL.into_iter().find(|motion| motion.name() == name);
        motion.ok_or_else(|| FileError::bad_content(self.path, format!("there is no motion `{name}`"), REMEDY))
    }
}

/// Numbers of a measured row without images, and its motions.
type Figures = (Option<Box<Measurement>>, Map<String, Value>);

/// Splits a row of the file into a row without results, and the results.
fn row(file: RowFile) -> (Row, Figures) {
    let measured = file.metrics.filter(|_| file.status == "measured").map(|metrics| {
        Box::new(Measurement {
            visibility: Visibility::one(glam::UVec2::ZERO, Vec::new()),
            shaded: image::RgbImage::default(),
            metrics,
            own_truth: None,
            passes: file.passes,
            total_ms: file.total_ms,
            count: FrameCount { frames: file.frames.unwrap_or(0), warm_up: file.warm_up.unwrap_or(0) },
            memory_bytes: file.memory_bytes,
            auto_map_sizes: file.auto_map_sizes,
            motions: Vec::new(),
        })
    });
    let row = Row {
        technique: file.technique,
        title: file.title,
        parameters: file.parameters,
        command: file.command,
        outcome: Outcome::Skipped(file.skipped.unwrap_or_default()),
        warnings: file.warnings,
        notes: file.notes,
        is_missing: file.status == "missing",
        cut_short_s: file.cut_short_s,
        seconds: file.seconds,
    };
    (row, (measured, file.motion.unwrap_or_default()))
}
