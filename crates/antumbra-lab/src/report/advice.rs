//! An advice as a page, a preset and JSON.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::html::{bytes, escape, three_figures};
use super::page::{ICON, STYLE, metric_text, software_notice};
use super::scatter::{Axes, Point, scatter_svg};
use crate::advise::{Advice, Candidate, Prefer};
use crate::image_io::write_png;
use crate::output_files::{FileError, write_atomically};
use crate::preset::preset_toml;

/// Writes an advice into a folder, each file whole or not at all: `index.html`, `advice.json`, `advice.toml` (the preset) and
/// `images/`. Gives the preset's path.
pub fn write_advice(dir: &Path, advice: &Advice) -> Result<std::path::PathBuf, FileError> {
    let images = dir.join("images");
    fs::create_dir_all(&images).map_err(|error| FileError::from_write(&images, &error))?;
    write_png(&images.join("reference.png"), &advice.true_picture)?;
    write_png(&images.join("advice.png"), &advice.picture)?;
    write_png(&images.join("error.png"), &advice.error_picture)?;
    let preset = dir.join("advice.toml");
    write_atomically(&preset, preset_text(advice).as_bytes())?;
    let json = serde_json::to_string_pretty(advice).expect("an advice has text");
    write_atomically(&dir.join("advice.json"), format!("{json}\n").as_bytes())?;
    write_atomically(&dir.join("index.html"), page(advice).as_bytes())?;
    Ok(preset)
}

/// The preset, with where it comes from above it.
fn preset_text(advice: &Advice) -> String {
    let line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    format!(
        "# {}\n# rmse {:.4}, {} ms ({}) on {}\n{}",
        line(&advice.command),
        advice.best.rmse,
        three_figures(advice.best.worst_ms()),
        advice.best.counted(),
        line(&advice.adapter.name),
        preset_toml(&advice.best.config.choice())
    )
}

fn page(advice: &Advice) -> String {
    let title = format!("Advice for {}", escape(&advice.scene));
    let mut html = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\"><title>{title}</title><link rel=\"icon\" \
         href=\"{ICON}\"><style>{STYLE}</style></head><body><main><h1>{title}</h1>"
    );
    if advice.adapter.is_software {
        html += &software_notice(&advice.adapter.name);
    }
    let _ = write!(
        html,
        "<p class=\"lede\"><b>{}</b>: rmse {}, roughness {}, {} ms of {}, {:.0} % of the budget, {}.</p><p class=\"note\">{}</p>",
        escape(&advice.best.name),
        metric_text(advice.best.rmse),
        metric_text(advice.best.roughness),
        three_figures(advice.best.worst_ms()),
        three_figures(advice.budget_ms.get(advice.best.heaviest_view).copied().unwrap_or(0.0)),
        100.0 * advice.best.load,
        bytes(advice.best.memory_bytes),
        escape(&times_note(advice)),
    );
    html += &items("Why", &advice.reasons.iter().map(ToString::to_string).collect::<Vec<_>>());
    for (view, facts) in advice.views.iter().zip(&advice.facts) {
        html += &items(&format!("What {view} is like"), &facts.lines());
    }
    html += "<h2>Pictures</h2>";
    for (file, what) in [
        ("advice", "shaded with the recommendation"),
        ("reference", "shaded with the truth"),
        ("error", "error: blue too dark, red too bright"),
    ] {
        let _ = write!(
            html,
            "<figure><img src=\"images/{file}.png\" alt=\"{what}\" style=\"max-width:100%\"><figcaption>{what}</figcaption></figure>"
        );
    }
    html += "<h2>Error against time</h2>";
    let axes = Axes { cost: "milliseconds a frame", cost_unit: "ms", error: "rmse" };
    html += &scatter_svg(&points(advice), axes).unwrap_or_default();
    html += "<h2>Candidates</h2>";
    html += &table(advice);
    let _ = write!(
        html,
        "<h2>Again</h2><pre>{}</pre><p class=\"note\"><code>advice.toml</code> beside this page is the preset.</p></main><footer>Antumbra {} · {} \
         · {} measurements, {} s</footer></body></html>",
        escape(&advice.command),
        escape(&advice.commit),
        escape(&advice.date),
        advice.spent.measurements,
        three_figures(advice.spent.seconds)
    );
    html
}

/// What the times are of: the budget of each view, what `pcf` takes, and of how many frames they are medians.
fn times_note(advice: &Advice) -> String {
    let times = |values: &[f64]| values.iter().map(|ms| three_figures(*ms)).collect::<Vec<_>>().join(", ");
    let pcf =
        if advice.pcf_ms.is_empty() { String::new() } else { format!(" (pcf takes {} ms)", times(&advice.pcf_ms)) };
    let view = match advice.views.len() {
        0 | 1 => String::new(),
        _ => format!(" The time is that of {}.", advice.views[advice.best.heaviest_view]),
    };
    format!("The budget is {} ms{pcf}. The time is a {}.{view}", times(&advice.budget_ms), advice.best.counted())
}

fn items(title: &str, lines: &[String]) -> String {
    let lines: String = lines.iter().map(|line| format!("<li>{}</li>", escape(line))).collect();
    format!("<h2>{}</h2><ul>{lines}</ul>", escape(title))
}

/// The recommendation, the runners-up, the step up and the front, each once.
fn shown(advice: &Advice) -> Vec<&Candidate> {
    let mut shown: Vec<&Candidate> = Vec::new();
    let all = std::iter::once(&advice.best).chain(&advice.runners_up).chain(&advice.next_step).chain(&advice.front);
    for one in all {
        if shown.iter().all(|other| other.name != one.name) {
            shown.push(one);
        }
    }
    shown
}

fn anchor(i: usize) -> String {
    format!("candidate-{i}")
}

fn points(advice: &Advice) -> Vec<Point> {
    let point = |(i, one): (usize, &Candidate)| Point {
        name: one.technique.to_owned(),
        anchor: anchor(i),
        cost: one.worst_ms(),
        error: one.rmse,
    };
    shown(advice).into_iter().enumerate().map(point).collect()
}

fn table(advice: &Advice) -> String {
    let mut html = "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th>Technique and settings</th><th>rmse</th><th>roughness</th><th>ms</th>\
                    <th>median of</th><th>of the budget</th><th>memory</th>"
        .to_owned();
    if advice.prefer == Prefer::Motion {
        html += "<th>flicker</th>";
    }
    html += "</tr></thead><tbody>";
    for (i, one) in shown(advice).into_iter().enumerate() {
        let name = escape(&one.name);
        let name = if i == 0 { format!("<b class=\"best\">{name}</b>") } else { name };
        let _ = write!(
            html,
            "<tr id=\"{}\"><th scope=\"row\">{name}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.0} %</td><td>{}</td>",
            anchor(i),
            metric_text(one.rmse),
            metric_text(one.roughness),
            three_figures(one.worst_ms()),
            one.counted_briefly(),
            100.0 * one.load,
            bytes(one.memory_bytes)
        );
        if advice.prefer == Prefer::Motion {
            let _ = write!(html, "<td>{}</td>", one.flicker.map_or_else(|| "–".to_owned(), metric_text));
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}
