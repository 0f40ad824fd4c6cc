//! Motion section of the page: a table of flicker and lag, and a strip of frames per technique.

use std::fmt::Write;

use super::html::{escape, three_figures};
use super::model::{MotionInfo, Outcome, Report};
use super::paths::{REFERENCE_STEM, motion_path};
use crate::motion::flicker::SETTLED;
use crate::motion::{Motion, MotionFigures, STRIP_FLICKER_RANGE, TrueMotion};

/// Returns the section, or nothing without motion.
pub(super) fn motion_section(report: &Report) -> String {
    let Some(info) = &report.motion else { return String::new() };
    format!(
        "<section id=\"motion\" aria-labelledby=\"motion-title\"><h2 id=\"motion-title\">Motion</h2>{}{}{}</section>\n",
        lead(info),
        table(report, info),
        info.truths.iter().map(|truth| strips(report, truth)).collect::<String>()
    )
}

fn lead(info: &MotionInfo) -> String {
    let mut noise = String::new();
    for truth in &info.truths {
        if let Some(value) = truth.noise {
            let _ = write!(noise, " {} for the {},", figure(Some(value)), truth.motion.name());
        }
    }
    format!(
        "<p class=\"note\">One thing moves for {} frames, {} m each, and stops where it is in the images above; a technique \
         keeps its state from frame to frame. <i>Flicker</i> is the rms of the mask's change from frame to frame minus the \
         truth's change at the same pixels. <i>Ratio</i> is flicker divided by that change: 0 moves like the truth, 1 is as \
         wrong as a mask that never changes. <i>Lag</i> is the number of frames after the stop until the mask is within \
         {SETTLED} of its final state. The truth has {} light samples per pixel, the same in all frames; its own noise, \
         measured as flicker, is{}.</p>",
        info.frames,
        info.step_m,
        info.samples,
        noise.trim_end_matches(','),
    )
}

fn figure(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |v| format!("{v:.4}"))
}

fn name_of(truth: &TrueMotion) -> String {
    match &truth.caster {
        Some(caster) => format!("caster ({})", escape(caster)),
        None => truth.motion.name().to_owned(),
    }
}

/// Formats the lag: a number, or a lower bound if it did not settle.
fn lag_text(figures: &MotionFigures) -> String {
    match figures.lag_frames {
        Some(frames) => frames.to_string(),
        None if figures.after_stop.is_empty() => "–".into(),
        None => format!("&gt; {}", figures.after_stop.len()),
    }
}

/// Returns name, stem and motion results of the measured rows.
fn measured(report: &Report) -> impl Iterator<Item = (String, String, &[MotionFigures])> {
    report.rows.iter().zip(report.stems()).filter_map(|(row, stem)| match &row.outcome {
        Outcome::Measured(measured) => Some((row.technique.clone(), stem, measured.motions.as_slice())),
        Outcome::Skipped(_) => None,
    })
}

fn of(motions: &[MotionFigures], motion: Motion) -> Option<&MotionFigures> {
    motions.iter().find(|figures| figures.motion == motion)
}

fn table(report: &Report, info: &MotionInfo) -> String {
    let mut html = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"motion-title\"><table \
     class=\"numbers\"><thead><tr><th scope=\"col\">Technique</th>"
        .to_owned();
    for truth in &info.truths {
        let _ = write!(
            html,
            "<th scope=\"col\">{} flicker</th><th scope=\"col\">ratio</th><th scope=\"col\">lag, frames</th>",
            name_of(truth)
        );
    }
    html +=
        "</tr></thead><tbody><tr class=\"truth\"><th scope=\"row\">Reference<small>change of the truth</small></th>";
    for truth in &info.truths {
        let _ = write!(html, "<td>{}</td><td></td><td></td>", figure(truth.change));
    }
    html += "</tr>";
    let least = |motion: Motion| {
        let all = measured(report).filter_map(|(_, _, motions)| of(motions, motion)?.flicker);
        all.min_by(f64::total_cmp).map(|least| figure(Some(least)))
    };
    let least: Vec<_> = info.truths.iter().map(|truth| least(truth.motion)).collect();
    for (name, stem, motions) in measured(report) {
        let _ = write!(html, "<tr><th scope=\"row\"><a href=\"#row-{stem}\">{}</a></th>", escape(&name));
        for (truth, least) in info.truths.iter().zip(&least) {
            html += &match of(motions, truth.motion) {
                None => "<td>–</td><td>–</td><td>–</td>".to_owned(),
                Some(figures) => {
                    let flicker = figure(figures.flicker);
                    let is_least = figures.flicker.is_some() && Some(&flicker) == least.as_ref();
                    let flicker = if is_least { format!("<b class=\"best\">{flicker}</b>") } else { flicker };
                    let ratio = figures.ratio.map_or_else(|| "–".into(), three_figures);
                    format!("<td>{flicker}</td><td>{ratio}</td><td>{}</td>", lag_text(figures))
                }
            };
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

/// Returns the strips of one motion: the truth's, then every technique's.
fn strips(report: &Report, truth: &TrueMotion) -> String {
    let mut html = format!(
        "<h3>The {} moves</h3><p class=\"note\">Top: masks at equal intervals of the motion, and the final one. Bottom: the \
         change of each mask from the frame before, minus that of the truth (red: too bright, blue: too dark, saturated at \
         ±0.5), and the flicker of each pixel, brightest from {STRIP_FLICKER_RANGE}.</p>",
        name_of(truth),
    );
    html += &strip(
        &motion_path(REFERENCE_STEM, truth.motion),
        truth,
        &format!("<b>Reference</b> and its changes; rms {}", figure(truth.change)),
    );
    for (name, stem, motions) in measured(report) {
        let Some(figures) = of(motions, truth.motion) else { continue };
        let ratio = figures.ratio.map_or_else(|| "–".into(), three_figures);
        let caption = format!(
            "<b>{}</b> flicker {} · ratio {ratio} · lag {}",
            escape(&name),
            figure(figures.flicker),
            lag_text(figures)
        );
        html += &strip(&motion_path(&stem, truth.motion), truth, &caption);
    }
    html
}

fn strip(path: &str, truth: &TrueMotion, caption: &str) -> String {
    let (width, height) = truth.strip.dimensions();
    format!(
        "<figure class=\"strip\"><figcaption>{caption}</figcaption><a href=\"{path}\"><img src=\"{path}\" alt=\"frames and their \
         changes while the {} moves\" width=\"{width}\" height=\"{height}\" loading=\"lazy\"></a></figure>",
        truth.motion.name(),
    )
}
