//! Gallery of a report: images of each technique with its errors, parameters and passes.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::Value;

use super::plots::pass_colors;
use super::{Measured, copyable, metric_text, tracing_text};
use crate::metrics::TILE_PX;
use crate::report::html::{bytes, escape, grouped, list, three_figures};
use crate::report::model::{Measurement, Outcome, Report, Row};
use crate::report::paths::{REFERENCE_STEM, error_path, shaded_path, visibility_exr_path, visibility_path};

fn shot(src: &str, alt: &str, caption: &str, size_px: glam::UVec2) -> String {
    format!(
        "<a class=\"shot\" href=\"{src}\" data-image=\"{src}\"><img src=\"{src}\" alt=\"{}\" width=\"{}\" \
         height=\"{}\" loading=\"lazy\"><span>{caption}</span></a>",
        escape(alt),
        size_px.x,
        size_px.y
    )
}

/// Returns the error map with an outline of the worst tile.
fn error_shot(stem: &str, worst_tile_at: Option<[u32; 2]>, size_px: glam::UVec2) -> String {
    let shot = shot(
        &error_path(stem),
        &format!("{stem}, signed error"),
        "Error: red too bright, blue too dark; the worst tile is outlined",
        size_px,
    );
    let Some([left, top]) = worst_tile_at else { return shot };
    let percent = |px: u32, of: u32| 100.0 * f64::from(px) / f64::from(of.max(1));
    let outline = format!(
        "<i class=\"tile\" style=\"left:{:.3}%;top:{:.3}%;width:{:.3}%;height:{:.3}%\"></i></b><span>",
        percent(left, size_px.x),
        percent(top, size_px.y),
        percent(TILE_PX.min(size_px.x), size_px.x),
        percent(TILE_PX.min(size_px.y), size_px.y)
    );
    shot.replacen("<img", "<b class=\"tiled\"><img", 1).replacen("<span>", &outline, 1)
}

pub(super) fn gallery(report: &Report, rows: &[Measured]) -> String {
    let colors = pass_colors(rows);
    let size_px = report.reference.visibility.size_px;
    let info = report.reference.info;
    let mut html = format!(
        "<article class=\"row\" id=\"row-{REFERENCE_STEM}\"><header><h3>Reference</h3><span class=\"mono\">ray-traced \
         truth</span></header><div class=\"shots\">{}{}<div class=\"shot text\">{} light samples, {}, at one point of each \
         pixel. Shaded images are antialiased, visibility is not.<br>Visibility as <a href=\"{}\">32-bit float OpenEXR</a>; \
         the <a href=\"images/judged.png\">mask of measured pixels</a>.</div></div></article>",
        shot(&shaded_path(REFERENCE_STEM), "Reference, shaded", "Shaded", size_px),
        shot(&visibility_path(REFERENCE_STEM), "Reference, visibility", "Visibility: white is lit", size_px),
        grouped(info.samples.into()),
        tracing_text(info),
        visibility_exr_path(REFERENCE_STEM),
    );
    let mut measured = rows.iter().peekable();
    for (row_number, row) in report.rows.iter().enumerate() {
        match measured.next_if(|candidate| candidate.row_number == row_number) {
            Some(candidate) => html += &article(candidate, &colors, size_px),
            None => {
                if let Outcome::Skipped(reason) = &row.outcome {
                    let _ = write!(
                        html,
                        "<article class=\"row\"><header><h3>{}</h3><span class=\"mono\">{}</span></header><p \
                         class=\"note\">Skipped: {}</p>{}{}</article>",
                        escape(&row.title),
                        escape(&row.technique),
                        escape(reason),
                        list("warnings", &row.warnings),
                        list("notes", &row.notes)
                    );
                }
            }
        }
    }
    html
}

/// Formats numbers as a list with commas.
fn listed(numbers: &[u32]) -> String {
    numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
}

fn article(row: &Measured, colors: &BTreeMap<String, String>, size_px: glam::UVec2) -> String {
    let Measured { row, stem, measured, .. } = row;
    let metrics = &measured.metrics;
    let mut sum = Vec::new();
    sum.extend(metrics.rmse.map(|v| format!("rmse <b>{}</b>", metric_text(v))));
    sum.extend(metrics.flip.map(|v| format!("flip <b>{}</b>", metric_text(v))));
    sum.extend(metrics.roughness.map(|v| format!("roughness <b>{}</b>", metric_text(v))));
    sum.extend(measured.total_ms.map(|ms| format!("<b>{}</b> ms, {}", three_figures(ms), measured.count)));
    sum.extend(measured.memory_bytes.map(|count| format!("<b>{}</b>", bytes(count))));
    if !measured.auto_map_sizes.is_empty() {
        sum.push(format!("maps of <b>{}</b>² texels", listed(&measured.auto_map_sizes)));
    }

    let mut warnings = row.warnings.clone();
    if metrics.non_finite > 0 {
        let count = grouped(metrics.non_finite);
        warnings.insert(
            0,
            format!("{count} values are NaN or infinite; they count as errors and are magenta in the error map."),
        );
    }
    let mut html = format!(
        "<article class=\"row\" id=\"row-{stem}\"><header><h3>{}</h3><span class=\"mono\">{}</span><span \
         class=\"sum\">{}</span></header>{}<div class=\"shots\">{}{}{}</div>{}",
        escape(&row.title),
        escape(stem),
        sum.join(" · "),
        list("warnings", &warnings),
        shot(&shaded_path(stem), &format!("{stem}, shaded"), "Shaded", size_px),
        shot(&visibility_path(stem), &format!("{stem}, visibility"), "Visibility", size_px),
        error_shot(stem, metrics.worst_tile_at, size_px),
        list("notes", &row.notes),
    );
    html += &copyable(&row.command);
    html += "<details><summary>Parameters, passes and files</summary><div class=\"inner\">";
    html += &parameters(row);
    html += &passes(measured, colors);
    let _ = write!(
        html,
        "<p style=\"margin:0\">Visibility as <a href=\"{}\">32-bit float OpenEXR</a></p>",
        visibility_exr_path(stem)
    );
    html + "</div></details></article>"
}

fn parameters(row: &Row) -> String {
    let mut html = "<dl class=\"params mono\">".to_owned();
    for (key, value) in &row.parameters {
        let text = match value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        let _ = write!(html, "<div><dt>{}</dt><dd>{}</dd></div>", escape(key), escape(&text));
    }
    html + "</dl>"
}

fn passes(measured: &Measurement, colors: &BTreeMap<String, String>) -> String {
    if measured.passes.is_empty() {
        return String::new();
    }
    let ms = |v: Option<f64>| v.map_or_else(|| "–".into(), three_figures);
    let mut html = format!(
        "<div class=\"wide\"><table><caption class=\"note\">Milliseconds, {}</caption><thead><tr><th scope=\"col\">Pass</th><th \
         scope=\"col\">median ms</th><th scope=\"col\">p10 – p90</th><th scope=\"col\">bytes</th></tr></thead><tbody>",
        measured.count
    );
    for pass in &measured.passes {
        let _ = write!(
            html,
            "<tr><th scope=\"row\"><i class=\"key\" style=\"--c:{}\"></i>{}</th>\
             <td>{}</td><td>{} – {}</td><td>{}</td></tr>",
            colors[&pass.name],
            escape(&pass.name),
            three_figures(pass.median_ms),
            ms(pass.p10_ms),
            ms(pass.p90_ms),
            pass.bytes.map_or_else(|| "–".into(), bytes)
        );
    }
    html + "</tbody></table></div>"
}
