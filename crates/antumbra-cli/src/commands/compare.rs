//! `antumbra compare`.

mod baseline;

use std::path::Path;
use std::time::Duration;

use antumbra_lab::compare::{CompareRequest, compare as compare_scene};
use antumbra_lab::device::LabDevice;
use antumbra_lab::error::LabError;
use antumbra_lab::limits::Pace;
use antumbra_lab::motion::{Motion, MotionOptions};
use antumbra_lab::output_files::{FileError, OutputDir};
use antumbra_lab::progress::Progress;
use antumbra_lab::report::{
    IndexEntry, MotionInfo, Outcome, Report, ReportWriter, report_paths, report_to_resume, write_index,
};
use antumbra_lab::technique_run::{FrameCount, TechniqueChoice, Timing};
use antumbra_scene::{Setup, builtin};

use crate::args::{CompareArgs, MotionArgs};
use crate::commands::{
    COMMIT, LoadedScene, choices, command_line, end_shadows, light_index, load_scene, narrowest, open_device,
    scene_arguments,
};
use crate::failure::{Failure, SavedResults};
use crate::keep;
use crate::progress::Bars;
use crate::stdout::say;
use crate::table;
use crate::values::{Motions, techniques_of};
use baseline::{BaselineFile, baselines, check_view};

/// Maximum time for measuring a technique, even if more frames are requested: on a software adapter a frame of many views takes seconds.
const AT_MOST: Duration = Duration::from_secs(3);
/// Minimum time for measuring a technique, even if fewer frames are requested, so that short disturbances do not change the median.
const AT_LEAST: Duration = Duration::from_millis(250);

/// Runs the comparison, writes the reports, and prints the results.
pub fn compare(args: &CompareArgs, bars: &Bars) -> Result<(), Failure> {
    let mut pace = Pace::new(args.run.limits());
    let techniques = args.preset.map_or_else(|| args.techniques.0.clone(), |preset| techniques_of(&preset));
    let choices = choices(&techniques, &args.settings)?;
    let motion = motion_options(&args.motion, args.shadow_distance)?;
    let folders = folders_for(&args.scenes);
    let baselines = baselines(args, &folders)?;
    // Checks come before the long work.
    let out = if args.run.resume { OutputDir::resume(&args.output) } else { OutputDir::create(&args.output) }?;
    let lab = open_device(&args.adapter)?;
    let mut expected = expected_files(&choices, motion.as_ref(), &folders);
    let mut site = Site { args, choices: &choices, motion: motion.as_ref(), lab: &lab, out, pace: &mut pace };
    let (mut entries, mut missing): (Vec<IndexEntry>, Vec<String>) = Default::default();
    for ((scene, folder), baseline) in args.scenes.iter().zip(&folders).zip(&baselines) {
        let report = match site.report_on(scene, folder, baseline.as_ref(), &mut expected, bars) {
            Ok(report) => report,
            Err(Unfinished::Deadline) => {
                bars.end();
                missing.extend(choices.iter().map(|choice| named(folder, &choice.name())));
                continue;
            }
            Err(Unfinished::Failed(failure)) => return Err(failure),
        };
        missing.extend(report.missing.iter().map(|name| named(folder, name)));
        entries.push(IndexEntry::of(folder, &report));
        print(&report);
    }
    let Site { out, .. } = site;
    if entries.is_empty() {
        return Err(Failure::incomplete(&missing, missing.len(), &SavedResults::Nothing));
    }
    if args.scenes.len() > 1 {
        write_index(out.path(), &entries)?;
    }
    let dir = out.finish()?;
    say!("{}", dir.join("index.html").display());
    let motions = motion.as_ref().map_or(0, |options| options.motions.len());
    let planned = args.scenes.len() * choices.len() * (1 + motions);
    if missing.is_empty() {
        Ok(())
    } else {
        Err(Failure::incomplete(&missing, planned, &SavedResults::Resumable(&args.output)))
    }
}

/// Name of a missing result, prefixed by its folder if there are several.
fn named(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}, {name}") }
}

/// Returns a subfolder of the report for each scene; the report's own folder for a single scene.
fn folders_for(scenes: &[String]) -> Vec<String> {
    if scenes.len() == 1 {
        return vec![String::new()];
    }
    let mut folders = Vec::new();
    for scene in scenes {
        folders.push(folder_for(scene, &folders));
    }
    folders
}

/// Returns all files of the report, relative to its folder.
fn expected_files(choices: &[TechniqueChoice], motion: Option<&MotionOptions>, folders: &[String]) -> Vec<String> {
    let techniques: Vec<String> = choices.iter().map(TechniqueChoice::name).collect();
    let motions = motion.map_or(&[][..], |options| &options.motions);
    let of_report = report_paths(&techniques, motions);
    let below = |folder: &String| -> Vec<String> {
        let path = |path: &String| if folder.is_empty() { path.clone() } else { format!("{folder}/{path}") };
        of_report.iter().map(path).collect()
    };
    let index = ["index.html", "summary.md"].map(str::to_owned);
    folders.iter().flat_map(below).chain(index).collect()
}

/// Reason why a scene has no report.
enum Unfinished {
    /// The deadline came before its ground truth was traced.
    Deadline,
    Failed(Failure),
}

impl From<LabError> for Unfinished {
    fn from(error: LabError) -> Self {
        if error.is_deadline() { Self::Deadline } else { Self::Failed(error.into()) }
    }
}

impl From<Failure> for Unfinished {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

impl From<FileError> for Unfinished {
    fn from(error: FileError) -> Self {
        Self::Failed(error.into())
    }
}

/// Data that the scenes share.
struct Site<'a> {
    args: &'a CompareArgs,
    choices: &'a [TechniqueChoice],
    motion: Option<&'a MotionOptions>,
    lab: &'a LabDevice,
    out: OutputDir,
    pace: &'a mut Pace,
}

impl Site<'_> {
    /// Runs the comparison on one scene and writes its report, which grows with every technique.
    fn report_on(
        &mut self,
        scene: &str,
        folder: &str,
        baseline: Option<&BaselineFile>,
        expected: &mut Vec<String>,
        bars: &Bars,
    ) -> Result<Report, Unfinished> {
        let Self { args, choices, lab, .. } = *self;
        let LoadedScene { scene: loaded, mut setup, anchor, .. } =
            load_scene(scene, &args.view.scene, narrowest(&[args.view.size]), bars)?;
        end_shadows(&mut setup.camera, args.shadow_distance);
        let light = light_index(&setup.lights, args.light.as_deref())?;
        let motion = self.motion.cloned().map(|options| MotionOptions {
            path: options.path.iter().map(|camera| camera.relative_to(anchor)).collect(),
            ..options
        });
        let request = CompareRequest {
            spec: scene,
            scene: &loaded,
            setup: &setup,
            anchor,
            light,
            size_px: args.view.size,
            choices,
            truth: args.truth,
            samples: args.samples,
            timing: Timing { warm_up: 1, frames: args.frames, at_least: AT_LEAST, at_most: AT_MOST, end: None },
            motion: motion.as_ref(),
            command: command_line(),
            scene_arguments: arguments_of(args, scene),
            coherent: args.coherent,
            commit: COMMIT,
        };
        if let Some(BaselineFile { path, baseline }) = baseline {
            check_view(path, baseline, &request)?;
        }
        let identity = request.identity(lab);
        let dir = self.out.path().join(folder);
        let earlier = if args.run.resume { report_to_resume(&dir, &identity)? } else { None };
        let mut writer = earlier.as_ref().map(|earlier| ReportWriter::resuming(&dir, earlier));
        let Self { out, pace, .. } = self;
        let mut each = |report: &Report| -> Result<(), LabError> {
            let dir = out.path().join(folder);
            std::fs::create_dir_all(&dir).map_err(|error| FileError::from_write(&dir, &error))?;
            let writer = writer.get_or_insert_with(|| ReportWriter::new(&dir));
            writer.write(report)?;
            // An earlier report stays until this one has content.
            if !expected.is_empty() {
                out.place_now(std::mem::take(expected))?;
                writer.moved_to(&out.path().join(folder));
            }
            keep(&args.output);
            Ok(())
        };
        let mut report = compare_scene(lab, &request, earlier, pace, &mut each, bars)?;
        report.baseline = baseline.map(|file| file.baseline.against(&report.figures()));
        if let Some(mut writer) = writer {
            writer.finish(&report)?;
        }
        Ok(report)
    }
}

/// Arguments that define view, shading and shadow distance.
fn arguments_of(args: &CompareArgs, scene: &str) -> String {
    let distance = args.shadow_distance.map_or(String::new(), |metres| format!(" --shadow-distance {metres}"));
    scene_arguments(scene, &args.view) + &distance + if args.coherent { " --coherent" } else { "" }
}

/// Returns the motions to measure, with the cameras of the path; `None` without motion.
fn motion_options(args: &MotionArgs, shadow_distance_m: Option<f32>) -> Result<Option<MotionOptions>, Failure> {
    let Some(Motions(motions)) = &args.motion else { return Ok(None) };
    let needs = |option: &str, motion: Motion| {
        let name = motion.name();
        Err(Failure::Input(format!("{option} needs the motion `{name}`; add `{name}` to --motion")))
    };
    if args.caster.is_some() && !motions.contains(&Motion::Caster) {
        return needs("--caster", Motion::Caster);
    }
    if !args.path.is_empty() && !motions.contains(&Motion::Camera) {
        return needs("--path", Motion::Camera);
    }
    let mut path =
        args.path.iter().map(|file| Ok(Setup::from_file(file)?.camera)).collect::<Result<Vec<_>, Failure>>()?;
    path.iter_mut().for_each(|camera| end_shadows(camera, shadow_distance_m));
    Ok(Some(MotionOptions {
        motions: motions.clone(),
        frames: args.motion_frames,
        step_m: args.step,
        caster: args.caster.clone(),
        path,
    }))
}

/// Returns a scene's folder name: the scene's name, with a number if that is taken.
fn folder_for(scene: &str, taken: &[String]) -> String {
    let bare = builtin::spec_of(scene).unwrap_or(scene);
    let stem = Path::new(bare).file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let name: String = stem.chars().map(plain).collect();
    // File systems may ignore case.
    let is_taken = |name: &str| taken.iter().any(|folder| folder.eq_ignore_ascii_case(name));
    let is_free = |name: &str| !name.is_empty() && !is_taken(name);
    if is_free(&name) {
        return name;
    }
    (2..).map(|n| format!("{name}-{n}")).find(|name| is_free(name)).unwrap_or(name)
}

fn print(report: &Report) {
    let info = &report.reference.info;
    let rate = info.rays_per_second().map_or_else(String::new, |rate| format!(", {:.1} M rays/s", rate * 1e-6));
    say!(
        "\n{}: {} triangles; ground truth: {} light samples per pixel, {:.1} s{rate}; {}\n",
        report.scene.name,
        report.scene.triangles,
        info.samples,
        info.seconds,
        report.adapter.name
    );
    if let Some(facts) = &report.facts {
        facts.lines().iter().for_each(|line| say!("  {line}"));
        say!("");
    }
    let heading = [
        "TECHNIQUE",
        "RMSE",
        "PENUMBRA RMSE",
        "UMBRA LEAK",
        "LIT LOSS",
        "ROUGHNESS",
        "WORST TILE",
        "SSIM",
        "FLIP",
        "MEDIAN MS",
        "TIMED FRAMES",
        "WARM-UP FRAMES",
        "MIB",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    // Names are numbered as in the report, because a preset may list a technique twice.
    rows.extend(report.rows.iter().zip(report.names()).map(|(row, name)| {
        let figures = match &row.outcome {
            Outcome::Measured(measured) => {
                let m = &measured.metrics;
                let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"));
                let mib = measured.memory_bytes.map(|bytes| format!("{:.1}", bytes as f64 / f64::from(1 << 20)));
                let errors =
                    [m.rmse, m.penumbra_rmse, m.umbra_leak, m.lit_loss, m.roughness, m.worst_tile, m.ssim, m.flip];
                let errors = errors.map(number);
                let ms = measured.total_ms.map(|ms| format!("{ms:.2}"));
                let FrameCount { frames, warm_up } = measured.count;
                let [frames, warm_up] = [frames, warm_up].map(|count| measured.total_ms.map(|_| count.to_string()));
                let cost = [ms, frames, warm_up, mib].map(|text| text.unwrap_or_else(|| "–".to_owned()));
                errors.into_iter().chain(cost).collect()
            }
            Outcome::Skipped(reason) => vec![format!("skipped: {reason}")],
        };
        std::iter::once(name).chain(figures).collect()
    }));
    table::print(&rows);
    if let Some(info) = &report.motion {
        print_motion(report, info);
    }
    if let Some(against) = &report.baseline {
        say!("\n{}\n", against.summary());
        table::print(&against.table());
    }
}

fn print_motion(report: &Report, info: &MotionInfo) {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"));
    say!(
        "\nMotion, {} frames of {} m each: flicker, its ratio to the truth's change, and lag in frames:\n",
        info.frames,
        info.step_m
    );
    let mut heading = vec!["TECHNIQUE".to_owned()];
    let mut truth_row = vec!["(truth's change)".to_owned()];
    for truth in &info.truths {
        heading.extend([truth.motion.name().to_uppercase(), "RATIO".into(), "LAG".into()]);
        truth_row.extend([number(truth.change), String::new(), String::new()]);
    }
    let mut rows = vec![heading, truth_row];
    for row in &report.rows {
        let Outcome::Measured(measured) = &row.outcome else { continue };
        let mut cells = vec![row.technique.clone()];
        for truth in &info.truths {
            let figures = measured.motions.iter().find(|figures| figures.motion == truth.motion);
            cells.extend(figures.map_or_else(
                || vec!["–".to_owned(); 3],
                |figures| {
                    let ratio = figures.ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{ratio:.2}"));
                    let lag = figures.lag_frames.map_or_else(|| "–".to_owned(), |frames| frames.to_string());
                    vec![number(figures.flicker), ratio, lag]
                },
            ));
        }
        rows.push(cells);
    }
    table::print(&rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_plain_and_unique() {
        let mut taken = Vec::new();
        for (scene, expected) in [
            ("builtin:overlap", "overlap"),
            ("dir/overlap.glb", "overlap-2"),
            ("builtin:knot?triangles=10&a=b", "knot-triangles-10-a-b"),
            ("..", "-2"),
        ] {
            let folder = folder_for(scene, &taken);
            assert_eq!(folder, expected);
            taken.push(folder);
        }
    }
}
