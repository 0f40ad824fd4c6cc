//! Declaration of the command line. All texts of `--help` are here.

mod run;

use std::path::PathBuf;

use antumbra::TechniqueKind;
use antumbra_lab::advise::{Budget, Prefer};
use antumbra_lab::compare::Truth;
use antumbra_lab::reproduce::Preset;
use antumbra_lab::suite::Part;
use antumbra_lab::sweep::Shard;
use clap::{Args, Parser, Subcommand};
use glam::UVec2;

use crate::technique_text::techniques_help;
use crate::values::{self, Setting};

pub use run::RunArgs;

/// Version, and the commit that the program was built from.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (commit ", env!("ANTUMBRA_COMMIT"), ")");

/// Renders soft shadows by many techniques, and compares them with ray-traced ground truth
#[derive(Debug, Parser)]
#[command(name = "antumbra", version = VERSION, max_term_width = 110, disable_help_subcommand = true)]
#[command(after_help = "\
Start here:
  antumbra compare builtin:overlap -o out        compares techniques with ground truth
  antumbra advise scene.glb --budget 4ms         recommends a technique and its settings
  antumbra render scene.glb -o picture.png       renders an image with soft shadows
  antumbra view scene.glb                        opens a window: move lights, try techniques
  antumbra techniques pcss                       explains a technique's parameters
  antumbra doctor                                lists adapters and what techniques need

SCENE is a .glb or .gltf file, or builtin:NAME (`antumbra scenes` lists them). Names are not case-sensitive.

Exit codes: 0 success; 2 wrong arguments or input file; 3 no usable adapter or feature; 4 the deadline came before the end; 130 interrupted; \
1 anything else. Output files appear complete or not at all.")]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    /// No progress and no notes: results and errors alone
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Render(RenderArgs),
    Reference(ReferenceArgs),
    View(WindowArgs),
    Compare(CompareArgs),
    Advise(AdviseArgs),
    Bench(BenchArgs),
    Sweep(SweepArgs),
    Techniques(TechniquesArgs),
    Scenes(ScenesArgs),
    Doctor(DoctorArgs),
    Reproduce(ReproduceArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Camera, lights and time of a scene.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Setup file with camera and lights (TOML); default: the scene's own, or assumed ones, which are printed
    #[arg(long, value_name = "F.toml")]
    pub setup: Option<PathBuf>,
    /// Time at which animations are sampled, in seconds
    #[arg(long, value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub time: f32,
    /// Adds a ground below the scene; auto: if the scene is an object that stands on nothing
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
}

/// When a ground is added below a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Ground {
    /// If there is no setup file or camera, and the scene stands on nothing.
    #[default]
    Auto,
    Yes,
    No,
}

impl Ground {
    /// As the scenes have it.
    pub fn when(self) -> antumbra_scene::Ground {
        match self {
            Self::Auto => antumbra_scene::Ground::Auto,
            Self::Yes => antumbra_scene::Ground::Yes,
            Self::No => antumbra_scene::Ground::No,
        }
    }
}

/// What the shading of a light is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum ShadingFactor {
    /// The part of the irradiance that arrives, where the technique has it; else visibility
    #[default]
    Ratio,
    /// Visibility
    Product,
}

/// View of a scene.
#[derive(Debug, Args)]
pub struct ViewArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width and height of the image, in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    pub size: UVec2,
}

/// Choice of adapter.
#[derive(Debug, Args)]
pub struct AdapterArgs {
    /// Graphics adapter, by a part of its name (`antumbra doctor` lists them); default: the fastest
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Renders an image with soft shadows by one technique
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra render builtin:tree -o tree.png
  antumbra render scene.glb --setup evening.toml --technique multi_view --set samples=256 -o evening.png
  antumbra render scene.glb --technique pcss --set search_samples=32 --set samples=128 -o a.png --visibility a.exr

`antumbra techniques NAME` lists the parameters for --set.

--visibility writes the mask as 32-bit float OpenEXR, channel V, 1 lit to 0 umbra. With several lights a.exr is the first one's and a.NAME.exr \
each other's; --light NAME writes only that one's.")]
pub struct RenderArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Technique, with a quality if you like: pcss, pcss:fast; or a preset file: advice.toml
    #[arg(long, value_name = "NAME[:QUALITY]", default_value = "smrt", value_parser = values::technique)]
    pub technique: values::Technique,
    /// Sets a parameter of the technique; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Image to write: .png or .jpg
    #[arg(short, long, value_name = "out.png")]
    pub output: PathBuf,
    /// Also writes the visibility mask (OpenEXR, 32-bit float, channel V)
    #[arg(long, value_name = "v.exr")]
    pub visibility: Option<PathBuf>,
    /// Light that --visibility writes, by name; default: all
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Draws shadows only up to this distance from the camera; they fade over its last fifth
    #[arg(long, value_name = "METRES", value_parser = values::distance)]
    pub shadow_distance: Option<f32>,
    /// Bends smooth normals so that shading ends where triangles face away from the light
    #[arg(long)]
    pub coherent: bool,
    /// Factor of a light's shading: the part of its irradiance that arrives, where the technique has it (weights=irradiance), or visibility
    #[arg(long, value_name = "BY", value_enum, ignore_case = true, default_value = "ratio")]
    pub shading: ShadingFactor,
    /// Number of frames to draw; the last is written. Techniques that accumulate converge
    #[arg(long, value_name = "N", default_value = "1", value_parser = values::frames)]
    pub frames: u32,
    /// Also writes the time of every pass, in milliseconds (JSON)
    #[arg(long, value_name = "t.json")]
    pub timings: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Traces ground truth on the CPU: the visibility of every light
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra reference builtin:overlap -o truth.png --visibility truth.exr
  antumbra reference scene.glb --samples 256 --size 640x360 -o quick.png

Visibility needs no graphics adapter; the shaded image does. Without an adapter, the image shows the visibility.")]
pub struct ReferenceArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Light samples per pixel
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Seed of the light samples
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u32,
    /// Image to write: .png or .jpg
    #[arg(short, long, value_name = "ref.png")]
    pub output: PathBuf,
    /// Also writes the visibility (OpenEXR, 32-bit float; channel V, or V.R, V.G, V.B where occluders tint)
    #[arg(long, value_name = "v.exr")]
    pub visibility: Option<PathBuf>,
    /// Light that --visibility writes, by name; default: all
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Opens a window: move camera and lights, try techniques, compare two of them
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra view
  antumbra view scene.glb --setup evening.toml
  antumbra view builtin:street --technique pcss --against vsm:fast --set map_size=2048
  antumbra view builtin:overlap --show error --screenshot error.png

Controls: drag turns the camera, Shift-drag moves it, the wheel goes nearer, W A S D Q E fly, F shows the whole scene, Space plays animations, \
I inspects the pixel under the pointer. Drop a scene or a setup on the window to open it. Save the view as a setup for the other commands.")]
pub struct WindowArgs {
    /// A .glb or .gltf file, or builtin:NAME; default: a built-in scene
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: Option<String>,
    /// Setup file with camera and lights (TOML); default: the scene's own, or assumed ones
    #[arg(long, value_name = "F.toml")]
    pub setup: Option<PathBuf>,
    /// Initial time of an animated scene, in seconds
    #[arg(long, value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub time: f32,
    /// Adds a ground below the scene; auto: if the scene is an object that stands on nothing
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
    /// Technique, with a quality if you like: pcss, pcss:fast; or a preset file: advice.toml
    #[arg(long, value_name = "NAME[:QUALITY]", default_value = "smrt", value_parser = values::technique)]
    pub technique: values::Technique,
    /// Second technique, to the right of a divider
    #[arg(long, value_name = "NAME[:QUALITY]", value_parser = values::technique)]
    pub against: Option<values::Technique>,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "[NAME.]KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Initial view
    #[arg(long, value_name = "VIEW", default_value = "shaded", ignore_case = true, value_parser = ["shaded", "visibility", "error", "truth", "map", "lists"])]
    pub show: String,
    /// Width and height of the window
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    pub size: UVec2,
    /// Writes an image of the window once everything is loaded and traced, and exits
    #[arg(long, value_name = "window.png")]
    pub screenshot: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Compares techniques with ground truth: images, error maps, numbers and times on one page
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra compare builtin:overlap -o out
  antumbra compare scene.glb --setup evening.toml --techniques pcss,multi_view --size 640x360 -o out
  antumbra compare builtin:street --techniques pcf,pcss:fast,pcss,pcss:high -o out
  antumbra compare builtin:leaning-plank --preset shen-2013 -o out
  antumbra compare builtin:tree --set pcss.samples=128 --set map_size=2048 -o out
  antumbra compare builtin:overlap --techniques vsm,lvsm,evsm --set kernel_size=15 --truth filtered -o out
  antumbra compare builtin:lantern-wall --motion all --size 320x180 -o out
  antumbra compare scene.glb --setup end.toml --motion camera --path start.toml,corner.toml -o out

  antumbra compare builtin:street --deadline 60 --technique-limit 10 --resume -o out
  antumbra compare builtin:street --baseline other/metrics.json -o out

Open DIR/index.html; DIR/metrics.json has the numbers. Both are written as they are made: if the command is stopped, DIR keeps what was measured, and \
--resume continues it. --baseline is the metrics.json of another run, or, of several scenes, its folder.

A technique may have a quality: fast, balanced, high or best; `all:fast` is every technique at fast. `essm:paper` is as its paper publishes it; --preset is a \
paper's whole comparison. With `+half` masks are drawn at half the width and height and interpolated; with `+denoised` (pcss:fast+denoised) they are denoised over --frames frames. `--set NAME.KEY=VALUE` sets a parameter of one \
technique, `--set KEY=VALUE` of every technique that has it.

--motion measures what happens while one thing moves, to the camera's right, until it is where the scene and the setup place it: flicker, the rms of \
the mask's change from frame to frame minus the truth's, and the number of frames that the mask lags after everything has stopped. Each frame is \
traced, so use small images.")]
pub struct CompareArgs {
    /// .glb or .gltf files, or builtin:NAME; several scenes get a folder each in DIR
    #[arg(value_name = "SCENE", required = true, value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Techniques of a paper, each as published there: lauritzen-2008, sintorn-2008, shen-2013, marrs-2014, selgrad-2014
    #[arg(long, value_name = "PAPER", conflicts_with = "techniques", value_parser = values::preset)]
    pub preset: Option<Preset>,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Folder for the report
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Light to compare and time, by name; default: the first. Images show all lights
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Draws shadows only up to this distance from the camera; the ground truth has no limit
    #[arg(long, value_name = "METRES", value_parser = values::distance)]
    pub shadow_distance: Option<f32>,
    /// Bends smooth normals so that shading ends where triangles face away from the light
    #[arg(long)]
    pub coherent: bool,
    /// Ground truth: traced rays, or, for techniques with a kernel of fixed width, exact filtering of their own shadow map by
    /// that kernel
    #[arg(long, value_name = "traced|filtered", default_value = "traced", value_parser = values::truth)]
    pub truth: Truth,
    /// Light samples per pixel of the traced ground truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Number of timed frames for each technique after warm-up: fewer if they take more than 3 s, more if they are short
    #[arg(long, value_name = "N", default_value = "5", value_parser = values::frames)]
    pub frames: u32,
    #[command(flatten)]
    pub motion: MotionArgs,
    #[command(flatten)]
    pub run: RunArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Motion to measure.
#[derive(Debug, Args)]
pub struct MotionArgs {
    /// Also measures flicker and lag while these move, one after the other
    #[arg(long, value_name = "camera,light,caster|all", value_parser = values::motions)]
    pub motion: Option<values::Motions>,
    /// Number of frames in which each moves
    #[arg(long, value_name = "N", default_value = "16", requires = "motion", value_parser = values::motion_frames)]
    pub motion_frames: u32,
    /// Distance per frame, in metres; a sun turns by the angle of this distance at ten metres
    #[arg(long, value_name = "METRES", default_value = "0.15", requires = "motion", value_parser = values::step)]
    pub step: f32,
    /// Mesh that moves; default: the largest visible one that is neither ground nor wall
    #[arg(long, value_name = "NAME", requires = "motion")]
    pub caster: Option<String>,
    /// Setup files whose cameras the camera passes at equal intervals on its way
    #[arg(long, value_name = "F.toml,...", requires = "motion", value_delimiter = ',')]
    pub path: Vec<PathBuf>,
}

/// Recommends the technique and settings with the least error within a time budget
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra advise scene.glb --budget 4ms -o advice
  antumbra advise scene.glb --setup evening.toml --budget 2ms --memory 64MiB -o advice
  antumbra advise scene.glb --setup hall.toml --setup yard.toml --time 0 --time 1.5 --budget 4ms -o advice
  antumbra advise builtin:tree --budget 4x --size 240x135 --techniques pcss,essm,multi_layer
  antumbra render scene.glb --technique advice/advice.toml -o picture.png

Searches techniques, qualities and parameters, on small images first, and prints what to take, why, the next best, and what more quality costs. The \
budget is for one frame's shadows of one light: in milliseconds on this adapter, or in multiples of the time of pcf at its defaults (4x). With \
several setups or times, one answer holds for all: the slowest view must keep the budget, and the mean square error is minimised.

Open DIR/index.html. DIR/advice.toml is a preset for render, compare and view. DIR/measurements.json has all measurements: run the same line again to \
continue. See docs/advise.md.")]
pub struct AdviseArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    /// Time for one frame's shadows: milliseconds (4ms), or multiples of the time of pcf (4x)
    #[arg(long, value_name = "4ms|4x", value_parser = values::budget)]
    pub budget: Budget,
    /// Limit of the technique's GPU memory
    #[arg(long, value_name = "64MiB", value_parser = values::memory)]
    pub memory: Option<u64>,
    /// Limit of visible artefacts, as `roughness` in metrics.json
    #[arg(long, value_name = "0.01", value_parser = values::roughness)]
    pub roughness: Option<f64>,
    /// Setup file with camera and lights (TOML); may be given several times
    #[arg(long = "setup", value_name = "F.toml")]
    pub setups: Vec<PathBuf>,
    /// Time at which animations are sampled, in seconds; may be given several times
    #[arg(long = "time", value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub times: Vec<f32>,
    /// Adds a ground below the scene; auto: if the scene is an object that stands on nothing
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
    /// Light to compare and time, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Width and height of the images; default: 1280x720, or 480x270 on a software adapter
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<UVec2>,
    /// Techniques to choose from, separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::kinds)]
    pub techniques: values::Kinds,
    /// What to minimise: the error of still images, or that and flicker while the camera moves
    #[arg(long, value_name = "still|motion", default_value = "still", value_parser = values::prefer)]
    pub prefer: Prefer,
    /// Light samples per pixel of the ground truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Measures every combination of a grid instead of searching: slow, for checking the search
    #[arg(long)]
    pub exhaustive: bool,
    /// Folder for the page, the preset and the measurements; an earlier search on the same view is resumed
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Measures the time of every pass
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra bench
  antumbra bench builtin:street scene.glb --techniques pcss --sizes 1280x720,1920x1080 --frames 100 --json times.json
  antumbra bench scene.glb --setup evening.toml --light lamp --minutes 60

  antumbra bench builtin:street --deadline 60 --json times.json --resume
  antumbra bench builtin:street --baseline other.json
  antumbra bench --share card.json

Prints medians, with the number of timed frames and of warm-up frames, in which pipelines are compiled and lists grow. --minutes is shared equally \
among the measurements: slow ones time fewer frames, and those without time are reported as skipped. The JSON also has adapter, driver and commit; \
it is written as it grows, and --resume continues it.

--share measures columns and street at 1920x1080, unless scenes and sizes are named, and writes one file for bench/cards: what the device says of \
itself, versions, and times; no paths and no names. --cards prints the page of all such files.

  antumbra bench --suite results.json --minutes 7
  antumbra bench --suite results.json --minutes 7 --parts times,growth
  antumbra bench --tables results.json > BENCHMARKS.md

--suite measures everything in BENCHMARKS.md, for --minutes, into one file; run the same line again to continue. --tables prints the page.")]
pub struct BenchArgs {
    /// Scenes: .glb or .gltf files, or builtin:NAME; default: overlap, knot and street
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Light to measure, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Image sizes, separated by commas; default: 1280x720, or 480x270 on a software adapter
    #[arg(long, value_name = "WxH,...", value_delimiter = ',', value_parser = values::size)]
    pub sizes: Vec<UVec2>,
    /// Number of timed frames for each technique, scene and size
    #[arg(long, value_name = "N", default_value = "20", value_parser = values::frames)]
    pub frames: u32,
    /// Minimum number of warm-up frames; at least one is drawn, and more until two take about as long
    #[arg(long, value_name = "N", default_value = "3", value_parser = values::warm_up)]
    pub warm_up: u32,
    /// Time limit in minutes; the measurement that runs then is finished. Default: 10, or until --deadline
    #[arg(long, value_name = "N", value_parser = values::minutes)]
    pub minutes: Option<u32>,
    /// Also writes everything as JSON
    #[arg(long, value_name = "out.json")]
    pub json: Option<PathBuf>,
    /// Also writes one file that can be sent: adapter, driver, versions and times, of built-in scenes
    #[arg(long, value_name = "card.json", conflicts_with_all = ["setup", "light"])]
    pub share: Option<PathBuf>,
    /// Measures what BENCHMARKS.md shows and this file lacks, within --minutes
    #[arg(long, value_name = "results.json", conflicts_with_all = NOT_OF_A_SUITE)]
    pub suite: Option<PathBuf>,
    /// Only these tables of the suite, separated by commas
    #[arg(long, value_name = "TABLE,...", value_delimiter = ',', requires = "suite", value_parser = values::suite_part)]
    pub parts: Vec<Part>,
    /// Prints the results file of a suite as a page
    #[arg(long, value_name = "results.json", conflicts_with_all = NOT_OF_A_SUITE, conflicts_with = "suite")]
    pub tables: Option<PathBuf>,
    /// Prints a folder of shared results as a page
    #[arg(long, value_name = "DIR", conflicts_with_all = NOT_OF_A_SUITE, conflicts_with_all = ["suite", "tables"])]
    pub cards: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Options that choose what is measured, which a suite does itself.
const NOT_OF_A_SUITE: [&str; 16] = [
    "scenes",
    "setup",
    "time",
    "ground",
    "light",
    "techniques",
    "settings",
    "sizes",
    "frames",
    "warm_up",
    "json",
    "share",
    "deadline",
    "technique_limit",
    "resume",
    "baseline",
];

/// Runs many comparisons as independent jobs, on one machine or many
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra sweep plan builtin:tree builtin:street --techniques pcf,pcss --vary map_size=512,1024,2048 -o sweep
  antumbra sweep run sweep --shard 1/4
  antumbra sweep merge sweep -o results.json

A shard runs those of its jobs that have no result yet: if it was stopped, run the same line again. Errors equal those of `compare`. \
docs/sweep.md has recipes for Slurm, GNU parallel and Kubernetes.")]
pub struct SweepArgs {
    #[command(subcommand)]
    pub command: SweepCommand,
}

#[derive(Debug, Subcommand)]
pub enum SweepCommand {
    Plan(SweepPlanArgs),
    Run(SweepRunArgs),
    Merge(SweepMergeArgs),
}

/// Writes the plan: every scene at every size with every technique and every value of --vary
#[derive(Debug, Args)]
pub struct SweepPlanArgs {
    /// .glb or .gltf files, at paths that the shards can read, or builtin:NAME
    #[arg(value_name = "SCENE", required = true, value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Light to compare and time, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Runs a technique, or every technique that has the parameter, with each value; may be given several times
    #[arg(long, value_name = "NAME.KEY=V,W,...", value_parser = values::setting)]
    pub vary: Vec<Setting>,
    /// Image sizes, separated by commas
    #[arg(long, value_name = "WxH,...", default_value = "1280x720", value_delimiter = ',', value_parser = values::size)]
    pub sizes: Vec<UVec2>,
    /// Light samples per pixel of the ground truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Number of timed frames for each job after warm-up, as in `compare`
    #[arg(long, value_name = "N", default_value = "5", value_parser = values::frames)]
    pub frames: u32,
    /// Folder for the plan and its results
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Runs a shard of a plan
#[derive(Debug, Args)]
pub struct SweepRunArgs {
    /// Folder written by `antumbra sweep plan`
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Shard, and number of shards: 1/4 to 4/4
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = values::shard)]
    pub shard: Shard,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Collects all results of a plan in one file
#[derive(Debug, Args)]
pub struct SweepMergeArgs {
    /// Folder of the sweep, or its copies from several machines
    #[arg(value_name = "DIR", required = true)]
    pub dirs: Vec<PathBuf>,
    /// File for the results
    #[arg(short, long, value_name = "results.json")]
    pub output: PathBuf,
}

/// Lists techniques, their uses and failures; with a name, its parameters with units, ranges and defaults
#[derive(Debug, Args)]
#[command(after_help = techniques_help())]
pub struct TechniquesArgs {
    /// A technique
    #[arg(value_name = "NAME", value_parser = values::kind)]
    pub name: Option<TechniqueKind>,
    /// Prints JSON: every technique, or the named one, with parameters and qualities
    #[arg(long)]
    pub json: bool,
}

/// Lists the built-in scenes, or writes one as glTF
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra scenes
  antumbra scenes --export knot?triangles=100000 -o knot.glb
  antumbra scenes --export overlap -o overlap.gltf")]
pub struct ScenesArgs {
    /// Built-in scene to write
    #[arg(long, value_name = "NAME", requires = "output")]
    pub export: Option<String>,
    /// File to write: .glb, or .gltf with its buffer inside
    #[arg(short, long, value_name = "x.glb", requires = "export")]
    pub output: Option<PathBuf>,
    /// Prints the list as JSON
    #[arg(long, conflicts_with = "export")]
    pub json: bool,
}

/// Lists adapters, features and limits, and what each technique needs that is missing
#[derive(Debug, Args)]
pub struct DoctorArgs {
    #[command(flatten)]
    pub adapter: AdapterArgs,
    /// Prints JSON
    #[arg(long)]
    pub json: bool,
}

/// Prints completions for a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra completions bash > ~/.local/share/bash-completion/completions/antumbra
  antumbra completions zsh > \"${fpath[1]}/_antumbra\"
  antumbra completions fish > ~/.config/fish/completions/antumbra.fish")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL", value_enum, ignore_case = true)]
    pub shell: clap_complete::Shell,
}

/// Writes manual pages, one for each command
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra man -o ~/.local/share/man/man1        then: man antumbra-compare")]
pub struct ManArgs {
    /// Folder to write to; it is created where it does not exist
    #[arg(short, long, value_name = "man1")]
    pub output: PathBuf,
}

/// Lists the papers' tables and figures, runs them, and says for each of the papers' claims whether it holds here
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra reproduce                             every entry, and which can be run
  antumbra reproduce marrs-2014/figure1          that figure: the paper's numbers beside ours
  antumbra reproduce --all -o reproduced         everything, as a page for each paper; started again, it goes on
  antumbra reproduce selgrad-2014 -o reproduced --dear
  antumbra reproduce --all --deadline 300 --technique-limit 20

Scenes that are files lie in the folder that the environment variable ANTUMBRA_SCENES names; rows whose scene is not
there are not ready.")]
pub struct ReproduceArgs {
    /// Entries such as marrs-2014/figure1, papers such as marrs-2014, or `all`; none lists them
    #[arg(value_name = "ID")]
    pub ids: Vec<String>,
    /// Everything; goes into the folder `reproduced` unless -o says otherwise
    #[arg(long, conflicts_with = "ids")]
    pub all: bool,
    /// A folder for pages with pictures, verdicts and numbers; what it holds from an earlier run of the same commit on the
    /// same adapter is not run again
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Timed frames for each measurement, where they take no longer than 20 s (2 s on a software renderer)
    #[arg(long, value_name = "N", default_value = "10", value_parser = values::frames)]
    pub frames: u32,
    /// Another size of picture than the paper's, for a quick look; on a software renderer all have some 37 000 pixels
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<UVec2>,
    /// Light points a pixel of the truth: 1024, or 256 on a software renderer
    #[arg(long, value_name = "N", value_parser = values::samples)]
    pub samples: Option<u32>,
    /// Also runs what takes a software renderer too long
    #[arg(long)]
    pub dear: bool,
    /// This adapter's memory bandwidth, GB/s: times are then compared at equal bandwidth too
    #[arg(long, value_name = "GB/S", value_parser = values::bandwidth)]
    pub bandwidth: Option<f64>,
    /// Also writes everything that is run as JSON
    #[arg(long, value_name = "out.json")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}
