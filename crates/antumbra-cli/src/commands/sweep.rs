//! `antumbra sweep plan|run|merge`.

use antumbra_lab::output_files::{OutputDir, check_json_path};
use antumbra_lab::sweep::{Plan, PlannedScene, merge, run_shard};
use antumbra_lab::technique_run::TechniqueChoice;

use crate::args::{SweepArgs, SweepCommand, SweepMergeArgs, SweepPlanArgs, SweepRunArgs};
use crate::commands::{
    COMMIT, LoadedScene, choices, command_line, has_parameter, light_index, load_scene, narrowest, open_device, quoted,
    read_setting, why_unused, write_json,
};
use crate::failure::Failure;
use crate::progress::Bars;
use crate::stdout::say;
use crate::values::{Setting, Technique};

/// Plans a sweep, runs a shard, or merges results.
pub fn sweep(args: &SweepArgs, bars: &Bars) -> Result<(), Failure> {
    match &args.command {
        SweepCommand::Plan(args) => plan(args, bars),
        SweepCommand::Run(args) => run(args, bars),
        SweepCommand::Merge(args) => put_together(args),
    }
}

fn plan(args: &SweepPlanArgs, bars: &Bars) -> Result<(), Failure> {
    let mut chosen = choices(&args.techniques.0, &args.settings)?;
    for setting in &args.vary {
        chosen = varied(&args.techniques.0, chosen, setting)?;
    }
    let out = OutputDir::create(&args.output)?;
    let mut scenes = Vec::new();
    for spec in &args.scenes {
        let LoadedScene { scene, setup, anchor, has_ground } =
            load_scene(spec, &args.scene, narrowest(&args.sizes), bars)?;
        let light = light_index(&setup.lights, args.light.as_deref())?;
        scenes.push(PlannedScene::new(spec, args.scene.time, has_ground, &scene, &setup.relative_to(-anchor), light));
    }
    let plan = Plan::new(scenes, &args.sizes, &chosen, args.samples, args.frames, command_line(), COMMIT);
    plan.write(out.path())?;
    out.finish()?;
    let dir = quoted(&args.output.display().to_string());
    say!("Planned {} jobs in {dir}. To run all of them, or the first of four shards:", plan.jobs.len());
    say!("  antumbra sweep run {dir}\n  antumbra sweep run {dir} --shard 1/4");
    Ok(())
}

/// Multiplies each choice to which a setting applies by the setting's values.
fn varied(
    techniques: &[Technique],
    chosen: Vec<TechniqueChoice>,
    setting: &Setting,
) -> Result<Vec<TechniqueChoice>, Failure> {
    let is_meant = |choice: &TechniqueChoice| {
        let is_named = setting.technique.is_none_or(|(kind, quality)| {
            kind == choice.kind && quality.is_none_or(|quality| quality == choice.quality)
        });
        is_named && has_parameter(choice.kind, &setting.key)
    };
    if !chosen.iter().any(is_meant) {
        return Err(Failure::Input(why_unused(techniques, setting).replacen("--set", "--vary", 1)));
    }
    let mut all = Vec::new();
    for choice in chosen {
        if !is_meant(&choice) {
            all.push(choice);
            continue;
        }
        for value in setting.value.split(',').map(str::trim) {
            let mut one = choice.clone();
            one.settings.push(read_setting(choice.kind, &setting.key, value)?);
            all.push(one);
        }
    }
    Ok(all)
}

fn run(args: &SweepRunArgs, bars: &Bars) -> Result<(), Failure> {
    // Errors of the folder come before a device is opened.
    Plan::read(&args.dir)?;
    let lab = open_device(&args.adapter)?;
    let done = run_shard(&lab, &args.dir, args.shard, COMMIT, bars)?;
    say!("shard {}: {} jobs run, {} already had results", args.shard, done.ran, done.had);
    Ok(())
}

fn put_together(args: &SweepMergeArgs) -> Result<(), Failure> {
    check_json_path(&args.output)?;
    let merged = merge(&args.dirs)?;
    write_json(&args.output, &merged.json)?;
    say!("{} results, {} of them skipped: {}", merged.jobs, merged.skipped, args.output.display());
    Ok(())
}
