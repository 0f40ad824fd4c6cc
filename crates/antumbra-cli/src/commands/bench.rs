//! `antumbra bench`.

use std::path::Path;
use std::time::Duration;

use antumbra_lab::bench::{BenchOutcome, BenchRow, BenchScene, Frames, bench as measure};
use antumbra_lab::device::AdapterReport;
use antumbra_lab::output_files::check_json_path;
use antumbra_lab::progress::Progress;
use antumbra_lab::suite::{Done, Plan, Results, markdown, run_slice};
use antumbra_lab::technique_run::Clock;
use glam::UVec2;
use serde_json::{Value, json};

use crate::args::BenchArgs;
use crate::commands::{COMMIT, LoadedScene, choices, light_index, load_scene, narrowest, open_device, write_json};
use crate::failure::Failure;
use crate::progress::Bars;
use crate::stdout::say;
use crate::table;

/// What is measured unless scenes are given: few triangles, one dense closed mesh, many triangles in many layers.
const DEFAULT_SCENES: [&str; 3] = ["builtin:overlap", "builtin:knot", "builtin:street"];

/// The size where none is given: a size of window, or on a software adapter one that all techniques draw in minutes.
const DEFAULT_SIZE: UVec2 = UVec2::new(1280, 720);
const SOFTWARE_SIZE: UVec2 = UVec2::new(480, 270);

/// Measures and prints; writes JSON where asked to.
pub fn bench(args: &BenchArgs, bars: &Bars) -> Result<(), Failure> {
    if let Some(path) = &args.tables {
        say!("{}", markdown(&Results::read(path)?).trim_end());
        return Ok(());
    }
    if let Some(path) = &args.suite {
        return suite(args, path, bars);
    }
    let choices = choices(&args.techniques.0, &args.settings)?;
    if let Some(path) = &args.json {
        check_json_path(path)?;
    }
    let specs: Vec<String> =
        if args.scenes.is_empty() { DEFAULT_SCENES.map(str::to_owned).to_vec() } else { args.scenes.clone() };
    let mut scenes = Vec::new();
    for spec in specs {
        let LoadedScene { scene, setup, .. } = load_scene(&spec, &args.scene, narrowest(&args.sizes), bars)?;
        let light = light_index(&setup.lights, args.light.as_deref())?;
        scenes.push(BenchScene { spec, scene, setup, light });
    }
    let lab = open_device(&args.adapter)?;
    let default_size = if lab.adapter.is_software() { SOFTWARE_SIZE } else { DEFAULT_SIZE };
    let sizes = if args.sizes.is_empty() { vec![default_size] } else { args.sizes.clone() };
    bars.note(&plan(&scenes, choices.len(), &sizes, args.minutes, &lab.adapter.name));
    let frames = Frames { warm_up: args.warm_up, timed: args.frames };
    let at_most = Duration::from_secs(60 * u64::from(args.minutes));
    let rows = measure(&lab, &scenes, &choices, &sizes, frames, at_most, bars)?;
    if let Some(path) = &args.json {
        write_json(path, &as_json(&lab.adapter, frames, &rows))?;
    }
    print(&lab.adapter, &rows);
    Ok(())
}

/// A slice of the suite.
fn suite(args: &BenchArgs, path: &Path, bars: &Bars) -> Result<(), Failure> {
    check_json_path(path)?;
    let lab = open_device(&args.adapter)?;
    let at_most = Duration::from_secs(60 * u64::from(args.minutes));
    let plan = if args.parts.is_empty() { Plan::whole() } else { Plan::whole().only(&args.parts) };
    let Done { jobs, of } = run_slice(&lab, &plan, path, COMMIT, at_most, bars)?;
    let again = if jobs < of { "the same line again goes on" } else { "`antumbra bench --tables` makes the page" };
    say!("{jobs} of {of} measurements are in {}; {again}", path.display());
    Ok(())
}

/// What will be measured and how long that takes, in a line.
fn plan(scenes: &[BenchScene], techniques: usize, sizes: &[UVec2], minutes: u32, adapter: &str) -> String {
    let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let sizes_text: Vec<_> = sizes.iter().map(|size| format!("{}x{}", size.x, size.y)).collect();
    let each_s = 60.0 * f64::from(minutes) / (scenes.len() * techniques * sizes.len()) as f64;
    format!(
        "{} of {} at {} on {adapter}: done within {}, up to {each_s:.0} s for each and more where others take less",
        counted(techniques, "technique"),
        counted(scenes.len(), "scene"),
        sizes_text.join(", "),
        counted(minutes as usize, "minute"),
    )
}

fn as_json(adapter: &AdapterReport, frames: Frames, rows: &[BenchRow]) -> Value {
    json!({
        "antumbra": env!("CARGO_PKG_VERSION"),
        "commit": COMMIT,
        "adapter": adapter.name,
        "driver": adapter.driver_and_version(),
        "backend": adapter.backend.to_string(),
        "software": adapter.is_software(),
        "warm_up": frames.warm_up,
        "frames": frames.timed,
        "rows": rows,
    })
}

fn print(adapter: &AdapterReport, rows: &[BenchRow]) {
    say!("Adapter: {} ({})\n", adapter.name, adapter.backend);
    let heading =
        ["SCENE", "SIZE", "TECHNIQUE", "MEDIAN MS", "MEDIAN CPU MS", "TIMED FRAMES", "WARM-UP FRAMES", "MIB", "PASSES"];
    let mut cells = vec![heading.map(str::to_owned).to_vec()];
    cells.extend(rows.iter().map(|row| {
        let size = format!("{}x{}", row.size[0], row.size[1]);
        let begin = vec![row.scene.clone(), size, row.technique.to_owned()];
        let rest = match &row.outcome {
            BenchOutcome::Ran { timings, memory_bytes, .. } => {
                let passes: Vec<_> =
                    timings.passes.iter().map(|pass| format!("{} {:.3}", pass.label, pass.ms)).collect();
                let passes = match timings.clock {
                    Clock::GpuTimestamps | Clock::SoftwareTimestamps => passes.join(", "),
                    Clock::SubmitToDone => "no timestamps here: from submission to completion".to_owned(),
                };
                let mib = *memory_bytes as f64 / f64::from(1 << 20);
                let [gpu, processor] = [timings.total_ms, timings.processor_ms].map(|ms| format!("{ms:.3}"));
                let [frames, warm_up] = [timings.frames, timings.warm_up].map(|count| count.to_string());
                vec![gpu, processor, frames, warm_up, format!("{mib:.1}"), passes]
            }
            BenchOutcome::Skipped(reason) => {
                std::iter::repeat_n("–".to_owned(), 5).chain([format!("skipped: {reason}")]).collect()
            }
        };
        begin.into_iter().chain(rest).collect()
    }));
    table::print(&cells);
}
