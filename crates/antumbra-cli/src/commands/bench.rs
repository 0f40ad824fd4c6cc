//! `antumbra bench`.

use std::path::Path;
use std::time::Duration;

use antumbra_lab::baseline::{Baseline, BaselineComparison, Source, of_bench};
use antumbra_lab::bench::{
    BenchOutcome, BenchRequest, BenchRow, BenchRows, BenchScene, Frames, bench as measure, file_json, rows_to_resume,
};
use antumbra_lab::device::{AdapterReport, LabDevice};
use antumbra_lab::error::LabError;
use antumbra_lab::identity::Identity;
use antumbra_lab::limits::Limits;
use antumbra_lab::output_files::check_json_path;
use antumbra_lab::progress::Progress;
use antumbra_lab::share::{SharedFile, check_scenes, markdown as cards_page, read_folder};
use antumbra_lab::suite::{Done, Plan, Results, markdown, run_slice};
use antumbra_lab::technique_run::{Clock, TechniqueChoice};
use glam::UVec2;
use serde_json::{Value, json};

use crate::args::BenchArgs;
use crate::commands::{COMMIT, LoadedScene, choices, light_index, load_scene, narrowest, open_device, put_json};
use crate::failure::{Failure, SavedResults};
use crate::keep;
use crate::progress::Bars;
use crate::stdout::say;
use crate::table;

/// Default scenes: few triangles, one dense closed mesh, many triangles in many layers.
const DEFAULT_SCENES: [&str; 3] = ["builtin:overlap", "builtin:knot", "builtin:street"];
/// Default scenes of a shared file: those measured on other cards.
const SHARED_SCENES: [&str; 2] = ["builtin:columns", "builtin:street"];

/// Default image sizes: of a window, of a shared file, and for a software adapter, where all techniques take minutes in total.
const DEFAULT_SIZE: UVec2 = UVec2::new(1280, 720);
const SHARED_SIZE: UVec2 = UVec2::new(1920, 1080);
const SOFTWARE_SIZE: UVec2 = UVec2::new(480, 270);

/// Default time limit without a deadline, minutes.
const DEFAULT_MINUTES: u32 = 10;

/// Measures and prints; writes JSON if requested.
pub fn bench(args: &BenchArgs, bars: &Bars) -> Result<(), Failure> {
    let limits = args.run.limits();
    if let Some(path) = &args.tables {
        say!("{}", markdown(&Results::read(path)?).trim_end());
        return Ok(());
    }
    if let Some(dir) = &args.cards {
        say!("{}", cards_page(&read_folder(dir)?).trim_end());
        return Ok(());
    }
    if let Some(path) = &args.suite {
        return suite(args, path, bars);
    }
    let choices = choices(&args.techniques.0, &args.settings)?;
    let baseline = check(args)?;
    let scenes = load(args, bars)?;
    let lab = open_device(&args.adapter)?;
    let run = Run { args, lab: &lab, scenes: &scenes, choices: &choices, sizes: sizes(args, &lab), baseline };
    let (rows, against) = run.measure(limits, bars)?;
    print(&lab.adapter, &rows.all());
    if let Some(against) = against {
        say!("\n{}\n", against.summary());
        table::print(&against.table());
    }
    match limits.deadline {
        Some(_) if !rows.missing.is_empty() => {
            let shared = args.share.as_deref().map_or(SavedResults::Nothing, SavedResults::NotResumable);
            let kept = args.json.as_deref().map_or(shared, SavedResults::Resumable);
            Err(Failure::incomplete(&rows.missing_names(), rows.all().len(), &kept))
        }
        _ => Ok(()),
    }
}

/// Validates the options before anything is loaded. Returns the baseline, if any.
fn check(args: &BenchArgs) -> Result<Option<Baseline>, Failure> {
    if args.run.resume && args.json.is_none() {
        return Err(Failure::Input("--resume: `bench` resumes the file given by --json; add --json times.json".into()));
    }
    for path in args.json.iter().chain(&args.share) {
        check_json_path(path)?;
    }
    if args.share.is_some() {
        check_scenes(&args.scenes)?;
    }
    Ok(args.run.baseline.as_deref().map(|path| Baseline::read(path, Source::Bench)).transpose()?)
}

fn load(args: &BenchArgs, bars: &Bars) -> Result<Vec<BenchScene>, Failure> {
    let default: &[&str] = if args.share.is_some() { &SHARED_SCENES } else { &DEFAULT_SCENES };
    let specs: Vec<String> = if args.scenes.is_empty() {
        default.iter().map(|scene| (*scene).to_owned()).collect()
    } else {
        args.scenes.clone()
    };
    let mut scenes = Vec::new();
    for spec in specs {
        let LoadedScene { scene, setup, .. } = load_scene(&spec, &args.scene, narrowest(&args.sizes), bars)?;
        let light = light_index(&setup.lights, args.light.as_deref())?;
        scenes.push(BenchScene { spec, scene, setup, light });
    }
    Ok(scenes)
}

fn sizes(args: &BenchArgs, lab: &LabDevice) -> Vec<UVec2> {
    match args.sizes.as_slice() {
        [] if lab.adapter.is_software() => vec![SOFTWARE_SIZE],
        [] if args.share.is_some() => vec![SHARED_SIZE],
        [] => vec![DEFAULT_SIZE],
        sizes => sizes.to_vec(),
    }
}

/// A run of measurements with its output.
struct Run<'a> {
    args: &'a BenchArgs,
    lab: &'a LabDevice,
    scenes: &'a [BenchScene],
    choices: &'a [TechniqueChoice],
    sizes: Vec<UVec2>,
    baseline: Option<Baseline>,
}

impl Run<'_> {
    fn measure(&self, limits: Limits, bars: &Bars) -> Result<(BenchRows, Option<BaselineComparison>), Failure> {
        let Self { args, lab, scenes, choices, ref sizes, ref baseline } = *self;
        let minutes = args.minutes.map(|minutes| Duration::from_secs(60 * u64::from(minutes)));
        let until = args.run.deadline;
        let default = until.unwrap_or(Duration::from_secs(60 * u64::from(DEFAULT_MINUTES)));
        let at_most = minutes.unwrap_or(default).min(until.unwrap_or(Duration::MAX));
        bars.note(&plan(scenes, choices.len(), sizes, at_most, &lab.adapter.name));
        let frames = Frames { warm_up: args.warm_up, timed: args.frames };
        let identity = Identity::new(lab, COMMIT, &self.settings());
        let earlier = match &args.json {
            Some(path) if args.run.resume => rows_to_resume(path, &identity)?,
            _ => Vec::new(),
        };
        let request = BenchRequest { scenes, choices, sizes_px: sizes, frames, at_most, limits };
        let write = |json: &Value, rows: &BenchRows| -> Result<(), LabError> {
            if let Some(path) = &args.json {
                put_json(path, json)?;
                keep(path);
            }
            if let Some(path) = &args.share {
                put_json(path, &json!(SharedFile::new(lab, COMMIT, frames, rows)))?;
            }
            Ok(())
        };
        let file = |rows: &BenchRows, is_over| file_json(&identity, &lab.adapter, frames, rows, is_over);
        let rows = measure(lab, &request, earlier, &mut |rows| write(&file(rows, false), rows), bars)?;
        let mut json = file(&rows, true);
        let against = baseline.as_ref().map(|baseline| baseline.against(&of_bench(&rows.rows)));
        if let Some(against) = &against {
            json["baseline"] = json!(against);
        }
        write(&json, &rows)?;
        Ok((rows, against))
    }

    /// Settings that a resumed file must match, besides program and adapter.
    fn settings(&self) -> Value {
        let scene = |scene: &BenchScene| {
            json!({
                "scene": scene.spec,
                "triangles": scene.scene.triangle_count(),
                "setup": scene.setup.to_toml(),
                "light": scene.setup.lights[scene.light].name,
            })
        };
        json!({
            "scenes": self.scenes.iter().map(scene).collect::<Vec<_>>(),
            "time": self.args.scene.time.to_string(),
            "sizes": self.sizes.iter().map(|size| size.to_array()).collect::<Vec<_>>(),
            "techniques": self.choices.iter().map(|one| format!("{}{}", one.name(), one.as_arguments())).collect::<Vec<_>>(),
            "warm_up": self.args.warm_up,
            "frames": self.args.frames,
        })
    }
}

/// Measures a time slice of the suite.
fn suite(args: &BenchArgs, path: &Path, bars: &Bars) -> Result<(), Failure> {
    check_json_path(path)?;
    let lab = open_device(&args.adapter)?;
    let at_most = Duration::from_secs(60 * u64::from(args.minutes.unwrap_or(DEFAULT_MINUTES)));
    let plan = if args.parts.is_empty() { Plan::whole() } else { Plan::whole().only(&args.parts) };
    let Done { jobs, of } = run_slice(&lab, &plan, path, COMMIT, at_most, bars)?;
    let again = if jobs < of {
        "run the same command again to continue"
    } else {
        "print the page with `antumbra bench --tables`"
    };
    say!("{jobs} of {of} measurements are done, in {}; {again}", path.display());
    Ok(())
}

/// Describes the planned measurements and their duration in one line.
fn plan(scenes: &[BenchScene], techniques: usize, sizes: &[UVec2], at_most: Duration, adapter: &str) -> String {
    let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let sizes_text: Vec<_> = sizes.iter().map(|size| format!("{}x{}", size.x, size.y)).collect();
    let seconds = at_most.as_secs_f64();
    let each_s = seconds / (scenes.len() * techniques * sizes.len()) as f64;
    let within = if seconds % 60.0 == 0.0 { counted(seconds as usize / 60, "minute") } else { format!("{seconds} s") };
    format!(
        "{} on {} at {} on {adapter}: takes at most {within}, on average up to {each_s:.0} s per measurement",
        counted(techniques, "technique"),
        counted(scenes.len(), "scene"),
        sizes_text.join(", "),
    )
}

const HEADING: [&str; 11] = [
    "SCENE",
    "SIZE",
    "TECHNIQUE",
    "MEDIAN MS",
    "MEDIAN CPU MS",
    "TIMED FRAMES",
    "WARM-UP FRAMES",
    "COMPILE MS",
    "FIRST FRAME MS",
    "MIB",
    "PASSES",
];

fn print(adapter: &AdapterReport, rows: &[BenchRow]) {
    say!("Adapter: {} ({})\n", adapter.name, adapter.backend);
    let mut cells = vec![HEADING.map(str::to_owned).to_vec()];
    cells.extend(rows.iter().map(|row| {
        let size = format!("{}x{}", row.size[0], row.size[1]);
        let begin = vec![row.scene.clone(), size, row.technique.to_owned()];
        begin.into_iter().chain(figures(row)).collect()
    }));
    table::print(&cells);
}

/// Returns a row's cells after the technique's name.
fn figures(row: &BenchRow) -> Vec<String> {
    let none = || "–".to_owned();
    let (timings, memory_bytes, start_up) = match &row.outcome {
        BenchOutcome::Ran { timings, memory_bytes, start_up, .. } => (timings, *memory_bytes, *start_up),
        BenchOutcome::Skipped(reason) => {
            let last = format!("skipped: {reason}");
            return std::iter::repeat_with(none).take(HEADING.len() - 4).chain([last]).collect();
        }
    };
    let passes: Vec<_> = timings.passes.iter().map(|pass| format!("{} {:.3}", pass.label, pass.ms)).collect();
    let mut passes = match timings.clock {
        Clock::GpuTimestamps | Clock::SoftwareTimestamps => passes.join(", "),
        Clock::SubmitToDone => "no timestamps on this adapter: measured from submission to completion".to_owned(),
    };
    if let Some(limit_s) = row.cut_short_s {
        passes += &format!(" (cut short by the limit of {limit_s} s per technique)");
    }
    let [compile, first] = [start_up.map(|start| start.compile_ms), start_up.map(|start| start.first_frame_ms)]
        .map(|ms| ms.map_or_else(none, |ms| format!("{ms:.1}")));
    let mib = memory_bytes as f64 / f64::from(1 << 20);
    let [gpu, processor] = [timings.total_ms, timings.processor_ms].map(|ms| format!("{ms:.3}"));
    let [frames, warm_up] = [timings.frames, timings.warm_up].map(|count| count.to_string());
    vec![gpu, processor, frames, warm_up, compile, first, format!("{mib:.1}"), passes]
}
