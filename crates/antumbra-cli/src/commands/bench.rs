//! `antumbra bench`.

use std::time::Duration;

use antumbra_lab::bench::{BenchOutcome, BenchRow, BenchScene, bench as measure};
use antumbra_lab::device::AdapterReport;
use antumbra_lab::output_files::check_writable;
use antumbra_lab::progress::Progress;
use antumbra_lab::technique_run::{Clock, Timing};
use antumbra_scene::{LoadOptions, Setup, load};
use serde_json::{Value, json};

use crate::args::BenchArgs;
use crate::commands::{COMMIT, choices, open_device, write_json};
use crate::failure::Failure;
use crate::progress::Bars;
use crate::stdout::say;
use crate::table;

/// What is measured unless scenes are given: few triangles, one dense closed mesh, many triangles in many layers.
const DEFAULT_SCENES: [&str; 3] = ["builtin:overlap", "builtin:knot", "builtin:street"];

/// However many frames are asked for, no technique takes longer than this on one scene and size.
const AT_MOST: Duration = Duration::from_secs(60);

/// Measures and prints; writes JSON where asked to.
pub fn bench(args: &BenchArgs, bars: &Bars) -> Result<(), Failure> {
    let choices = choices(&args.techniques.0, &args.settings)?;
    if let Some(path) = &args.json {
        check_writable(path)?;
    }
    let specs: Vec<String> =
        if args.scenes.is_empty() { DEFAULT_SCENES.map(str::to_owned).to_vec() } else { args.scenes.clone() };
    let mut scenes = Vec::new();
    for spec in specs {
        bars.begin(&format!("loading {spec}"), 0);
        let scene = load(&spec, &LoadOptions::default())?;
        let setup = Setup::for_scene(&scene);
        scenes.push(BenchScene { spec, scene, setup });
    }
    bars.end();
    let lab = open_device(&args.adapter)?;
    let timing = Timing { warm_up: args.warm_up, frames: args.frames, at_most: AT_MOST };
    let rows = measure(&lab, &scenes, &choices, &args.sizes, &timing, bars)?;
    if let Some(path) = &args.json {
        write_json(path, &as_json(&lab.adapter, &timing, &rows))?;
    }
    print(&lab.adapter, &rows);
    Ok(())
}

fn as_json(adapter: &AdapterReport, timing: &Timing, rows: &[BenchRow]) -> Value {
    json!({
        "antumbra": env!("CARGO_PKG_VERSION"),
        "commit": COMMIT,
        "adapter": adapter.name,
        "driver": format!("{} {}", adapter.driver, adapter.driver_info).trim(),
        "backend": adapter.backend.to_string(),
        "software": adapter.is_software(),
        "warm_up": timing.warm_up,
        "frames": timing.frames,
        "rows": rows,
    })
}

fn print(adapter: &AdapterReport, rows: &[BenchRow]) {
    say!("Adapter: {} ({}); medians in milliseconds\n", adapter.name, adapter.backend);
    let mut cells =
        vec![["SCENE", "SIZE", "TECHNIQUE", "MS", "CPU MS", "FRAMES", "MIB", "PASSES"].map(str::to_owned).to_vec()];
    cells.extend(rows.iter().map(|row| {
        let size = format!("{}x{}", row.size[0], row.size[1]);
        let begin = vec![row.scene.clone(), size, row.technique.to_owned()];
        let rest = match &row.outcome {
            BenchOutcome::Ran { timings, memory_bytes } => {
                let passes: Vec<_> =
                    timings.passes.iter().map(|pass| format!("{} {:.3}", pass.label, pass.ms)).collect();
                let passes = match timings.clock {
                    Clock::GpuTimestamps | Clock::SoftwareTimestamps => passes.join(", "),
                    Clock::SubmitToDone => "no timestamps here: from submission to completion".to_owned(),
                };
                let mib = *memory_bytes as f64 / f64::from(1 << 20);
                let [gpu, processor] = [timings.total_ms, timings.processor_ms].map(|ms| format!("{ms:.3}"));
                vec![gpu, processor, timings.frames.to_string(), format!("{mib:.1}"), passes]
            }
            BenchOutcome::Skipped(reason) => {
                vec!["–".to_owned(), "–".to_owned(), "–".to_owned(), "–".to_owned(), format!("skipped: {reason}")]
            }
        };
        begin.into_iter().chain(rest).collect()
    }));
    table::print(&cells);
}
