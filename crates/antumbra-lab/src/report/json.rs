//! `metrics.json`: all measurements of a report, for other programs.
//!
//! The keys are stable: [`VERSION`] rises when one changes its meaning or is removed. Times are milliseconds, except limits and the
//! `seconds` of the reference and of rows. Values that were not measured are null. Each row has the adapter of its times and the
//! numbers of timed and warm-up frames.

use serde_json::{Map, Number, Value, json};

use super::model::{MotionInfo, Outcome, Report};
use super::paths::{
    JUDGED_PATH, REFERENCE_STEM, error_path, motion_path, shaded_path, visibility_exr_path, visibility_path,
};
use crate::motion::MotionFigures;

/// Version of the schema.
pub(super) const VERSION: u32 = 1;

/// Returns the file's content, indented.
pub(super) fn metrics_json(report: &Report) -> Vec<u8> {
    let reference = &report.reference;
    let size_px = reference.visibility.size_px;
    let rows = report.rows.iter().zip(report.stems()).map(|(row, stem)| row_json(report, row, &stem));
    let json = json!({
        "format": "antumbra-metrics",
        "version": VERSION,
        "scene": {
            "name": report.scene.name,
            "triangles": report.scene.triangles,
            "setup": report.scene.setup_toml,
        },
        "scene_facts": report.facts,
        "size": [size_px.x, size_px.y],
        "adapter": report.adapter,
        "antumbra": env!("CARGO_PKG_VERSION"),
        "commit": report.commit,
        "date": report.date,
        "command": report.command,
        "reference": {
            "samples": reference.info.samples,
            "rays": reference.info.rays,
            "seconds": reference.info.seconds,
            "rays_per_second": reference.info.rays_per_second(),
            "judged_pixels": reference.judged.iter().filter(|&&judged| judged).count(),
            "images": {
                "shaded": shaded_path(REFERENCE_STEM),
                "visibility": visibility_path(REFERENCE_STEM),
                "visibility_exr": visibility_exr_path(REFERENCE_STEM),
                "judged": JUDGED_PATH,
            },
        },
        "settings": report.settings,
        "missing": report.missing,
        "motion": report.motion.as_ref().map(motion_json),
        "rows": rows.collect::<Vec<_>>(),
        "baseline": report.baseline,
        "warnings": report.warnings,
    });
    let mut bytes = serde_json::to_vec_pretty(&json).expect("a JSON value has text");
    bytes.push(b'\n');
    bytes
}

fn motion_json(info: &MotionInfo) -> Value {
    let truths = info.truths.iter().map(|truth| {
        let about = json!({
            "caster": truth.caster,
            "truth_change": truth.change,
            "truth_noise": truth.noise,
            "image": motion_path(REFERENCE_STEM, truth.motion),
        });
        (truth.motion.name().to_owned(), about)
    });
    json!({
        "frames": info.frames,
        // Converted through text, so that 0.15 stays 0.15 and does not become its double-precision neighbour.
        "step_m": info.step_m.to_string().parse::<Number>().ok(),
        "samples": info.samples,
        "motions": truths.collect::<Map<_, _>>(),
    })
}

fn figures_json(figures: &MotionFigures, stem: &str) -> (String, Value) {
    let about = json!({
        "flicker": figures.flicker,
        "ratio": figures.ratio,
        "lag_frames": figures.lag_frames,
        "after_stop": figures.after_stop,
        "frames_lacking_room": figures.lacking_room,
        "image": motion_path(stem, figures.motion),
    });
    (figures.motion.name().to_owned(), about)
}

fn row_json(report: &Report, row: &super::Row, stem: &str) -> Value {
    let mut json = json!({
        "technique": row.technique,
        "title": row.title,
        "status": if row.is_missing { "missing" } else { "skipped" },
        "skipped": null,
        "cut_short_s": row.cut_short_s,
        "seconds": row.seconds,
        "parameters": row.parameters,
        "command": row.command,
        "metrics": null,
        "passes": [],
        "total_ms": null,
        "frames": null,
        "warm_up": null,
        "memory_bytes": null,
        "auto_map_sizes": [],
        "motion": null,
        "adapter": report.adapter.name,
        "images": null,
        "warnings": row.warnings,
        "notes": row.notes,
    });
    match &row.outcome {
        Outcome::Skipped(reason) => json["skipped"] = json!(reason),
        Outcome::Measured(measured) => {
            json["status"] = json!("measured");
            json["metrics"] = json!(measured.metrics);
            json["passes"] = json!(measured.passes);
            json["total_ms"] = json!(measured.total_ms);
            (json["frames"], json["warm_up"]) = (measured.count.frames.into(), measured.count.warm_up.into());
            json["memory_bytes"] = json!(measured.memory_bytes);
            json["auto_map_sizes"] = json!(measured.auto_map_sizes);
            if report.motion.is_some() {
                let motions = measured.motions.iter().map(|figures| figures_json(figures, stem));
                json["motion"] = Value::Object(motions.collect());
            }
            json["images"] = json!({
                "shaded": shaded_path(stem),
                "visibility": visibility_path(stem),
                "visibility_exr": visibility_exr_path(stem),
                "error": error_path(stem),
            });
        }
    }
    json
}
