//! `antumbra reproduce`.

use antumbra_lab::progress::Progress;
use antumbra_lab::reproduce::{Exhibit, Measure, PAPERS, Paper, Readiness, Reported, Row, exhibits, run_row};
use serde_json::{Value, json};

use crate::args::ReproduceArgs;
use crate::commands::{open_device, write_json};
use crate::failure::Failure;
use crate::progress::Bars;
use crate::stdout::say;
use crate::suggest::did_you_mean;
use crate::table;

/// Lists the papers' exhibits, or runs some.
pub fn reproduce(args: &ReproduceArgs, bars: &Bars) -> Result<(), Failure> {
    if args.ids.is_empty() {
        list();
        return Ok(());
    }
    let chosen = choose(&args.ids)?;
    if let Some(path) = &args.json {
        antumbra_lab::output_files::check_writable(path)?;
    }
    let lab = open_device(&args.adapter)?;
    say!("Adapter: {}", lab.adapter.name);
    let mut all = Vec::new();
    for (name, paper, exhibit) in chosen {
        say!("\n{name}: {}\n{}; there: {}\n", exhibit.shows, paper.citation, paper.hardware);
        if exhibit.rows.is_empty() {
            say!("  a drawing: nothing to run");
        }
        let mut rows = vec![["ROW", "TECHNIQUE", "PAPER", "HERE"].map(str::to_owned).to_vec()];
        let mut values = Vec::new();
        for row in exhibit.rows {
            let row = &Row { size_px: args.size.map_or(row.size_px, |size| (size.x, size.y)), ..*row };
            bars.begin(row.what, 0);
            let result = run_row(&lab, row, args.frames)?;
            bars.end();
            rows.push(vec![row.what.into(), row.technique.into(), row.measure.paper_text(), result.to_string()]);
            values.push(json!({
                "what": row.what, "scene": row.scene, "technique": row.technique,
                "settings": row.settings, "size": [row.size_px.0, row.size_px.1],
                "light_scale": row.light_scale, "frames_added_up": row.frames,
                "paper": reported(&row.measure), "here": result,
            }));
        }
        if rows.len() > 1 {
            table::print(&rows);
        }
        all.push(json!({ "id": name, "shows": exhibit.shows, "citation": paper.citation, "rows": values }));
    }
    if let Some(path) = &args.json {
        write_json(path, &json!({ "adapter": lab.adapter.name, "exhibits": all }))?;
    }
    Ok(())
}

fn list() {
    for paper in &PAPERS {
        say!("{}\n  {}; measured on {}", paper.id, paper.citation, paper.hardware);
        let rows: Vec<Vec<String>> = paper
            .exhibits
            .iter()
            .map(|exhibit| {
                let state = match exhibit.readiness() {
                    Readiness::Drawing => "a drawing".to_owned(),
                    Readiness::Ready => "ready".to_owned(),
                    Readiness::Partly(missing) => format!("in part; not yet: needs {}", missing.join(", ")),
                    Readiness::NotYet(missing) => format!("not yet: needs {}", missing.join(", ")),
                };
                vec![format!("  {}/{}", paper.id, exhibit.id), exhibit.shows.into(), state]
            })
            .collect();
        table::print(&rows);
        say!("");
    }
    say!("`antumbra reproduce ID...` runs what can be run.");
}

fn choose(ids: &[String]) -> Result<Vec<(String, &'static Paper, &'static Exhibit)>, Failure> {
    let known: Vec<_> = exhibits().collect();
    if ids.iter().any(|id| id == "all") {
        return Ok(known);
    }
    let mut chosen = Vec::new();
    for id in ids {
        let matching: Vec<_> = known.iter().filter(|(name, paper, _)| name == id || paper.id == id).cloned().collect();
        if matching.is_empty() {
            let names = known.iter().map(|(name, ..)| name.as_str());
            return Err(Failure::Input(format!(
                "reproduce: there is no entry `{id}`{}; `antumbra reproduce` lists them",
                did_you_mean(id, names)
            )));
        }
        chosen.extend(matching);
    }
    Ok(chosen)
}

fn reported(measure: &Measure) -> Value {
    match measure {
        Measure::Ms { paper: Reported::Number(ms), .. } => json!({ "ms": ms }),
        Measure::Fps { paper: Reported::Number(fps) } => json!({ "fps": fps }),
        _ => Value::Null,
    }
}
