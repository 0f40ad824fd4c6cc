//! `antumbra advise`.

use std::path::Path;

use antumbra_lab::advise::{
    Advice, AdviseRequest, AdviseView, Candidate, Limits, MEASUREMENTS_NAME, Prefer, advise as ask,
};
use antumbra_lab::report::write_advice;
use antumbra_scene::Setup;
use glam::UVec2;

use crate::args::{AdviseArgs, SceneArgs, ViewArgs};
use crate::commands::{
    COMMIT, LoadedScene, check_folder, command_line, light_index, load_scene, make_folder, narrowest, open_device,
    quoted, scene_arguments,
};
use crate::failure::Failure;
use crate::progress::Bars;
use crate::stdout::say;
use crate::table;

/// Runs the search, writes its results, and prints the recommendation.
pub fn advise(args: &AdviseArgs, bars: &Bars) -> Result<(), Failure> {
    // Checks come before the long search.
    if let Some(dir) = &args.output {
        check_folder(dir, MEASUREMENTS_NAME, "no measurements of `advise`")?;
    }
    let (scenes, views) = load(args, bars)?;
    let lab = open_device(&args.adapter)?;
    if let Some(dir) = &args.output {
        make_folder(dir)?;
    }
    let size_px =
        args.size.unwrap_or(if lab.adapter.is_software() { UVec2::new(480, 270) } else { UVec2::new(1280, 720) });
    let first = SceneArgs { setup: args.setups.first().cloned(), time: args.times[0], ground: args.ground };
    let request = AdviseRequest {
        spec: &args.scene,
        scenes,
        views,
        size_px,
        samples: args.samples,
        kinds: &args.techniques.0,
        budget: args.budget,
        limits: Limits { memory_bytes: args.memory, roughness: args.roughness },
        prefer: args.prefer,
        exhaustive: args.exhaustive,
        command: command_line(),
        scene_arguments: scene_arguments(&args.scene, &ViewArgs { scene: first, size: size_px }),
        commit: COMMIT,
    };
    let advice = ask(&lab, &request, args.output.as_deref(), bars)?;
    let preset = args.output.as_deref().map(|dir| write_advice(dir, &advice)).transpose()?;
    print(&advice);
    print_use(&advice, &request.scene_arguments, preset.as_deref());
    Ok(())
}

/// Loads the scene at every time, and combines it with every setup.
fn load(args: &AdviseArgs, bars: &Bars) -> Result<(Vec<antumbra_scene::Scene>, Vec<AdviseView>), Failure> {
    let (mut scenes, mut views) = (Vec::new(), Vec::new());
    let sizes: Vec<UVec2> = args.size.into_iter().collect();
    for time in &args.times {
        let setup = args.setups.first().cloned();
        let LoadedScene { scene, setup: own, anchor, .. } =
            load_scene(&args.scene, &SceneArgs { setup, time: *time, ground: args.ground }, narrowest(&sizes), bars)?;
        let mut setups = vec![(args.setups.first().map_or("this view".into(), |path| path.display().to_string()), own)];
        for path in args.setups.iter().skip(1) {
            setups.push((path.display().to_string(), Setup::from_file(path)?.relative_to(anchor)));
        }
        for (name, setup) in setups {
            let light = light_index(&setup.lights, args.light.as_deref())?;
            let name = if args.times.len() > 1 { format!("{name} at {time} s") } else { name };
            views.push(AdviseView { name, scene: scenes.len(), setup, light });
        }
        scenes.push(scene);
    }
    Ok((scenes, views))
}

fn print(advice: &Advice) {
    print_facts(advice);
    print_best(advice);
    print_others(advice);
    print_step_up(advice);
    let spent = &advice.spent;
    let left_out = if spent.left_out > 0 { format!(", {} skipped as too slow", spent.left_out) } else { String::new() };
    say!("Measured: {} configurations in {:.1} s{left_out}.", spent.measurements, spent.seconds);
}

/// Prints the scene, the budget, and facts about each view.
fn print_facts(advice: &Advice) {
    let times = |values: &[f64]| values.iter().map(|ms| format!("{ms:.2}")).collect::<Vec<_>>().join(", ");
    let [width, height] = advice.size;
    let pcf =
        if advice.pcf_ms.is_empty() { String::new() } else { format!(" (pcf takes {} ms)", times(&advice.pcf_ms)) };
    say!(
        "\n{}, {width}x{height}, on {}; budget {} ms{pcf}",
        advice.scene,
        advice.adapter.name,
        times(&advice.budget_ms)
    );
    for (view, facts) in advice.views.iter().zip(&advice.facts) {
        if advice.views.len() > 1 {
            say!("  {view}:");
        }
        facts.lines().iter().for_each(|line| say!("  {line}"));
    }
}

fn print_best(advice: &Advice) {
    let best = &advice.best;
    let [low, high] = best.worst_spread_ms();
    let verb = if advice.keeps_budget { "Take" } else { "Nearest:" };
    say!(
        "\n{verb} {}: rmse {:.4}, roughness {:.4}, {:.2} ms ({low:.2} to {high:.2}), {:.2} times the budget, {:.1} MiB",
        best.name,
        best.rmse,
        best.roughness,
        best.worst_ms(),
        best.load,
        mib(best)
    );
    let of_view =
        if advice.views.len() > 1 { format!(" for {}", advice.views[best.heaviest_view]) } else { String::new() };
    say!("  (time: {}{of_view})", best.counted());
    advice.reasons.iter().for_each(|reason| say!("  - {reason}"));
}

/// Prints the next best configurations and the next step up as a table, if there are any.
fn print_others(advice: &Advice) {
    let mut rows = vec![
        ["NEXT BEST", "RMSE", "ROUGHNESS", "MS", "TIMED FRAMES", "MS / BUDGET", "MIB"].map(str::to_owned).to_vec(),
    ];
    if advice.prefer == Prefer::Motion {
        rows[0].push("FLICKER".into());
    }
    for one in advice.runners_up.iter().chain(&advice.next_step) {
        let mut row = vec![
            one.name.clone(),
            format!("{:.4}", one.rmse),
            format!("{:.4}", one.roughness),
            format!("{:.2}", one.worst_ms()),
            one.counted_briefly(),
            format!("{:.2}", one.load),
            format!("{:.1}", mib(one)),
        ];
        if advice.prefer == Prefer::Motion {
            row.push(one.flicker.map_or_else(|| "–".to_owned(), |flicker| format!("{flicker:.4}")));
        }
        rows.push(row);
    }
    if rows.len() > 1 {
        say!("");
        table::print(&rows);
    }
}

fn print_step_up(advice: &Advice) {
    match &advice.next_step {
        Some(step) => say!(
            "\nHigher quality: {} has an error of {:.4}, {:.0} % less, and takes {:.2} ms, {:.2} times the budget.",
            step.name,
            step.rmse,
            100.0 * (1.0 - step.rmse / advice.best.rmse),
            step.worst_ms(),
            step.load
        ),
        None => say!("\nNo slower configuration that was measured has clearly less error."),
    }
}

fn mib(one: &Candidate) -> f64 {
    one.memory_bytes as f64 / f64::from(1 << 20)
}

/// Prints the command and the Rust code that use the recommendation.
fn print_use(advice: &Advice, scene_arguments: &str, preset: Option<&Path>) {
    let config = &advice.best.config;
    let chosen = preset
        .map_or_else(|| config.arguments(), |preset| format!("--technique {}", quoted(&preset.display().to_string())));
    say!("\nUse it:\n  antumbra render {scene_arguments} {chosen} -o picture.png");
    say!("\n  let mut shadow = TechniqueKind::{:?}.create(&gpu)?;", config.kind);
    for (key, value) in &config.settings {
        say!("  shadow.set({key:?}, {value:?})?;");
    }
    if let Some(dir) = preset.and_then(Path::parent) {
        say!("\n{}", dir.join("index.html").display());
    }
}
