//! Rows of a comparison: one technique against the reference.

use antumbra::AnyShadow;
use image::RgbImage;

use super::truth::{Judge, filtered_truths};
use super::{CompareRequest, Truth};
use crate::error::LabError;
use crate::limits::End;
use crate::metrics::{FlipMap, compare_visibility};
use crate::picture::Visibility;
use crate::report::{Measurement, Outcome, PassTime, Row};
use crate::technique_run::{Clock, TechniqueChoice, TechniqueRun, Timing, parameters_of};
use crate::truth::LightTruth;
use crate::view::View;

/// Returns the row of a technique that is not measured yet.
pub(super) fn planned(request: &CompareRequest<'_>, choice: &TechniqueChoice, made: Option<&AnyShadow>) -> Row {
    Row {
        technique: choice.name(),
        title: choice.kind.title().to_owned(),
        parameters: made.map(parameters_of).unwrap_or_default(),
        command: format!(
            "antumbra render {} --technique {}{} -o {}.png",
            request.scene_arguments,
            choice.name(),
            choice.settings.iter().map(|(key, value)| format!(" --set {key}={value}")).collect::<String>(),
            choice.name().replace(':', "-"),
        ),
        outcome: Outcome::Skipped("no time was left".into()),
        warnings: Vec::new(),
        notes: Vec::new(),
        is_missing: true,
        cut_short_s: None,
        seconds: 0.0,
    }
}

/// Measures a technique until `end` at most, and completes its row.
///
/// # Errors
/// If the device fails, or the run's deadline passes. A technique that cannot run is a row with the reason.
pub(super) fn measure_row(
    view: &View<'_>,
    request: &CompareRequest<'_>,
    judge: &Judge,
    (choice, made): (&TechniqueChoice, Result<AnyShadow, antumbra::Error>),
    mut row: Row,
    end: Option<End>,
) -> Result<Row, LabError> {
    let measured = made.map_err(LabError::from).and_then(|mut technique| {
        let own_truths = match request.truth {
            Truth::Traced => None,
            Truth::Filtered => {
                let why = || format!("{} has no kernel of constant width to compare with", choice.kind);
                let Some(exact) = choice.filtered_truth() else { return Ok(Err(why())) };
                Some(filtered_truths(view, &exact, &judge.truths)?)
            }
        };
        let runs = run_all_lights(view, request, &mut technique, end)?;
        row.cut_short_s = runs.judged.cut_short_s;
        note_clock(&mut row, &runs.judged);
        let light = request.light;
        let mut measured = match &own_truths {
            None => measure(view, light, runs, &judge.truths, &judge.picture)?,
            Some(own) => {
                let visibilities: Vec<&Visibility> = own.iter().map(|truth| &truth.visibility).collect();
                measure(view, light, runs, own, &view.shade(&visibilities)?.to_srgb8())?
            }
        };
        measured.own_truth = own_truths.map(|mut own| own.swap_remove(light).visibility);
        Ok(Ok(measured))
    });
    row.outcome = match measured {
        Ok(Ok(measured)) => Outcome::Measured(Box::new(measured)),
        Ok(Err(why)) => Outcome::Skipped(why),
        Err(error) if error.is_deadline() => return Err(error),
        Err(error) => {
            row.cut_short_s = error.limit_s();
            Outcome::Skipped(error.why_skipped().ok_or(error)?)
        }
    };
    row.is_missing = false;
    Ok(row)
}

/// Adds notes about the clock and about a time limit.
fn note_clock(row: &mut Row, run: &TechniqueRun) {
    let timings = &run.timings;
    if timings.clock == Clock::SubmitToDone {
        row.notes.push(format!(
            "The adapter has no timestamps. From submission to completion, a frame took {:.2} ms ({}).",
            timings.total_ms,
            timings.count()
        ));
    }
    if let Some(limit_s) = run.cut_short_s {
        row.notes.push(format!("Cut short by the limit of {limit_s} s per technique: fewer frames are timed."));
    }
}

/// Times the judged light, and draws the masks of the other lights once.
fn run_all_lights(
    view: &View<'_>,
    request: &CompareRequest<'_>,
    technique: &mut AnyShadow,
    end: Option<End>,
) -> Result<Runs, LabError> {
    let timing = Timing { end, ..request.timing };
    let mut others = Vec::new();
    let mut judged = None;
    for light in 0..request.setup.lights.len() {
        if light == request.light {
            judged = Some(view.run(technique, light, &timing)?);
        } else {
            others.push(view.draw_until(technique, light, 1, end)?.visibility);
        }
    }
    let judged = judged.expect("the measured light is in the setup");
    Ok(Runs { judged, others })
}

/// Results of a technique for all lights.
struct Runs {
    judged: TechniqueRun,
    /// Masks of the other lights, in the setup's order.
    others: Vec<Visibility>,
}

impl Runs {
    /// Returns every light's mask in the setup's order; `light` is the judged one.
    fn visibilities(&self, light: usize) -> Vec<&Visibility> {
        let (before, after) = self.others.split_at(light);
        before.iter().chain([&self.judged.visibility]).chain(after).collect()
    }
}

fn measure(
    view: &View<'_>,
    light: usize,
    runs: Runs,
    truths: &[LightTruth],
    true_picture: &RgbImage,
) -> Result<Measurement, LabError> {
    let shaded = view.shade(&runs.visibilities(light))?.to_srgb8();
    let run = runs.judged;
    let truth = &truths[light];
    let mut metrics = compare_visibility(&truth.visibility, &run.visibility, &truth.judged)?;
    metrics.add_flip(&FlipMap::new(true_picture, &shaded)?);
    let count = run.timings.count();
    let passes = run.timings.passes.into_iter().map(|pass| PassTime {
        name: pass.label,
        median_ms: pass.ms,
        p10_ms: Some(pass.p10_ms),
        p90_ms: Some(pass.p90_ms),
        bytes: None,
    });
    Ok(Measurement {
        visibility: run.visibility,
        shaded,
        metrics,
        own_truth: None,
        passes: passes.collect(),
        total_ms: (run.timings.clock != Clock::SubmitToDone).then_some(run.timings.total_ms),
        count,
        memory_bytes: Some(run.memory_bytes),
        auto_map_sizes: run.auto_map_sizes,
        motions: Vec::new(),
    })
}
