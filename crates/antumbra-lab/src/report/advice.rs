//! Advice as a page, a preset and JSON.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::html::{bytes, escape, fill, list, three_figures};
use super::page::{ICON, STYLE, copyable, metric_text, software_notice};
use super::scatter::{Axes, Point, scatter_svg};
use crate::advise::{Advice, Candidate, Prefer};
use crate::image_io::write_png;
use crate::output_files::{FileError, write_atomically};
use crate::preset::preset_toml;

const TEMPLATE: &str = include_str!("advice.html");

/// Writes an advice into a folder, each file completely or not at all: `index.html`, `advice.json`, `advice.toml` (the preset) and
/// `images/`. Returns the preset's path.
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

/// Returns the preset's text with its origin as a comment above.
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
    let best = &advice.best;
    let name = format!("<b>{}</b>", escape(&best.name));
    let answer = match (advice.keeps_budget, advice.is_too_noisy_to_tell) {
        (false, _) => format!("No configuration keeps the budget. {name} is closest."),
        (true, true) => {
            format!("Use {name}. Some of its times exceed the budget: repeat the search on an idle machine.")
        }
        (true, false) => format!("Use {name}."),
    };
    let scene_facts = advice
        .views
        .iter()
        .zip(&advice.facts)
        .map(|(view, facts)| format!("<h3>Properties of {}</h3>{}", escape(view), list("notes", &facts.lines())));
    let axes = Axes { cost: "milliseconds per frame", cost_unit: "ms", error: "rmse" };
    let notices = if advice.adapter.is_software { software_notice(&advice.adapter.name) } else { String::new() };
    let [commit, date] = [&advice.commit, &advice.date].map(|text| escape(text));
    fill(
        TEMPLATE,
        &[
            ("title", &format!("Advice for {}", escape(&advice.scene))),
            ("icon", ICON),
            ("style", STYLE),
            ("answer", &answer),
            ("facts", &facts(advice)),
            ("notices", &notices),
            ("images", &images()),
            ("usage", &copyable("antumbra render SCENE --technique advice.toml -o image.png")),
            ("preset", &copyable(&preset_toml(&best.config.choice()))),
            ("program", &copyable(&program(advice))),
            ("reasons", &list("", &advice.reasons.iter().map(ToString::to_string).collect::<Vec<_>>())),
            ("times", &escape(&times_note(advice))),
            ("scenes", &scene_facts.collect::<String>()),
            ("front", &scatter_svg(&points(advice), axes).unwrap_or_default()),
            ("table", &table(advice)),
            ("command", &copyable(&advice.command)),
            (
                "footer",
                &format!(
                    "Antumbra {commit} · {date} · {} measurements, {} s · The numbers are in <code>advice.json</code> next to this page.",
                    advice.spent.measurements,
                    three_figures(advice.spent.seconds)
                ),
            ),
        ],
    )
}

/// Returns the facts of the recommendation: error, time, memory.
fn facts(advice: &Advice) -> String {
    let best = &advice.best;
    let budget_ms = advice.budget_ms.get(best.heaviest_view).copied().unwrap_or(0.0);
    let facts = [
        ("Error", format!("{} <small>rmse</small>", metric_text(best.rmse))),
        ("Roughness", metric_text(best.roughness)),
        (
            "Time",
            format!(
                "{} ms <small>{:.0} % of {} ms</small>",
                three_figures(best.worst_ms()),
                100.0 * best.load,
                three_figures(budget_ms)
            ),
        ),
        ("Memory", bytes(best.memory_bytes)),
        ("Adapter", escape(&advice.adapter.name)),
        ("Image", format!("{} × {}", advice.size[0], advice.size[1])),
    ];
    let facts = facts.map(|(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>"));
    format!("<dl class=\"facts\">{}</dl>", facts.concat())
}

fn images() -> String {
    let images = [
        ("advice", "Shaded with the recommendation"),
        ("reference", "Shaded with ray-traced visibility"),
        ("error", "Error: blue is too dark, red is too bright"),
    ];
    let shot = |(file, what)| {
        format!(
            "<a class=\"shot\" href=\"images/{file}.png\"><img src=\"images/{file}.png\" alt=\"\"><span>{what}</span></a>"
        )
    };
    images.map(shot).concat()
}

/// Returns Rust code that creates the technique with its settings.
fn program(advice: &Advice) -> String {
    let config = &advice.best.config;
    let mut lines = format!("let mut shadow = TechniqueKind::{:?}.create(&gpu)?;", config.kind);
    for (key, value) in &config.settings {
        let _ = write!(lines, "\nshadow.set({key:?}, {value:?})?;");
    }
    lines
}

/// Describes the times: budget of each view, time of `pcf`, and number of frames of the medians.
fn times_note(advice: &Advice) -> String {
    let times = |values: &[f64]| values.iter().map(|ms| three_figures(*ms)).collect::<Vec<_>>().join(", ");
    let pcf =
        if advice.pcf_ms.is_empty() { String::new() } else { format!(" (pcf takes {} ms)", times(&advice.pcf_ms)) };
    let view = match advice.views.len() {
        0 | 1 => String::new(),
        _ => format!(" The time is the one on {}.", advice.views[advice.best.heaviest_view]),
    };
    format!("The budget is {} ms{pcf}. The time is a {}.{view}", times(&advice.budget_ms), advice.best.counted())
}

/// Returns the recommendation, the runners-up, the step up and the front, each once.
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
    let mut html = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"candidates\"><table class=\"numbers candidates\"><thead><tr><th>Technique and settings</th><th>rmse</th><th>ms</th>\
                    <th>of the budget</th><th>roughness</th><th>memory</th><th>median of</th>"
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
            "<tr id=\"{}\"><th scope=\"row\">{name}</th><td>{}</td><td>{}</td><td>{:.0} %</td><td>{}</td><td>{}</td><td>{}</td>",
            anchor(i),
            metric_text(one.rmse),
            three_figures(one.worst_ms()),
            100.0 * one.load,
            metric_text(one.roughness),
            bytes(one.memory_bytes),
            one.counted_briefly()
        );
        if advice.prefer == Prefer::Motion {
            let _ = write!(html, "<td>{}</td>", one.flicker.map_or_else(|| "–".to_owned(), metric_text));
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}
