//! Plots of a report: errors against costs, times by pass, and the main findings.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{Measured, metric_text};
use crate::report::html::{css_color, escape, three_figures};
use crate::report::scatter::{Axes, Point, front, scatter_svg};

/// Returns the points of techniques that have both an error and a cost.
fn points(
    rows: &[Measured],
    error: impl Fn(&Measured) -> Option<f64>,
    cost: impl Fn(&Measured) -> Option<f64>,
) -> Vec<Point> {
    let point = |row: &Measured| {
        Some(Point {
            name: row.name().to_owned(),
            anchor: format!("row-{}", row.stem),
            cost: cost(row).filter(|&cost| cost > 0.0)?,
            error: error(row)?,
        })
    };
    rows.iter().filter_map(point).collect()
}

fn total_ms(row: &Measured) -> Option<f64> {
    row.measured.total_ms
}

fn rmse(row: &Measured) -> Option<f64> {
    row.measured.metrics.rmse
}

/// Plots every error against every cost. Without a script, only the first plot is visible.
pub(super) fn scatters(rows: &[Measured]) -> String {
    type Value = fn(&Measured) -> Option<f64>;
    let errors: [(&str, Value); 4] = [
        ("rmse", rmse),
        ("roughness", |row| row.measured.metrics.roughness),
        ("umbra leak", |row| row.measured.metrics.umbra_leak),
        ("lit loss", |row| row.measured.metrics.lit_loss),
    ];
    let costs: [(&str, &str, Value); 2] = [
        ("milliseconds per frame", "ms", total_ms),
        ("MiB of GPU memory", "MiB", |row| row.measured.memory_bytes.map(|bytes| bytes as f64 / f64::from(1 << 20))),
    ];
    let mut html = String::new();
    for (cost, cost_unit, cost_of) in costs {
        for (error, error_of) in errors {
            let axes = Axes { cost, cost_unit, error };
            if let Some(svg) = scatter_svg(&points(rows, error_of, cost_of), axes) {
                let hidden = if html.is_empty() { "" } else { " hidden" };
                let _ = write!(html, "<div data-error=\"{error}\" data-cost=\"{cost}\"{hidden}>{svg}</div>");
            }
        }
    }
    let options = |names: &[&str]| names.iter().map(|name| format!("<option>{name}</option>")).collect::<String>();
    format!(
        "<div id=\"scatters\"><p class=\"note only-js\"><select aria-label=\"error\">{}</select> against <select \
         aria-label=\"cost\">{}</select></p>{html}</div>",
        options(&errors.map(|(name, _)| name)),
        options(&costs.map(|(name, ..)| name)),
    )
}

/// Lists the main findings that the numbers support.
pub(super) fn findings(rows: &[Measured]) -> String {
    let cost =
        |row: &Measured| row.measured.total_ms.map(|ms| format!(", {} ms", three_figures(ms))).unwrap_or_default();
    let line = |label: &str, row: &Measured, measure: Option<String>| {
        let link = format!("<a href=\"#row-{}\">{}</a>", row.stem, escape(row.name()));
        format!("<li><span class=\"label\">{label}</span>{link} — {}{}</li>", measure.unwrap_or_default(), cost(row))
    };
    let rmse_text = |row: &Measured| rmse(row).map(|v| format!("rmse {}", metric_text(v)));
    let flip = |row: &Measured| row.measured.metrics.flip.map(|v| format!("flip {}", metric_text(v)));
    let least = |value: &dyn Fn(&Measured) -> Option<f64>| {
        let valued = rows.iter().filter_map(|row| Some((row, value(row)?)));
        valued.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
    };
    let mut html = "<ul>".to_owned();
    if let Some(row) = least(&|row| row.measured.metrics.rmse) {
        html += &line("Closest to the truth", row, rmse_text(row));
    }
    if let Some(row) = least(&|row| row.measured.metrics.flip) {
        html += &line("Visually closest", row, flip(row));
    }
    let roughness = |row: &Measured| row.measured.metrics.roughness.map(|v| format!("roughness {}", metric_text(v)));
    if let Some(row) = least(&|row| row.measured.metrics.roughness) {
        html += &line("Fewest artefacts", row, roughness(row));
    }
    if let Some(row) = least(&|row| row.measured.total_ms) {
        html += &line("Fastest", row, rmse_text(row));
    }
    html += "</ul>";
    let link = |p: &Point| format!("<a href=\"#{}\">{}</a>", p.anchor, p.name);
    let front: Vec<String> = front(&points(rows, rmse, total_ms)).into_iter().map(link).collect();
    if front.len() > 1 {
        let _ = write!(
            html,
            "<p class=\"note\">No other technique is better than these in both error and time (dashed line): {}.</p>",
            front.join(" → ")
        );
    }
    html
}

/// Returns a colour for each pass name, the same in every row.
pub(super) fn pass_colors(rows: &[Measured]) -> BTreeMap<String, String> {
    let mut colors = BTreeMap::new();
    for pass in rows.iter().flat_map(|row| &row.measured.passes) {
        let next = colorous::TABLEAU10[colors.len() % colorous::TABLEAU10.len()];
        colors.entry(pass.name.clone()).or_insert_with(|| css_color(next.into_array()));
    }
    colors
}

pub(super) fn bars(rows: &[Measured]) -> String {
    let colors = pass_colors(rows);
    let sum_ms = |row: &Measured| row.measured.passes.iter().map(|pass| pass.median_ms).sum::<f64>();
    let longest_ms = rows.iter().map(sum_ms).fold(0.0, f64::max);
    if longest_ms <= 0.0 {
        return "<p class=\"note\">This adapter reports no times of passes.</p>".into();
    }
    let mut html = "<div class=\"bars\" id=\"bars\"><header><h3>Time by pass</h3><span class=\"kinds only-js\" role=\"group\" \
         aria-label=\"Lengths\"><button type=\"button\" data-lengths=\"scale\" aria-pressed=\"true\">To scale</button><button \
         type=\"button\" data-lengths=\"full\" aria-pressed=\"false\">Shares</button></span></header>"
        .to_owned();
    for row in rows {
        let _ = write!(
            html,
            "<div class=\"line\"><a class=\"name\" href=\"#row-{}\" style=\"color:inherit\">{}</a><span \
             class=\"track\"><span class=\"stack\" style=\"--share:{:.4}\">",
            row.stem,
            escape(row.name()),
            sum_ms(row) / longest_ms
        );
        for pass in &row.measured.passes {
            let text = format!("{}: {} ms", escape(&pass.name), three_figures(pass.median_ms));
            let _ = write!(
                html,
                "<span style=\"--c:{};--w:{:.5}\" title=\"{text}\"></span>",
                colors[&pass.name], pass.median_ms
            );
        }
        let total = row.measured.total_ms.unwrap_or_else(|| sum_ms(row));
        let _ = write!(html, "</span></span><span>{} ms</span></div>", three_figures(total));
    }
    html += "<div class=\"keys\">";
    // Passes are listed in order of first appearance, not by name.
    let mut seen = Vec::new();
    for pass in rows.iter().flat_map(|row| &row.measured.passes) {
        if !seen.contains(&&pass.name) {
            seen.push(&pass.name);
            let _ = write!(html, "<span><i style=\"--c:{}\"></i>{}</span>", colors[&pass.name], escape(&pass.name));
        }
    }
    html + "</div></div>"
}
