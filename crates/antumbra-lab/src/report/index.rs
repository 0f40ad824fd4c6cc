//! Index page of several reports: an image of each scene, and the best techniques.

use std::fmt::Write;
use std::path::Path;

use super::glossary::METRICS;
use super::html::{escape, fill, grouped, three_figures};
use super::model::{IndexEntry, IndexTechnique};
use super::page::{ICON, STYLE, glossary, metric_text, software_notice};
use super::paths::{REFERENCE_STEM, shaded_path};
use super::scatter::{Axes, Point, front, scatter_svg};
use crate::output_files::{FileError, write_atomically};
use crate::stopwatch::FrameCount;

const TEMPLATE: &str = include_str!("index.html");

/// Writes `index.html` into `dir`, which contains the folder of each entry, and `summary.md`: time and
/// error of each technique over all scenes.
pub fn write_index(dir: &Path, entries: &[IndexEntry]) -> Result<(), FileError> {
    write_atomically(&dir.join("summary.md"), summary_markdown(entries).as_bytes())?;
    write_atomically(&dir.join("index.html"), index_html(entries).as_bytes())
}

/// Geometric means of a technique over scenes, all of which it was measured on.
struct OverAll<'a> {
    technique: &'a str,
    rmse: f64,
    ms: f64,
    /// Smallest numbers of timed and of warm-up frames over the scenes.
    count: FrameCount,
}

fn over_all<'a>(entries: &[IndexEntry], techniques: &[&'a str]) -> Vec<OverAll<'a>> {
    let of_scenes = |name: &str| -> Option<(Vec<(f64, f64)>, FrameCount)> {
        let in_entry = |entry: &'_ IndexEntry| {
            let found = entry.techniques.iter().find(|technique| technique.technique == name)?;
            let figures = (found.metrics.rmse.filter(|rmse| *rmse > 0.0)?, found.total_ms.filter(|ms| *ms > 0.0)?);
            Some((figures, found.count))
        };
        let (figures, counts): (Vec<_>, Vec<_>) =
            entries.iter().map(in_entry).collect::<Option<Vec<_>>>()?.into_iter().unzip();
        Some((figures, FrameCount::least(counts)?))
    };
    let mean = |values: &[f64]| (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp();
    techniques
        .iter()
        .filter_map(|technique| {
            let (figures, count) = of_scenes(technique)?;
            let (errors, times): (Vec<_>, Vec<_>) = figures.into_iter().unzip();
            Some(OverAll { technique, rmse: mean(&errors), ms: mean(&times), count })
        })
        .collect()
}

fn points_of(rows: &[OverAll<'_>]) -> Vec<Point> {
    let point = |row: &OverAll<'_>| Point {
        name: row.technique.to_owned(),
        anchor: "errors".to_owned(),
        cost: row.ms,
        error: row.rmse,
    };
    rows.iter().map(point).collect()
}

fn summary_markdown(entries: &[IndexEntry]) -> String {
    let scenes: Vec<_> = entries.iter().map(|entry| entry.scene.as_str()).collect();
    let adapter = entries.first().map(|entry| entry.adapter.name.as_str()).unwrap_or_default();
    let mut text = format!(
        "Geometric means over {}, on {adapter}; in **bold** what no other beats in both. Times are medians, with the least numbers of \
         timed frames and of warm-up frames.\n\n| technique | rmse | median ms | timed frames | warm-up frames |\n|---|---|---|---|---|\n",
        scenes.join(", ")
    );
    let rows = over_all(entries, &technique_names(entries));
    let points = points_of(&rows);
    let best = front(&points);
    for OverAll { technique, rmse, ms, count: FrameCount { frames, warm_up } } in &rows {
        let is_best = best.iter().any(|point| point.name == *technique);
        let name = if is_best { format!("**`{technique}`**") } else { format!("`{technique}`") };
        let _ = writeln!(text, "| {name} | {} | {} | {frames} | {warm_up} |", metric_text(*rmse), three_figures(*ms));
    }
    text
}

fn index_html(entries: &[IndexEntry]) -> String {
    let techniques = technique_names(entries);
    let adapter = entries.first().map(|entry| entry.adapter.clone()).unwrap_or_default();
    let lede = format!(
        "{} {}, {} {}, on {}. Choose a scene to see its images, error maps and times.",
        entries.len(),
        if entries.len() == 1 { "scene" } else { "scenes" },
        techniques.len(),
        if techniques.len() == 1 { "technique" } else { "techniques" },
        escape(&adapter.name)
    );
    let footer = entries.first().map(|entry| format!("Antumbra {} · {}", escape(&entry.commit), escape(&entry.date)));
    fill(
        TEMPLATE,
        &[
            ("count", &entries.len().to_string()),
            ("icon", ICON),
            ("style", STYLE),
            ("lede", &lede),
            ("notices", &if adapter.is_software { software_notice(&adapter.name) } else { String::new() }),
            ("hard_against_soft", &hard_against_soft(entries)),
            ("columns", columns(entries.len())),
            ("cards", &entries.iter().map(card).collect::<String>()),
            ("errors", &errors_table(entries, &techniques)),
            ("front", &front_of_all(entries, &techniques)),
            ("best", &best_table(entries)),
            ("glossary", &glossary()),
            ("footer", &footer.unwrap_or_default()),
        ],
    )
}

/// Returns the technique names of all entries, in order of first appearance.
fn technique_names(entries: &[IndexEntry]) -> Vec<&str> {
    let mut names = Vec::new();
    for technique in entries.iter().flat_map(|entry| &entry.techniques) {
        if !names.contains(&technique.technique.as_str()) {
            names.push(technique.technique.as_str());
        }
    }
    names
}

fn report_link(entry: &IndexEntry) -> String {
    format!("{}/index.html", escape(&entry.folder))
}

/// Returns a slider between `hard` (or else the technique with the largest error) and the truth, on the first scene.
fn hard_against_soft(entries: &[IndexEntry]) -> String {
    let Some(entry) = entries.first() else { return String::new() };
    let error = |technique: &&IndexTechnique| technique.metrics.rmse.unwrap_or(0.0);
    let hard = entry.techniques.iter().find(|technique| technique.technique == "hard");
    let worst = || entry.techniques.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
    let Some(left) = hard.or_else(worst) else { return String::new() };
    let (scene, name) = (escape(&entry.scene), escape(&left.technique));
    let path = |stem: &str| format!("{}/{}", escape(&entry.folder), shaded_path(stem));
    format!(
        "<section aria-label=\"Image and ray-traced truth\"><figure class=\"against\"><div class=\"frame\"><img src=\"{}\" \
         alt=\"{scene}, shaded with {name}\"><img class=\"over\" src=\"{}\" alt=\"{scene}, shaded with ray-traced soft \
         shadows\"><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"Share of {name}, percent\" \
         oninput=\"this.parentElement.style.setProperty('--split', this.value + \
         '%')\"></div><figcaption><span><code>{name}</code></span><span>ray-traced truth</span></figcaption></figure></section>",
        path(&left.stem),
        path(REFERENCE_STEM)
    )
}

/// Returns the class of a grid of cards: narrow ones if wide ones would leave a single card in the last row.
fn columns(cards: usize) -> &'static str {
    if cards % 3 == 1 && cards % 4 != 1 { "cards narrow" } else { "cards" }
}

fn card(entry: &IndexEntry) -> String {
    let best = METRICS[0].best(entry.techniques.iter().map(|technique| &technique.metrics));
    let best = best.map(|(i, rmse)| {
        format!(" · least error: {}, rmse {}", escape(&entry.techniques[i].technique), metric_text(rmse))
    });
    let summary = if entry.summary.is_empty() { String::new() } else { format!("<p>{}</p>", escape(&entry.summary)) };
    format!(
        "<a class=\"card\" href=\"{}\"><img src=\"{}/{}\" alt=\"{}, shaded with ray-traced soft shadows\" \
         loading=\"lazy\"><h3>{}</h3>{summary}<p>{} triangles{}</p></a>",
        report_link(entry),
        escape(&entry.folder),
        shaded_path(REFERENCE_STEM),
        escape(&entry.scene),
        escape(&entry.scene),
        grouped(entry.triangles),
        best.unwrap_or_default()
    )
}

fn scene_head(entry: &IndexEntry) -> String {
    format!("<tr><th scope=\"row\"><a href=\"{}\">{}</a></th>", report_link(entry), escape(&entry.scene))
}

fn table_start(label: &str, columns: &[&str]) -> String {
    let mut html = format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{label}\"><table \
         class=\"numbers\"><thead><tr><th scope=\"col\">Scene</th>"
    );
    for column in columns {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escape(column));
    }
    html + "</tr></thead><tbody>"
}

fn errors_table(entries: &[IndexEntry], techniques: &[&str]) -> String {
    let mut html = table_start("errors", techniques);
    for entry in entries {
        html += &scene_head(entry);
        let best = METRICS[0].best(entry.techniques.iter().map(|technique| &technique.metrics)).map(|best| best.0);
        for name in techniques {
            let found = entry.techniques.iter().position(|technique| technique.technique == *name);
            let Some((i, rmse)) = found.and_then(|i| Some((i, entry.techniques[i].metrics.rmse?))) else {
                html += "<td>–</td>";
                continue;
            };
            let text = metric_text(rmse);
            let text = if best == Some(i) { format!("<b class=\"best\">{text}</b>") } else { text };
            let IndexTechnique { total_ms, count, .. } = &entry.techniques[i];
            let ms = total_ms.map(|ms| format!("<br><small>{} ms<br>{count}</small>", three_figures(ms)));
            let _ = write!(html, "<td>{text}{}</td>", ms.unwrap_or_default());
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

/// Plots error against time over all scenes: geometric means of the techniques measured on every scene.
fn front_of_all(entries: &[IndexEntry], techniques: &[&str]) -> String {
    let points = points_of(&over_all(entries, techniques));
    let axes = Axes { cost: "milliseconds per frame", cost_unit: "ms", error: "rmse" };
    scatter_svg(&points, axes).unwrap_or_else(|| "<p class=\"note\">No technique was timed on every scene.</p>".into())
}

fn best_table(entries: &[IndexEntry]) -> String {
    let mut html = table_start("best", &METRICS.each_ref().map(|info| info.label));
    for entry in entries {
        html += &scene_head(entry);
        for info in &METRICS {
            match info.best(entry.techniques.iter().map(|technique| &technique.metrics)) {
                None => html += "<td>–</td>",
                Some((i, v)) => {
                    let name = escape(&entry.techniques[i].technique);
                    let _ = write!(html, "<td>{name}<br><small>{}</small></td>", metric_text(v));
                }
            }
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}
