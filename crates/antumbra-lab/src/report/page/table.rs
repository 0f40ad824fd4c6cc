//! Table of a report: a row per technique, a column per metric, and the note on its times.

use std::fmt::Write;

use super::{Measured, metric_text, tracing_text};
use crate::report::glossary::{METRICS, MetricInfo};
use crate::report::html::{bytes, escape, three_figures};
use crate::report::model::{Measurement, Outcome, Report};
use crate::report::paths::REFERENCE_STEM;

/// Returns a sortable column head. Its tooltip is the title attribute until the script replaces it.
fn head(key: &str, label: &str, meaning: &str, direction: &str) -> String {
    format!(
        "<th scope=\"col\" data-key=\"{key}\" title=\"{} ({})\" data-direction=\"{}\" data-meaning=\"{}\">{}</th>",
        escape(meaning),
        escape(direction),
        escape(direction),
        escape(meaning),
        escape(label)
    )
}

fn cell(value: Option<f64>, text: impl Fn(f64) -> String, is_best: bool) -> String {
    cell_with(value, text, is_best, "")
}

/// Returns a cell with HTML appended to its value, if it has one.
fn cell_with(value: Option<f64>, text: impl Fn(f64) -> String, is_best: bool, behind: &str) -> String {
    match value {
        None => "<td data-value=\"\">–</td>".into(),
        Some(v) if is_best => {
            let text = text(v);
            format!(
                "<td data-value=\"{v}\"><b class=\"best\">{text}</b><span class=\"hidden\"> best</span>{behind}</td>"
            )
        }
        Some(v) => format!("<td data-value=\"{v}\">{}{behind}</td>", text(v)),
    }
}

pub(super) fn table(report: &Report, rows: &[Measured]) -> String {
    let least = |values: &dyn Fn(&Measurement) -> Option<f64>| {
        rows.iter().filter_map(|row| values(row.measured)).min_by(f64::total_cmp)
    };
    let memory_of = |measured: &Measurement| measured.memory_bytes.map(|count| count as f64);
    let (min_ms, min_memory) = (least(&|m| m.total_ms), least(&memory_of));

    let mut html = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"numbers-title\"><table \
     class=\"numbers\" id=\"table\"><thead><tr>"
        .to_owned();
    html += &heads();
    let _ = write!(
        html,
        "</tr></thead><tbody><tr class=\"truth\"><th scope=\"row\"><a \
         href=\"#row-{REFERENCE_STEM}\">Reference</a><small>ray-traced truth</small></th><td colspan=\"{}\" \
         style=\"text-align:left\">{}; every other row is compared with it</td></tr>",
        METRICS.len() + 2,
        tracing_text(report.reference.info)
    );
    // Rows that print the same value as the best one are marked, too.
    let best_text = |info: &MetricInfo| {
        info.best(rows.iter().map(|row| &row.measured.metrics)).map(|(_, v)| metric_text(v)).filter(|_| rows.len() > 1)
    };
    let best: Vec<Option<String>> = METRICS.iter().map(best_text).collect();
    for row in rows {
        let _ = write!(
            html,
            "<tr><th scope=\"row\"><a href=\"#row-{}\">{}</a><small>{}</small></th>",
            row.stem,
            escape(row.name()),
            escape(&row.row.title)
        );
        let Measurement { total_ms, count, .. } = *row.measured;
        let is_least = rows.len() > 1 && total_ms.is_some() && total_ms == min_ms;
        html += &cell_with(total_ms, three_figures, is_least, &format!("<br><small>{count}</small>"));
        for (info, best) in METRICS.iter().zip(&best) {
            let value = (info.value)(&row.measured.metrics);
            html += &cell(value, metric_text, value.is_some() && value.map(metric_text) == *best);
        }
        let memory = memory_of(row.measured);
        html += &cell(memory, |b| bytes(b as u64), rows.len() > 1 && memory.is_some() && memory == min_memory);
        html += "</tr>";
    }
    html + &skipped(report) + "</tbody></table></div>"
}

/// Returns the column heads.
fn heads() -> String {
    let mut html = "<th scope=\"col\" data-key=\"technique\">Technique</th>".to_owned();
    let meaning = "Median time of one frame's shadows in milliseconds, with the numbers of timed frames and of warm-up frames before them.";
    html += &head("total_ms", "ms", meaning, "lower is better");
    for info in &METRICS {
        html += &head(info.key, info.label, info.meaning, info.direction());
    }
    html + &head("memory_bytes", "memory", "GPU memory of the technique.", "lower is better")
}

/// Returns the rows of skipped techniques, with the reasons.
fn skipped(report: &Report) -> String {
    let mut html = String::new();
    for row in &report.rows {
        if let Outcome::Skipped(reason) = &row.outcome {
            let _ = write!(
                html,
                "<tr class=\"skipped\"><th scope=\"row\">{}<small>{}</small></th><td colspan=\"{}\">skipped: \
                 {}</td></tr>",
                escape(&row.technique),
                escape(&row.title),
                METRICS.len() + 2,
                escape(reason)
            );
        }
    }
    html
}

pub(super) fn time_note(report: &Report) -> String {
    let kind = if report.adapter.is_software {
        "a software renderer on the CPU, not a GPU: frames are timed by the CPU clock, passes inexactly by the driver"
    } else {
        "GPU timestamps"
    };
    format!(
        "Milliseconds for the shadows of one frame on <b>{}</b> ({kind}): medians over frames after a warm-up, which ends when \
         frame times are stable. The table has the numbers of timed and of warm-up frames.",
        escape(&report.adapter.name)
    )
}
