//! Motion measurements of a comparison's techniques.

use std::time::Instant;

use super::{CompareRequest, ReportCallback, name_missing};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::limits::{Pace, Planned};
use crate::motion::{Motion, MotionTruth, MovingScene};
use crate::progress::Progress;
use crate::report::{MotionInfo, Outcome, Report, Row};
use crate::technique_run::{TechniqueChoice, create};

/// Runs the measured techniques through every motion, each with new state, and adds the results to their rows.
///
/// # Errors
/// If the scene cannot be traced, the device fails, or `each` fails.
pub(super) fn measure(
    lab: &LabDevice,
    moving: &mut MovingScene<'_>,
    request: &CompareRequest<'_>,
    report: &mut Report,
    pace: &mut Pace,
    each: ReportCallback<'_>,
    progress: &dyn Progress,
) -> Result<(), LabError> {
    let (motions, left_out) = moving.motions();
    if let Some(warning) = left_out.filter(|warning| !report.warnings.contains(warning)) {
        report.warnings.push(warning);
    }
    let (frames, step_m) = moving.frames_and_step_m();
    let info = MotionInfo { frames, step_m, samples: request.samples, truths: Vec::new() };
    report.motion.get_or_insert(info);
    for &motion in &motions {
        if has_truth(report, motion) && !report.rows.iter().any(|row| is_open(row, motion)) {
            continue;
        }
        let truth = match moving.trace_until(motion, request.samples, pace.deadline(), progress) {
            Err(error) if error.is_deadline() => break,
            traced => traced?,
        };
        add_truth(report, &truth);
        progress.begin(&format!("techniques, {} in motion", motion.name()), report.rows.len() as u64);
        for (i, choice) in request.choices.iter().enumerate() {
            if is_open(&report.rows[i], motion) {
                let name = format!("{}, {}", choice.name(), motion.name());
                let row = &mut report.rows[i];
                let ran = pace.measure(Planned::new(&name, request.size_px), |end| {
                    let began = Instant::now();
                    run(lab, moving, &truth, choice, row, end)?;
                    row.seconds += began.elapsed().as_secs_f64();
                    Ok(())
                })?;
                if ran.is_some() {
                    name_missing(report, &motions);
                    each(report)?;
                }
            }
            progress.reach(i as u64 + 1);
        }
        progress.end();
    }
    Ok(())
}

/// Runs one technique through one motion.
fn run(
    lab: &LabDevice,
    moving: &mut MovingScene<'_>,
    truth: &MotionTruth,
    choice: &TechniqueChoice,
    row: &mut Row,
    end: Option<crate::limits::End>,
) -> Result<(), LabError> {
    let Outcome::Measured(measured) = &mut row.outcome else { return Ok(()) };
    let (frames, _) = moving.frames_and_step_m();
    let name = truth.summary.motion.name();
    match moving.run_until(truth, &mut create(&lab.gpu(), choice)?, end) {
        Ok(figures) => {
            if figures.lacking_room > 0 {
                row.warnings.push(format!(
                    "While the {name} moved, lists exceeded their capacity in {} of {frames} frames, which counts as flicker.",
                    figures.lacking_room
                ));
            }
            measured.motions.push(figures);
            Ok(())
        }
        Err(error) if error.is_deadline() => Err(error),
        Err(error) => {
            row.cut_short_s = row.cut_short_s.or(error.limit_s());
            row.notes.push(format!("{}{}", note_of(truth.summary.motion), error.why_skipped().ok_or(error)?));
            Ok(())
        }
    }
}

/// Returns whether a row has neither results of a motion nor a reason for their absence.
fn is_open(row: &Row, motion: Motion) -> bool {
    let Outcome::Measured(measured) = &row.outcome else { return false };
    let has_figures = measured.motions.iter().any(|figures| figures.motion == motion);
    !has_figures && !row.notes.iter().any(|note| note.starts_with(&note_of(motion)))
}

/// Returns the beginning of the note that gives that reason.
fn note_of(motion: Motion) -> String {
    format!("Not measured while the {} moves: ", motion.name())
}

/// Returns the names of the missing measurements of a motion.
pub(super) fn open_names(rows: &[Row], motion: Motion) -> impl Iterator<Item = String> {
    let open = rows.iter().filter(move |row| is_open(row, motion));
    open.map(move |row| format!("{}, {} in motion", row.technique, motion.name()))
}

fn has_truth(report: &Report, motion: Motion) -> bool {
    report.motion.iter().flat_map(|info| &info.truths).any(|truth| truth.motion == motion)
}

fn add_truth(report: &mut Report, truth: &MotionTruth) {
    if !has_truth(report, truth.summary.motion)
        && let Some(info) = &mut report.motion
    {
        info.truths.push(truth.summary.clone());
    }
}
