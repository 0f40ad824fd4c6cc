//! `antumbra reproduce`.

use std::path::{Path, PathBuf};

use antumbra_lab::baseline::{Baseline, Source, of_reproduced};
use antumbra_lab::device::LabDevice;
use antumbra_lab::error::LabError;
use antumbra_lab::progress::Progress;
use antumbra_lab::report::{AdapterInfo, ReproductionInfo, utc_now, write_reproduction};
use antumbra_lab::reproduce::{
    Exhibit, ExhibitResult, Form, Measure, PAPERS, Paper, REPRODUCED_NAME, Readiness, Reported, Ruling, RunOptions,
    SCENES_HINT, SCENES_VARIABLE, Session, VerdictCount, exhibits,
};
use serde_json::{Value, json};

use crate::args::ReproduceArgs;
use crate::commands::{COMMIT, check_folder, open_device, put_json, quoted};
use crate::failure::{Failure, SavedResults};
use crate::keep;
use crate::progress::Bars;
use crate::stdout::say;
use crate::suggest::did_you_mean;
use crate::table;
use crate::values::is_all;

/// An exhibit with its full name.
type Named = (String, &'static Paper, &'static Exhibit);

/// Lists the papers' exhibits, or runs the chosen ones.
pub fn reproduce(args: &ReproduceArgs, bars: &Bars) -> Result<(), Failure> {
    if args.ids.is_empty() && !args.all {
        return list_if_asked(args);
    }
    let limits = args.run.limits();
    let chosen = choose(args)?;
    let dir = args.output.clone().or_else(|| args.all.then(|| PathBuf::from("reproduced")));
    let baseline = check(args, dir.as_deref())?;
    let lab = open_device(&args.adapter)?;
    say!("Adapter: {}", lab.adapter.name);
    let mut session = Session::open(&lab, options(args, &lab), limits, dir.as_deref(), COMMIT)?;
    let info = info(args, &lab, dir.as_deref());
    let all: usize = chosen.iter().map(|(_, paper, exhibit)| exhibit.run_count(paper)).sum();
    let mut begun = 0;
    let mut results: Vec<ExhibitResult> = Vec::new();
    for (_, paper, exhibit) in chosen {
        let mut each = |session: &Session<'_>| -> Result<(), LabError> {
            if let Some(path) = &args.json {
                let current = session.result(paper, exhibit);
                put_json(path, &all_as_json(&lab, results.iter().chain([&current])))?;
            }
            dir.iter().for_each(|dir| keep(dir));
            Ok(())
        };
        let result = session.run(paper, exhibit, bars, (begun, all), &mut each)?;
        begun += exhibit.run_count(paper);
        print(&result);
        if let Some(dir) = &dir {
            write_reproduction(dir, &session.results(), &info)?;
        }
        results.push(result);
    }
    bars.end();
    sum_up(&results, session.ran(), all, dir.as_deref());
    let mut json = all_as_json(&lab, &results);
    if let Some(baseline) = baseline {
        let against = baseline.against(&of_reproduced(&results));
        say!("\n{}\n", against.summary());
        table::print(&against.table());
        json["baseline"] = json!(against);
    }
    json["missing"] = json!(session.missing());
    if let Some(path) = &args.json {
        put_json(path, &json)?;
    }
    if session.missing().is_empty() {
        return Ok(());
    }
    let alone = args.json.as_deref().map_or(SavedResults::Nothing, SavedResults::NotResumable);
    Err(Failure::incomplete(session.missing(), all, &dir.as_deref().map_or(alone, SavedResults::Resumable)))
}

fn options(args: &ReproduceArgs, lab: &LabDevice) -> RunOptions {
    let mut options = RunOptions { size_px: args.size, ..RunOptions::for_device(lab, args.frames) };
    options.samples = args.samples.unwrap_or(options.samples);
    options.runs_slow |= args.dear;
    options
}

fn info(args: &ReproduceArgs, lab: &LabDevice, dir: Option<&Path>) -> ReproductionInfo {
    ReproductionInfo {
        adapter: AdapterInfo::of(&lab.adapter),
        bandwidth_gb_s: args.bandwidth,
        commit: COMMIT.to_owned(),
        date: utc_now(),
        arguments: arguments(args, dir),
    }
}

fn all_as_json<'a>(lab: &LabDevice, results: impl IntoIterator<Item = &'a ExhibitResult>) -> Value {
    let exhibits: Vec<Value> = results.into_iter().map(as_json).collect();
    json!({ "adapter": lab.adapter.name, "commit": COMMIT, "exhibits": exhibits })
}

/// Validates the options before the long work. Returns the baseline, if any.
fn check(args: &ReproduceArgs, dir: Option<&Path>) -> Result<Option<Baseline>, Failure> {
    if args.run.resume && dir.is_none() {
        return Err(Failure::Input("--resume: `reproduce` resumes a folder; add -o DIR".into()));
    }
    if let Some(path) = &args.json {
        antumbra_lab::output_files::check_json_path(path)?;
    }
    if let Some(dir) = dir {
        check_folder(dir, REPRODUCED_NAME, "no results of `reproduce`")?;
    }
    Ok(args.run.baseline.as_deref().map(|path| Baseline::read(path, Source::Reproduce)).transpose()?)
}

/// Returns the arguments after an exhibit's name that repeat the run.
fn arguments(args: &ReproduceArgs, dir: Option<&Path>) -> String {
    let mut text = String::new();
    let mut add = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            text += &format!(" {name} {}", quoted(&value));
        }
    };
    add("-o", dir.map(|dir| dir.display().to_string()));
    add("--frames", (args.frames != 10).then(|| args.frames.to_string()));
    add("--size", args.size.map(|size| format!("{}x{}", size.x, size.y)));
    add("--samples", args.samples.map(|samples| samples.to_string()));
    add("--bandwidth", args.bandwidth.map(|bandwidth| bandwidth.to_string()));
    add("--adapter", args.adapter.adapter.clone());
    if args.dear { text + " --dear" } else { text }
}

fn print(result: &ExhibitResult) {
    let ExhibitResult { name, paper, exhibit, rows, judged } = result;
    say!(
        "\n{name}: {}\n{}; measured on {}, {} GB/s\n",
        exhibit.shows,
        paper.citation,
        paper.hardware,
        paper.bandwidth_gb_s
    );
    if !exhibit.note.is_empty() {
        say!("  not covered: {}", exhibit.note);
    } else if rows.is_empty() {
        say!("  a drawing, so there is nothing to run");
    }
    if rows.is_empty() {
        return;
    }
    let mut lines = vec![["ROW", "TECHNIQUE", "PAPER", "HERE"].map(str::to_owned).to_vec()];
    lines.extend(rows.iter().map(|one| {
        let measure = &one.row.measure;
        let name = format!("{}{}", one.row.technique, if one.form == Form::Ours { ", ours" } else { "" });
        vec![one.row.what.into(), name, measure.paper_text(), one.outcome.text(measure)]
    }));
    table::print(&lines);
    for one in judged {
        let size = if one.sizes.is_empty() { String::new() } else { format!(" (at {})", one.sizes) };
        say!("\n  {}{size}", one.claim.says);
        for (form, ruling) in one.rulings() {
            say!("  {form}: {}. {}", ruling.verdict.name(), ruling.sentence());
            ruling.found.iter().for_each(|line| say!("    - {line}"));
        }
    }
}

fn sum_up(results: &[ExhibitResult], ran: usize, all: usize, dir: Option<&Path>) {
    let [published, ours] = [Form::Published, Form::Ours].map(|form| VerdictCount::of(results, form));
    say!("\n{ran} of {all} rows run now\nas published: {published}\nours: {ours}");
    if let Some(dir) = dir {
        say!("{}", dir.join("index.html").display());
    }
}

/// Lists the exhibits, unless options ask for results of some.
fn list_if_asked(args: &ReproduceArgs) -> Result<(), Failure> {
    if args.output.is_some() || args.json.is_some() {
        let why = "reproduce: -o and --json need entries to run; name some, or use --all";
        return Err(Failure::Input(why.into()));
    }
    list();
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
                    Readiness::Partly(missing) => format!("partly ready; needs {}", missing.join(", ")),
                    Readiness::NotYet(missing) => format!("not ready: needs {}", missing.join(", ")),
                };
                vec![format!("  {}/{}", paper.id, exhibit.id), exhibit.shows.into(), state]
            })
            .collect();
        table::print(&rows);
        say!("");
    }
    say!(
        "`antumbra reproduce ID...` runs what is ready. Scene files are read from the folder in {SCENES_VARIABLE}: {SCENES_HINT}."
    );
}

fn choose(args: &ReproduceArgs) -> Result<Vec<Named>, Failure> {
    let known: Vec<Named> = exhibits().collect();
    if args.all || args.ids.iter().any(|id| is_all(id)) {
        return Ok(known);
    }
    let mut chosen: Vec<Named> = Vec::new();
    for id in &args.ids {
        let is_meant = |(name, paper, _): &&Named| name.eq_ignore_ascii_case(id) || paper.id.eq_ignore_ascii_case(id);
        let matching: Vec<_> = known.iter().filter(is_meant).cloned().collect();
        if matching.is_empty() {
            let names = known.iter().map(|(name, ..)| name.as_str()).chain(PAPERS.iter().map(|paper| paper.id));
            return Err(Failure::Input(format!(
                "reproduce: there is no entry `{id}`{}; `antumbra reproduce` lists them",
                did_you_mean(id, names)
            )));
        }
        // An exhibit that is named directly and by its paper runs once.
        for one in matching {
            if chosen.iter().all(|(name, ..)| *name != one.0) {
                chosen.push(one);
            }
        }
    }
    Ok(chosen)
}

fn as_json(result: &ExhibitResult) -> Value {
    let rows = result.rows.iter().map(|one| {
        let row = one.row;
        json!({
            "what": row.what, "scene": row.scene, "view": row.view, "technique": row.technique, "form": one.form.name(),
            "settings": row.settings_of(one.form).collect::<Vec<_>>(), "size": [row.size_px.0, row.size_px.1],
            "light_scale": row.light_scale, "frames_added_up": row.frames,
            "paper": reported(&row.measure), "here": one.outcome, "cut_short_s": one.cut_short_s,
        })
    });
    let claims = result.judged.iter().map(|one| {
        let ruled = |ruling: &Ruling| {
            json!({ "verdict": ruling.verdict.name(), "sentence": ruling.sentence(), "by": ruling.found })
        };
        json!({
            "says": one.claim.says, "sizes": one.sizes,
            "as_published": ruled(&one.published), "ours": one.ours.as_ref().map(ruled),
        })
    });
    json!({
        "id": result.name,
        "shows": result.exhibit.shows,
        "citation": result.paper.citation,
        "not_shown": result.exhibit.note,
        "rows": rows.collect::<Vec<_>>(),
        "claims": claims.collect::<Vec<_>>(),
    })
}

fn reported(measure: &Measure) -> Value {
    match measure {
        Measure::Fps { paper: Reported::Number(fps) } => json!({ "fps": fps }),
        _ => measure.paper_ms().map_or(Value::Null, |ms| json!({ "ms": ms })),
    }
}
