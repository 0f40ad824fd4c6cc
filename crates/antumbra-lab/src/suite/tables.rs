//! BENCHMARKS' tables of results, in Markdown.

use std::fmt::Write;

use antumbra::TechniqueKind;
use serde_json::Value;

use super::plan::{
    CLAIMS, ERROR_SCENES, GROWTH, MANY_VIEW_SCENES, MOTION_SCENE, Part, Plan, Step, TIME_SCENES, claim_job,
};
use super::{Done, MOTION_FRAMES, MOTION_STEP_M, Results, TIMING, TRUTH_SAMPLES};
use crate::motion::Motion;

/// Returns BENCHMARKS.md: every table with a result, its origin, and the command that reproduces it. A cell is empty if not measured yet,
/// and a dash if the adapter cannot run it. Techniques without any result have no rows and are listed once.
pub fn markdown(results: &Results) -> String {
    let plan = Plan::whole();
    let Done { jobs, of } = results.done(&plan);
    let has_times = results.ids().any(|id| !id.starts_with(&format!("{}/", Part::Errors.name())));
    let clock = if !has_times {
        ""
    } else if results.is_of_software() {
        " This adapter is a software renderer: its times say little about a GPU, which rasterises and filters textures in hardware and \
         has more bandwidth for its arithmetic. Frames are timed by the CPU's clock, passes by the driver's. The driver reports \
         some passes late or with no time, so their sum is less than the frame."
    } else {
        " Times are GPU timestamps."
    };
    let mut text = format!(
        "# Benchmarks\n\n\
         {adapter} ({driver}), commit {commit}, begun {begun}; {jobs} of {of} measurements.{clock}\n\n\
         `antumbra bench --suite FILE` measures every figure, and `antumbra bench --tables FILE` prints this page. Techniques have their \
         default settings unless a table says otherwise. Errors are root mean squares over pixels that face the light's centre, against \
         {TRUTH_SAMPLES} stratified rays a pixel. {times}An empty \
         cell was not measured; a dash is what the adapter cannot run.{absent} `bench/measurements.md` has other measurements, `bench/cards.md` times by graphics card.\n",
        adapter = results.about("adapter"),
        driver = results.about("driver"),
        commit = results.about("commit"),
        begun = results.about("begun"),
        times = if has_times {
            format!("Times are milliseconds, medians of {}; compare them within one table. ", counts(results))
        } else {
            String::new()
        },
        absent = absent(results),
    );
    text += &errors(results);
    text += &times(results);
    text += &growth(results);
    text += &claims(results);
    text += &motion(results);
    text += &views(results);
    text += &papers(results, &plan);
    text
}

/// Lists the techniques without a row, with the reason.
fn absent(results: &Results) -> String {
    let names = TechniqueKind::ALL.iter().filter(|kind| !is_measured(results, kind.name()));
    let names = names.map(|kind| format!("`{kind}`")).collect::<Vec<_>>();
    if names.is_empty() {
        return String::new();
    }
    format!(" Without a row, since the commit is older or the run ended before: {}.", names.join(", "))
}

/// Returns whether there is a result of a technique with its defaults.
fn is_measured(results: &Results, name: &str) -> bool {
    results.ids().any(|id| id.rsplit('/').next() == Some(name))
}

/// Returns `5 frames (2 for long ones) after 3 to 6 warm-up frames`: the numbers of timed and warm-up frames.
fn counts(results: &Results) -> String {
    let of = |key: &str| {
        let counts = results.rows().filter_map(|row| row["timings"][key].as_u64()).collect::<Vec<_>>();
        counts.iter().min().copied().zip(counts.iter().max().copied())
    };
    let (Some((fewest, most)), Some((least, greatest))) = (of("frames"), of("warm_up")) else {
        return format!("{} frames", TIMING.frames);
    };
    let long = if fewest < most { format!(" ({fewest} for long ones)") } else { String::new() };
    let warm_up = if least < greatest { format!("{least} to {greatest}") } else { least.to_string() };
    format!("{most} frames{long} after {warm_up} warm-up frames")
}

/// Formats a cell: the number that `value` finds in a result, with `decimals` decimals.
fn cell(row: Option<&Value>, decimals: usize, value: impl Fn(&Value) -> Option<f64>) -> String {
    match row {
        None => String::new(),
        Some(row) => value(row).map_or_else(|| "–".into(), |v| format!("{v:.decimals$}")),
    }
}

fn rmse(row: &Value) -> Option<f64> {
    row["metrics"]["rmse"].as_f64()
}

fn total_ms(row: &Value) -> Option<f64> {
    row["timings"]["total_ms"].as_f64()
}

fn mib(row: &Value) -> Option<f64> {
    row["memory_bytes"].as_f64().map(|bytes| bytes / f64::from(1 << 20))
}

/// Returns a table's head. A table without a result is omitted completely.
fn head(title: &str, columns: &[String]) -> String {
    format!("\n## {title}\n\n| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()))
}

/// Returns a table of techniques; empty if all its cells are.
fn of_techniques(results: &Results, title: &str, columns: &[String], cells: impl Fn(&str) -> Vec<String>) -> String {
    let measured = TechniqueKind::ALL.iter().map(|kind| kind.name()).filter(|name| is_measured(results, name));
    let rows: Vec<_> = measured.map(|name| (name, cells(name))).collect();
    if rows.iter().all(|(_, cells)| cells.iter().all(String::is_empty)) {
        return String::new();
    }
    let mut text = head(title, columns);
    for (name, cells) in rows {
        let _ = writeln!(text, "| `{name}` | {} |", cells.join(" | "));
    }
    text
}

fn named(first: &str, scenes: &[&str], last: &[&str]) -> Vec<String> {
    let scenes = scenes.iter().map(|scene| format!("`{scene}`"));
    std::iter::once(first.to_owned()).chain(scenes).chain(last.iter().map(|name| (*name).to_owned())).collect()
}

fn errors(results: &Results) -> String {
    let columns = named("rmse, 320 × 180", &ERROR_SCENES, &["MiB, `tree`"]);
    of_techniques(results, "Error against the ray tracer", &columns, |name| {
        let row = |scene: &str| results.row(&format!("errors/{scene}/{name}"));
        let mut cells: Vec<_> = ERROR_SCENES.iter().map(|scene| cell(row(scene), 4, rmse)).collect();
        cells.push(cell(row("tree"), 1, mib));
        cells
    })
}

fn times(results: &Results) -> String {
    let columns = named("ms, 640 × 360", &TIME_SCENES, &["passes on `knot`"]);
    of_techniques(results, "Time", &columns, |name| {
        let row = |scene: &str| results.row(&format!("times/{scene}/{name}"));
        let mut cells: Vec<_> = TIME_SCENES.iter().map(|scene| cell(row(scene), 2, total_ms)).collect();
        cells.push(row("knot").map_or_else(String::new, passes));
        cells
    })
}

fn growth(results: &Results) -> String {
    let of_step = |(what, steps): &(&str, [Step; 3])| {
        [format!("{what}: {}", steps.map(|step| step.name).join(", ")), "exponent".to_owned()]
    };
    let columns: Vec<_> =
        std::iter::once("ms, `columns`, 320 × 180".to_owned()).chain(GROWTH.iter().flat_map(of_step)).collect();
    let table = of_techniques(results, "Growth", &columns, |name| {
        let cells = GROWTH.iter().flat_map(|(_, steps)| {
            let row = |step: &Step| results.row(&step.id(name));
            let times = steps.each_ref().map(|step| cell(row(step), 1, total_ms));
            let ms = |step: &Step| row(step).and_then(total_ms);
            // Steps have a constant factor, so the least-squares line has the slope between first and last.
            let ends = ms(&steps[0]).zip(ms(&steps[2]));
            let exponent = ends.map(|(first, last)| (last / first).ln() / (steps[2].amount / steps[0].amount).ln());
            let times = if times.iter().all(String::is_empty) { String::new() } else { times.join(", ") };
            [times, exponent.map_or_else(String::new, |exponent| format!("{exponent:.2}"))]
        });
        cells.collect()
    });
    if table.is_empty() {
        return table;
    }
    table
        + "\nThe exponent is that of the column's quantity: 1 is proportional, 0.5 grows with the square root. Everything else is at its default.\n"
}

/// Formats the passes of a result with their times.
fn passes(row: &Value) -> String {
    let pass = |pass: &Value| Some(format!("{} {:.2}", pass["label"].as_str()?, pass["ms"].as_f64()?));
    let passes = row["timings"]["passes"].as_array();
    passes.map_or_else(|| "–".into(), |passes| passes.iter().filter_map(pass).collect::<Vec<_>>().join(", "))
}

fn claims(results: &Results) -> String {
    let mut rows = String::new();
    for (i, claim) in CLAIMS.iter().enumerate() {
        let side = |side: &str, scene: &str| results.row(&format!("claims/{scene}/{}", claim_job(i, side)));
        let (ours, against) = (side("ours", claim.ours.scene), side("against", claim.against.scene));
        if ours.is_none() && against.is_none() {
            continue;
        }
        let ratio = ours.and_then(total_ms).zip(against.and_then(total_ms)).map(|(ours, against)| against / ours);
        let named = |row, technique: &str| match cell(row, 2, total_ms) {
            empty if empty.is_empty() => empty,
            ms => format!("`{technique}` {ms} ms"),
        };
        let _ = writeln!(
            rows,
            "| {}, `{}` | {} | {} | {} |",
            claim.what,
            claim.ours.scene,
            named(ours, claim.ours.technique),
            named(against, claim.against.technique),
            ratio.map_or_else(String::new, |ratio| format!("{ratio:.2}")),
        );
    }
    if rows.is_empty() {
        return rows;
    }
    head("Claims", &["claim", "ours", "against", "ratio"].map(str::to_owned)) + &rows
}

fn motion(results: &Results) -> String {
    let columns: Vec<String> =
        std::iter::once(format!("`{MOTION_SCENE}`, {MOTION_FRAMES} frames of {MOTION_STEP_M} m"))
            .chain(
                Motion::ALL
                    .iter()
                    .flat_map(|motion| [format!("{} flicker", motion.name()), "ratio".into(), "lag".into()]),
            )
            .collect();
    of_techniques(results, "Motion", &columns, |name| {
        let cells = Motion::ALL.iter().flat_map(|motion| {
            let row = results.row(&format!("motion/{MOTION_SCENE}/{}/{name}", motion.name()));
            [("flicker", 4), ("ratio", 2), ("lag_frames", 0)]
                .map(|(key, decimals)| cell(row, decimals, |row| row[key].as_f64()))
        });
        cells.collect()
    })
}

fn views(results: &Results) -> String {
    let mut rows = String::new();
    for scene in MANY_VIEW_SCENES {
        let row = results.row(&format!("views/{scene}/multi_view"));
        if row.is_some() {
            let _ = writeln!(rows, "| `{scene}` | {} | {} |", cell(row, 4, rmse), cell(row, 1, total_ms));
        }
    }
    if rows.is_empty() {
        return rows;
    }
    let columns = ["`multi_view` of 256 views, 640 × 360", "rmse", "ms"].map(str::to_owned);
    head("Many views", &columns) + &rows
}

/// Returns the table of the papers' figures beside ours, for rows with results, described as they were run.
fn papers(results: &Results, plan: &Plan) -> String {
    let place =
        |row: &Value| plan.papers.iter().position(|paper| Some(paper.exhibit.as_str()) == row["exhibit"].as_str());
    let mut kept: Vec<&Value> = results.rows().filter(|row| row["exhibit"].is_string()).collect();
    kept.sort_by_key(|row| (place(row), row["number"].as_u64()));
    let mut rows = String::new();
    for row in kept {
        let text = |key: &str| row[key].as_str().unwrap_or_default();
        let [exhibit, what, technique, paper, here] = ["exhibit", "row", "technique", "paper", "here"].map(text);
        let _ = writeln!(rows, "| {exhibit} | {what} | `{technique}` | {paper} | {here} |");
    }
    if rows.is_empty() {
        return rows;
    }
    head("The papers", &["exhibit", "row", "technique", "paper", "here"].map(str::to_owned)) + &rows
}

#[cfg(test)]
mod tests {
    use serde_json::{Map, json};

    use super::*;

    /// Each kind of result appears in its table, and tables without results are omitted.
    #[test]
    fn results_become_tables() {
        let still = json!({ "metrics": { "rmse": 0.0123 }, "timings": { "total_ms": 8.0, "passes": [{ "label": "resolve", "ms": 7.5 }] },
            "memory_bytes": 3 << 20 });
        let moving = json!({ "flicker": 0.05, "ratio": 0.25, "lag_frames": 3 });
        let paper = Plan::whole().papers[0].clone();
        let rows: Map<String, Value> = [
            ("errors/tree/pcss".to_owned(), still.clone()),
            ("errors/overlap/pcss".to_owned(), json!({ "skipped": "it lacks something" })),
            ("times/knot/pcss".to_owned(), still.clone()),
            ("times/knot/hard".to_owned(), json!({ "timings": { "total_ms": 2.0, "frames": 5, "warm_up": 3 } })),
            ("times/columns/hard".to_owned(), json!({ "timings": { "total_ms": 2.0, "frames": 2, "warm_up": 4 } })),
            ("claims/shanty/0-ours".to_owned(), json!({ "timings": { "total_ms": 2.0 } })),
            ("claims/shanty/0-against".to_owned(), still),
            ("motion/lantern-wall/light/pcss".to_owned(), moving),
            (paper.id(), paper.kept("1.250 ms")),
        ]
        .into_iter()
        .chain(
            GROWTH[0]
                .1
                .iter()
                .zip([1.0, 4.0, 16.0])
                .map(|(step, ms)| (step.id("pcss"), json!({ "timings": { "total_ms": ms } }))),
        )
        .collect();
        let results = Results([("rows".to_owned(), Value::Object(rows))].into_iter().collect());
        let text = markdown(&results);
        for line in [
            "| `pcss` | – |  |  |  |  |  | 0.0123 | 3.0 |",
            "| `pcss` |  |  | 8.00 | resolve 7.50 |",
            "| `reprojection` 2.00 ms | `multi_view` 8.00 ms | 4.00 |",
            "| `pcss` |  |  |  | 0.0500 | 0.25 | 3 |  |  |  |",
            "| 1.250 ms |",
            "| `pcss` | 1.0, 4.0, 16.0 | 1.00 |  |  |  |  |  |  |",
        ] {
            assert!(text.contains(line), "no `{line}` in\n{text}");
        }
        assert!(!text.contains("Many views"), "nothing is known of these");
        assert!(text.contains("; 12 of "), "{text}");
        assert!(text.contains("ended before: `pcf`, `smrt`") && !text.contains("\n| `pcf` |"), "{text}");
        let frames = "medians of 5 frames (2 for long ones) after 3 to 4 warm-up frames";
        assert!(text.contains(frames), "{text}");
    }
}
