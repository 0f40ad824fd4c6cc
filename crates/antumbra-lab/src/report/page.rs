//! Page of a report: fragments of HTML for the data, inserted into `page.html`.

mod gallery;
mod plots;
mod table;

use std::fmt::Write;

use serde_json::{Value, json};

use super::baseline::baseline_section;
use super::glossary::METRICS;
use super::html::{css_color, escape, fill, grouped, json_for_script, list, rounded_count, three_figures};
use super::model::{Measurement, Outcome, ReferenceInfo, Report, Row};
use super::motion::motion_section;
use super::paths::{REFERENCE_STEM, error_path, shaded_path, visibility_path};
use crate::color_maps::{NON_FINITE_COLOR, NOT_JUDGED_COLOR, SIGNED_ERROR_RANGE, signed_error_color};
use crate::scene_facts::SceneFacts;
use gallery::gallery;
use plots::{bars, findings, scatters};
use table::{table, time_note};

const TEMPLATE: &str = include_str!("page.html");
const SCRIPT: &str = concat!(include_str!("page.js"), include_str!("copy.js"));
pub(super) const STYLE: &str = include_str!("style.css");

/// Icon of an annular eclipse: the ring of light around an occluder seen from the antumbra.
pub(super) const ICON: &str = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E\
    %3Ccircle cx='16' cy='16' r='14' fill='%23f0b35c'/%3E\
    %3Ccircle cx='17' cy='15.4' r='10.6' fill='%231c1e22'/%3E%3C/svg%3E";

/// A measured row with its index among all rows and its name in files and anchors.
struct Measured<'a> {
    row_number: usize,
    row: &'a Row,
    stem: String,
    measured: &'a Measurement,
}

impl Measured<'_> {
    /// Returns the technique's name, or its stem if that is numbered.
    fn name(&self) -> &str {
        if self.stem.len() == self.row.technique.len() { &self.row.technique } else { &self.stem }
    }
}

/// Returns the whole page.
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
        "Antumbra {} · {} · The numbers are in <code>metrics.json</code> next to this page.",
        escape(commit),
        escape(date)
    )
}

/// Returns the notice that accompanies times of a software renderer.
pub(super) fn software_notice(adapter: &str) -> String {
    format!(
        "<p class=\"notice\"><b>Times are from a software renderer</b> ({} runs on the CPU). They roughly show the cost of \
         each pass on this machine, and say little about any GPU.</p>",
        escape(adapter)
    )
}

/// Formats a metric's value for tables.
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
            format!("{} light samples per pixel <small>{}</small>", grouped(info.samples.into()), tracing_text(info)),
        ),
        ("Adapter", format!("{} <small>{}</small>", escape(&report.adapter.name), driver.join(" · "))),
    ];
    let mut html = "<dl class=\"facts\">".to_owned();
    for (name, value) in facts {
        let _ = write!(html, "<div><dt>{name}</dt><dd>{value}</dd></div>");
    }
    html + "</dl>"
}

/// Returns the scene facts in the words of the command line.
fn scene_facts(facts: &SceneFacts) -> String {
    let lines: String = facts.lines().iter().map(|line| format!("<li>{}</li>", escape(line))).collect();
    format!("<ul class=\"note\" aria-label=\"Properties of the scene\">{lines}</ul>")
}

/// Describes the number of rays, with time and rate if measured.
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
            "<p class=\"notice\"><b>No time was left for {names}.</b> Run the same command with --resume to continue.</p>"
        )
    };
    software + &missing + &list("warnings", &report.warnings)
}

fn legend() -> String {
    const STOPS: usize = 21;
    let error_at = |i: usize| SIGNED_ERROR_RANGE * (2.0 * i as f32 / (STOPS - 1) as f32 - 1.0);
    let stops: Vec<String> = (0..STOPS).map(|i| css_color(signed_error_color(error_at(i)))).collect();
    format!(
        "<div class=\"legend\" role=\"img\" aria-label=\"Error maps: blue is too dark, white is correct, red is too bright, \
         saturated at plus or minus {range}\"><div class=\"scale\"><div class=\"ends\"><span>too dark · \
         overshadow</span><span>correct</span><span>too bright · leak</span></div><div class=\"ramp\" \
         style=\"background:linear-gradient(90deg,{})\"></div><div class=\"ticks\"><span>≤ −{range}</span><span>V − \
         V<sub>ref</sub> = 0</span><span>≥ +{range}</span></div></div><span><i class=\"swatch\" \
         style=\"background:{}\"></i>not measured: background, or facing away from the light</span><span><i class=\"swatch\" \
         style=\"background:{}\"></i>not a number</span></div>",
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
        "Over the {} pixels ({share:.0} %) with geometry that faces the light's centre; <i>flip</i> is over the whole shaded image.",
        grouped(judged as u64)
    )
}

/// Returns text in a box with a button that copies it.
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
            "Visibility: the fraction of the light's area that is visible from a surface point. 1 is lit, 0 is umbra, between \
             them is penumbra.",
        ),
        ("V_ref", "Ray-traced visibility: the ground truth with which techniques are compared."),
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

/// Returns the data of the script: the images and their groups.
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
