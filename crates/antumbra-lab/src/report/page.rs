//! The page of a report: fragments of HTML around the data, put into `page.html`.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{Value, json};

use super::baseline::baseline_section;
use super::glossary::{METRICS, MetricInfo};
use super::html::{bytes, css_color, escape, fill, grouped, json_for_script, list, rounded_count, three_figures};
use super::model::{Measurement, Outcome, ReferenceInfo, Report, Row};
use super::motion::motion_section;
use super::paths::{REFERENCE_STEM, error_path, shaded_path, visibility_exr_path, visibility_path};
use super::scatter::{Axes, Point, front, scatter_svg};
use crate::color_maps::{NON_FINITE_COLOR, NOT_JUDGED_COLOR, SIGNED_ERROR_RANGE, signed_error_color};
use crate::metrics::TILE_PX;
use crate::scene_facts::SceneFacts;

const TEMPLATE: &str = include_str!("page.html");
const SCRIPT: &str = concat!(include_str!("page.js"), include_str!("copy.js"));
pub(super) const STYLE: &str = include_str!("style.css");

/// An annular eclipse: the ring of light that stands around an occluder seen from the antumbra.
pub(super) const ICON: &str = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E\
    %3Ccircle cx='16' cy='16' r='14' fill='%23f0b35c'/%3E\
    %3Ccircle cx='17' cy='15.4' r='10.6' fill='%231c1e22'/%3E%3C/svg%3E";

/// A measured row with its number among all rows and its name in files and anchors.
struct Measured<'a> {
    row_number: usize,
    row: &'a Row,
    stem: String,
    measured: &'a Measurement,
}

impl Measured<'_> {
    /// The technique's name as it was given, or its stem where that had to be numbered.
    fn name(&self) -> &str {
        if self.stem.len() == self.row.technique.len() { &self.row.technique } else { &self.stem }
    }
}

/// The whole page.
pub(super) fn page_html(report: &Report) -> String {
    let rows = measured_rows(report);
    let size_px = report.reference.visibility.size_px;
    fill(
        TEMPLATE,
        &[
            ("title", &escape(&report.scene.name)),
            ("icon", ICON),
            ("style", STYLE),
            ("script", SCRIPT),
            ("scene", &escape(&report.scene.name)),
            ("summary", &paragraph("lede", &report.scene.summary)),
            ("facts", &facts(report)),
            ("scene_facts", &report.facts.as_ref().map_or_else(String::new, scene_facts)),
            ("notices", &notices(report)),
            ("width", &size_px.x.to_string()),
            ("height", &size_px.y.to_string()),
            ("hero", &shaded_path(REFERENCE_STEM)),
            ("hero_alt", &format!("{}, shaded with ray-traced soft shadows", escape(&report.scene.name))),
            ("legend", &legend()),
            ("judged", &judged_note(report)),
            ("table", &table(report, &rows)),
            ("time_note", &time_note(report)),
            ("scatter", &scatters(&rows)),
            ("findings", &findings(&rows)),
            ("bars", &bars(&rows)),
            ("motion_link", if report.motion.is_some() { "<a href=\"#motion\">Motion</a>" } else { "" }),
            ("baseline", &report.baseline.as_ref().map_or_else(String::new, baseline_section)),
            ("motion", &motion_section(report)),
            ("gallery", &gallery(report, &rows)),
            ("command", &copyable(&report.command)),
            ("setup", &copyable(&report.scene.setup_toml)),
            ("glossary", &glossary()),
            ("footer", &footer(&report.commit, &report.date)),
            ("data", &json_for_script(&data(report, &rows))),
        ],
    )
}

pub(super) fn footer(commit: &str, date: &str) -> String {
    format!(
        "Antumbra {} · {} · <code>metrics.json</code> beside this page holds the numbers.",
        escape(commit),
        escape(date)
    )
}

/// What is said wherever times of a software adapter stand.
pub(super) fn software_notice(adapter: &str) -> String {
    format!(
        "<p class=\"notice\"><b>Times are from a software renderer</b> ({} runs on the CPU). They show roughly what \
         each pass costs here and say little about any GPU.</p>",
        escape(adapter)
    )
}

/// A metric's value for tables.
pub(super) fn metric_text(v: f64) -> String {
    format!("{v:.4}")
}

fn measured_rows(report: &Report) -> Vec<Measured<'_>> {
    let rows = report.rows.iter().zip(report.stems()).enumerate();
    rows.filter_map(|(row_number, (row, stem))| match &row.outcome {
        Outcome::Measured(measured) => Some(Measured { row_number, row, stem, measured }),
        Outcome::Skipped(_) => None,
    })
    .collect()
}

fn paragraph(class: &str, text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("<p class=\"{class}\">{}</p>", escape(text)) }
}

fn facts(report: &Report) -> String {
    let reference = &report.reference;
    let info = reference.info;
    let size_px = reference.visibility.size_px;
    let driver = [&report.adapter.driver, &report.adapter.backend].map(|s| escape(s));
    let facts = [
        ("Triangles", grouped(report.scene.triangles)),
        ("Image", format!("{} × {}", size_px.x, size_px.y)),
        (
            "Truth",
            format!("{} light points a pixel <small>{}</small>", grouped(info.samples.into()), tracing_text(info)),
        ),
        ("Adapter", format!("{} <small>{}</small>", escape(&report.adapter.name), driver.join(" · "))),
    ];
    let mut html = "<dl class=\"facts\">".to_owned();
    for (name, value) in facts {
        let _ = write!(html, "<div><dt>{name}</dt><dd>{value}</dd></div>");
    }
    html + "</dl>"
}

/// What the scene is like, in the words of the command line.
fn scene_facts(facts: &SceneFacts) -> String {
    let lines: String = facts.lines().iter().map(|line| format!("<li>{}</li>", escape(line))).collect();
    format!("<ul class=\"note\" aria-label=\"What the scene is like\">{lines}</ul>")
}

/// Rays, and time and rate where they were measured.
fn tracing_text(info: ReferenceInfo) -> String {
    let rays = format!("{} rays", rounded_count(info.rays as f64));
    match info.rays_per_second() {
        None => rays,
        Some(rate) => {
            format!("{rays} in {} s on the CPU, {} rays/s", three_figures(info.seconds), rounded_count(rate))
        }
    }
}

fn notices(report: &Report) -> String {
    let software = if report.adapter.is_software { software_notice(&report.adapter.name) } else { String::new() };
    let missing = if report.missing.is_empty() {
        String::new()
    } else {
        let names = escape(&report.missing.join(", "));
        format!(
            "<p class=\"notice\"><b>No time was left for {names}.</b> The same command with --resume continues.</p>"
        )
    };
    software + &missing + &list("warnings", &report.warnings)
}

fn legend() -> String {
    const STOPS: usize = 21;
    let error_at = |i: usize| SIGNED_ERROR_RANGE * (2.0 * i as f32 / (STOPS - 1) as f32 - 1.0);
    let stops: Vec<String> = (0..STOPS).map(|i| css_color(signed_error_color(error_at(i)))).collect();
    format!(
        "<div class=\"legend\" role=\"img\" aria-label=\"Error maps: blue is too dark, white is right, red is too \
         bright, full at plus or minus {range}\">\
         <div class=\"scale\"><div class=\"ends\"><span>too dark · overshadow</span><span>right</span><span>too \
          bright · leak</span></div>\
         <div class=\"ramp\" style=\"background:linear-gradient(90deg,{})\"></div>\
         <div class=\"ticks\"><span>≤ −{range}</span><span>V − V<sub>ref</sub> = 0</span>\
         <span>≥ +{range}</span>\
          </div></div>\
         <span><i class=\"swatch\" style=\"background:{}\"></i>not judged: background, or turned away from the \
          light</span>\
         <span><i class=\"swatch\" style=\"background:{}\"></i>not a number</span></div>",
        stops.join(","),
        css_color(NOT_JUDGED_COLOR),
        css_color(NON_FINITE_COLOR),
        range = SIGNED_ERROR_RANGE,
    )
}

fn judged_note(report: &Report) -> String {
    let judged = report.reference.judged.iter().filter(|&&judged| judged).count();
    let share = 100.0 * judged as f64 / report.reference.judged.len().max(1) as f64;
    format!(
        "Over the {} pixels ({share:.0} %) with geometry that faces the light's centre; <i>flip</i> over the \
         whole shaded picture.",
        grouped(judged as u64)
    )
}

/// A sortable head of a column: its tooltip is the title until the script takes it over.
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

/// A cell with some HTML behind its value, where it has one.
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

fn table(report: &Report, rows: &[Measured]) -> String {
    let least = |values: &dyn Fn(&Measurement) -> Option<f64>| {
        rows.iter().filter_map(|row| values(row.measured)).min_by(f64::total_cmp)
    };
    let memory_of = |measured: &Measurement| measured.memory_bytes.map(|count| count as f64);
    let (least_ms, least_memory) = (least(&|m| m.total_ms), least(&memory_of));

    let mut html = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"numbers-title\"><table \
     class=\"numbers\" id=\"table\"><thead><tr><th scope=\"col\" data-key=\"technique\">Technique</th>"
        .to_owned();
    let meaning = "Median time of one frame's shadows, in milliseconds, with the number of timed frames and of warm-up frames before them.";
    html += &head("total_ms", "ms", meaning, "lower is better");
    for info in &METRICS {
        html += &head(info.key, info.label, info.meaning, info.direction());
    }
    html += &head("memory_bytes", "memory", "GPU memory that the technique holds.", "lower is better");
    let _ = write!(
        html,
        "</tr></thead><tbody><tr class=\"truth\"><th scope=\"row\"><a \
         href=\"#row-{REFERENCE_STEM}\">Reference</a><small>ray-traced truth</small></th><td colspan=\"{}\" \
         style=\"text-align:left\">{}; every other row is compared with it</td></tr>",
        METRICS.len() + 2,
        tracing_text(report.reference.info)
    );
    // Rows whose numbers read the same as the best one's are as good.
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
        let is_least = rows.len() > 1 && total_ms.is_some() && total_ms == least_ms;
        html += &cell_with(total_ms, three_figures, is_least, &format!("<br><small>{count}</small>"));
        for (info, best) in METRICS.iter().zip(&best) {
            let value = (info.value)(&row.measured.metrics);
            html += &cell(value, metric_text, value.is_some() && value.map(metric_text) == *best);
        }
        let memory = memory_of(row.measured);
        html += &cell(memory, |b| bytes(b as u64), rows.len() > 1 && memory.is_some() && memory == least_memory);
        html += "</tr>";
    }
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
    html + "</tbody></table></div>"
}

fn time_note(report: &Report) -> String {
    let kind = if report.adapter.is_software {
        "a software renderer on the CPU, not a GPU: frames by the processor's clock, passes by the driver's, which dates \
         them inexactly"
    } else {
        "GPU timestamps"
    };
    format!(
        "Milliseconds for the shadows of one frame on <b>{}</b> ({kind}): medians of frames that are drawn once frames have come to \
         take as long as one another. The table says of how many, after how many.",
        escape(&report.adapter.name)
    )
}

/// The techniques that have both an error and a cost.
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

/// Every error against every cost; without a script the first alone is seen.
fn scatters(rows: &[Measured]) -> String {
    type Value = fn(&Measured) -> Option<f64>;
    let errors: [(&str, Value); 4] = [
        ("rmse", rmse),
        ("roughness", |row| row.measured.metrics.roughness),
        ("umbra leak", |row| row.measured.metrics.umbra_leak),
        ("lit loss", |row| row.measured.metrics.lit_loss),
    ];
    let costs: [(&str, &str, Value); 2] = [
        ("milliseconds a frame", "ms", total_ms),
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

/// What the numbers say at a glance, and no more than they say.
fn findings(rows: &[Measured]) -> String {
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
        html += &line("Closest to the eye", row, flip(row));
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
            "<p class=\"note\">No other technique beats these in both error and time (the dashed line): {}.</p>",
            front.join(" → ")
        );
    }
    html
}

/// A colour for each pass, by name, the same in every row.
fn pass_colors(rows: &[Measured]) -> BTreeMap<String, String> {
    let mut colors = BTreeMap::new();
    for pass in rows.iter().flat_map(|row| &row.measured.passes) {
        let next = colorous::TABLEAU10[colors.len() % colorous::TABLEAU10.len()];
        colors.entry(pass.name.clone()).or_insert_with(|| css_color(next.into_array()));
    }
    colors
}

fn bars(rows: &[Measured]) -> String {
    let colors = pass_colors(rows);
    let sum_ms = |row: &Measured| row.measured.passes.iter().map(|pass| pass.median_ms).sum::<f64>();
    let longest_ms = rows.iter().map(sum_ms).fold(0.0, f64::max);
    if longest_ms <= 0.0 {
        return "<p class=\"note\">This adapter gave no times of passes.</p>".into();
    }
    let mut html = "<div class=\"bars\" id=\"bars\"><header><h3>Where it goes</h3><span class=\"kinds only-js\" \
     role=\"group\" aria-label=\"Lengths\"><button type=\"button\" data-lengths=\"scale\" \
     aria-pressed=\"true\">To scale</button><button type=\"button\" data-lengths=\"full\" \
     aria-pressed=\"false\">Shares</button></span></header>"
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
    // In the order in which passes first come, not by name.
    let mut seen = Vec::new();
    for pass in rows.iter().flat_map(|row| &row.measured.passes) {
        if !seen.contains(&&pass.name) {
            seen.push(&pass.name);
            let _ = write!(html, "<span><i style=\"--c:{}\"></i>{}</span>", colors[&pass.name], escape(&pass.name));
        }
    }
    html + "</div></div>"
}

fn shot(src: &str, alt: &str, caption: &str, size_px: glam::UVec2) -> String {
    format!(
        "<a class=\"shot\" href=\"{src}\" data-image=\"{src}\"><img src=\"{src}\" alt=\"{}\" width=\"{}\" \
         height=\"{}\" loading=\"lazy\"><span>{caption}</span></a>",
        escape(alt),
        size_px.x,
        size_px.y
    )
}

/// The error map, with an outline of the worst tile.
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

fn gallery(report: &Report, rows: &[Measured]) -> String {
    let colors = pass_colors(rows);
    let size_px = report.reference.visibility.size_px;
    let info = report.reference.info;
    let mut html = format!(
        "<article class=\"row\" id=\"row-{REFERENCE_STEM}\"><header><h3>Reference</h3><span \
         class=\"mono\">ray-traced truth</span></header><div class=\"shots\">{}{}<div class=\"shot text\">{} \
         light points, {}, at one point of each pixel. Shaded pictures are antialiased, visibility is not.<br>Visibility as <a href=\"{}\">32-bit float OpenEXR</a>; \
         the <a href=\"images/judged.png\">mask of judged pixels</a>.</div></div></article>",
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

/// Numbers with commas between them.
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

/// Text in a box with a button that copies it.
pub(super) fn copyable(text: &str) -> String {
    format!(
        "<div class=\"copy\"><pre><code>{}</code></pre><button type=\"button\" class=\"only-js\">Copy</button></div>",
        escape(text.trim_end())
    )
}

pub(super) fn glossary() -> String {
    let mut html = "<dl class=\"glossary\">".to_owned();
    let terms = [
        (
            "V",
            "Visibility: the fraction of the light's area that a surface point sees. 1 lit, 0 umbra, between them \
             penumbra.",
        ),
        ("V_ref", "Visibility traced ray by ray: the ground truth that techniques are compared with."),
    ];
    for (term, meaning) in terms {
        let _ = write!(html, "<div><dt>{term}</dt><dd>{}</dd></div>", escape(meaning));
    }
    for info in &METRICS {
        let _ = write!(
            html,
            "<div><dt>{}</dt><dd>{} <i>{}</i></dd></div>",
            info.key,
            escape(info.meaning),
            info.direction()
        );
    }
    html + "</dl>"
}

/// What the script needs: the images, and which of them to show first.
fn data(report: &Report, rows: &[Measured]) -> Value {
    let size_px = report.reference.visibility.size_px;
    let image = |group: usize, kind: &str, src: String| json!({ "group": group, "kind": kind, "src": src });
    // Group 0 is the reference, as in values.js.
    let mut groups = vec![json!({ "name": "Reference", "title": "ray-traced truth" })];
    let mut images =
        vec![image(0, "shaded", shaded_path(REFERENCE_STEM)), image(0, "visibility", visibility_path(REFERENCE_STEM))];
    for (i, row) in rows.iter().enumerate() {
        groups.push(json!({ "name": row.name(), "title": row.row.title }));
        images.push(image(i + 1, "shaded", shaded_path(&row.stem)));
        images.push(image(i + 1, "visibility", visibility_path(&row.stem)));
        images.push(image(i + 1, "error", error_path(&row.stem)));
    }
    json!({ "width": size_px.x, "height": size_px.y, "groups": groups, "images": images })
}
