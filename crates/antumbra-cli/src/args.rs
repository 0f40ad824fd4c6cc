//! The command line, declared: what `--help` says is written here and nowhere else.

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

/// Real-time soft shadows, and the laboratory that tells which technique suits a scene.
#[derive(Debug, Parser)]
#[command(name = "antumbra", version, max_term_width = 110, disable_help_subcommand = true)]
#[command(after_help = "\
Start here:
  antumbra compare builtin:overlap -o out        every technique against the truth; open out/index.html
  antumbra advise scene.glb --budget 4ms         which technique, with what settings
  antumbra render scene.glb -o picture.png       a picture with soft shadows
  antumbra view scene.glb                        a window on a scene: move lights, try techniques
  antumbra techniques pcss                       what a technique's parameters do
  antumbra doctor                                what this machine can draw with

SCENE is a .glb or .gltf file, or builtin:NAME (`antumbra scenes` lists them).
Names of techniques, scenes, qualities and parameters are read in any case.
Exit codes: 0 done; 2 the arguments or an input file are wrong; 3 no usable adapter, or a feature is missing;
1 anything else; 130 interrupted. A file appears whole or not at all.")]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
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
}

/// What is seen of a scene.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Camera and lights (TOML); without it the scene's own, or, as a line says, a camera that frames it or stands inside
    /// and one light
    #[arg(long, value_name = "F.toml")]
    pub setup: Option<PathBuf>,
    /// The time at which animations are sampled, in seconds
    #[arg(long, value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub time: f32,
    /// Stands the scene on a ground, which casts where it can hide something; auto: where the camera frames an object
    /// that stands on nothing
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
}

/// When a ground is put under a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Ground {
    /// Where nothing says how the scene is looked at, and it stands on nothing.
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

/// How a scene is looked at.
#[derive(Debug, Args)]
pub struct ViewArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Width and height of the picture, in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    pub size: UVec2,
}

/// Which device draws.
#[derive(Debug, Args)]
pub struct AdapterArgs {
    /// Part of the name of the graphics adapter to use (`antumbra doctor` lists them); default: the fastest
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Renders a scene with soft shadows by one technique
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra render builtin:tree -o tree.png
  antumbra render scene.glb --setup evening.toml --technique multi_view --set samples=256 -o evening.png
  antumbra render scene.glb --technique pcss --set search_samples=32 --set samples=128 -o a.png --visibility a.exr

`antumbra techniques NAME` lists what --set takes. --visibility writes the plain mask, 1 lit to 0 umbra, as 32-bit float
OpenEXR with the channel V, before any tone curve. With several lights a.exr is the first one's and a.NAME.exr each other's;
--light NAME writes that one's alone. Pictures are PNG or JPEG, as their names say.")]
pub struct RenderArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    #[command(flatten)]
    pub view: ViewArgs,
    /// The shadow technique, and how much it may spend: pcss, pcss:fast; or a preset file: advice.toml
    #[arg(long, value_name = "NAME[:QUALITY]", default_value = "smrt", value_parser = values::technique)]
    pub technique: values::Technique,
    /// Sets a parameter of the technique; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Where to write the picture: .png or .jpg
    #[arg(short, long, value_name = "out.png")]
    pub output: PathBuf,
    /// Also writes the visibility mask (OpenEXR, 32-bit float, channel V)
    #[arg(long, value_name = "v.exr")]
    pub visibility: Option<PathBuf>,
    /// The one light that --visibility is of, by name; default: all of them
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Draws shadows up to so many metres from the camera; they fade over the last fifth
    #[arg(long, value_name = "METRES", value_parser = values::distance)]
    pub shadow_distance: Option<f32>,
    /// Shades coherently: smooth normals bend towards darkness where triangles face away from the light
    #[arg(long)]
    pub coherent: bool,
    /// Frames to draw, of which the last is written; techniques that accumulate converge
    #[arg(long, value_name = "N", default_value = "1", value_parser = values::frames)]
    pub frames: u32,
    /// Also writes the time of every pass in milliseconds (JSON)
    #[arg(long, value_name = "t.json")]
    pub timings: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Traces the truth: the visibility of every light, by rays, on the processor
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra reference builtin:overlap -o truth.png --visibility truth.exr
  antumbra reference scene.glb --samples 256 --size 640x360 -o quick.png

The visibility needs no graphics adapter; the shaded picture does. Without one, the picture shows the visibility itself.")]
pub struct ReferenceArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Light points per pixel; the truth has 32 x 32
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Seed of the light points
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u32,
    /// Where to write the picture: .png or .jpg
    #[arg(short, long, value_name = "ref.png")]
    pub output: PathBuf,
    /// Also writes the visibility (OpenEXR, 32-bit float; channel V, or V.R, V.G, V.B where occluders tint)
    #[arg(long, value_name = "v.exr")]
    pub visibility: Option<PathBuf>,
    /// The one light that --visibility is of, by name; default: all of them
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Opens a window on a scene: move camera and lights, try techniques, compare two of them
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra view
  antumbra view scene.glb --setup evening.toml
  antumbra view builtin:street --technique pcss --against vsm:fast --set map_size=2048
  antumbra view builtin:overlap --show error --screenshot error.png

Drag turns the camera, with shift or another button moves it, the wheel goes nearer, W A S D Q E fly, F shows all. Space plays an
animated scene, I tells of the pixel under the pointer. A scene or a setup that is dropped on the window is opened. What is on screen is saved as a setup that all other commands take.")]
pub struct WindowArgs {
    /// A .glb or .gltf file, or builtin:NAME; default: a built-in
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: Option<String>,
    /// Camera and lights (TOML); without it the scene's own, or a camera that frames it and a key light
    #[arg(long, value_name = "F.toml")]
    pub setup: Option<PathBuf>,
    /// The time at which an animated scene is shown at first, in seconds
    #[arg(long, value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub time: f32,
    /// Stands the scene on a ground, which casts where it can hide something; auto: where the camera frames an object
    /// that stands on nothing
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
    /// The shadow technique, and how much it may spend: pcss, pcss:fast; or a preset file: advice.toml
    #[arg(long, value_name = "NAME[:QUALITY]", default_value = "smrt", value_parser = values::technique)]
    pub technique: values::Technique,
    /// Another technique, at the right of a divider
    #[arg(long, value_name = "NAME[:QUALITY]", value_parser = values::technique)]
    pub against: Option<values::Technique>,
    /// Sets a parameter of one technique, or of each that has it; may be given several times
    #[arg(long = "set", value_name = "[NAME.]KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// What is shown at first
    #[arg(long, value_name = "VIEW", default_value = "shaded", ignore_case = true, value_parser = ["shaded", "visibility", "error", "truth", "map", "lists"])]
    pub show: String,
    /// Width and height of the window
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    pub size: UVec2,
    /// Writes a picture of the window once it stands still, and ends
    #[arg(long, value_name = "window.png")]
    pub screenshot: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Compares techniques with the truth: pictures, error maps, numbers and milliseconds in one page
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

DIR/index.html opens from disk; DIR/metrics.json holds the numbers. A technique may carry a quality: fast, balanced, high or
best; `all:fast` is all of them. `essm:paper` is as its paper prints it, and --preset is a paper's whole comparison. With
`+denoised` behind it (pcss:fast+denoised) its masks are made smooth over --frames frames. `--set NAME.KEY=VALUE` is for one
technique, `--set KEY=VALUE` for every chosen technique that
has the key.

--motion adds what techniques do while something moves: flicker, the rms of the mask's change from frame to frame less the
truth's own at the same pixels, and how many frames the mask lags once all stands still. One thing moves at a time, to the
camera's right, and stops where the scene and the setup have it. A frame's truth is traced with --samples light points, so that
long motions want small pictures.")]
pub struct CompareArgs {
    /// .glb or .gltf files, or builtin:NAME; with several, each gets a folder in DIR
    #[arg(value_name = "SCENE", required = true, value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// The techniques of a paper, each as printed there: lauritzen-2008, sintorn-2008, shen-2013, marrs-2014, selgrad-2014
    #[arg(long, value_name = "PAPER", conflicts_with = "techniques", value_parser = values::preset)]
    pub preset: Option<Preset>,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// The folder to write the report to
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The light that is judged and timed, by name; default: the first. All of them shine in the pictures
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Draws shadows up to so many metres from the camera; they fade over the last fifth. The truth has them all
    #[arg(long, value_name = "METRES", value_parser = values::distance)]
    pub shadow_distance: Option<f32>,
    /// Shades coherently: smooth normals bend towards darkness where triangles face away from the light
    #[arg(long)]
    pub coherent: bool,
    /// What techniques are held against: rays to the whole light, or, for those with a kernel of fixed width, exact
    /// filtering of their own map by that kernel
    #[arg(long, value_name = "traced|filtered", default_value = "traced", value_parser = values::truth)]
    pub truth: Truth,
    /// Light points per pixel of the traced truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Timed frames for each technique once it has warmed up, where they take no longer than 3 s; of short ones more, for a quarter of a
    /// second
    #[arg(long, value_name = "N", default_value = "5", value_parser = values::frames)]
    pub frames: u32,
    #[command(flatten)]
    pub motion: MotionArgs,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// What moves, and how.
#[derive(Debug, Args)]
pub struct MotionArgs {
    /// Also measures flicker and lag while these move, one after the other
    #[arg(long, value_name = "camera,light,caster|all", value_parser = values::motions)]
    pub motion: Option<values::Motions>,
    /// Frames in which each of them moves
    #[arg(long, value_name = "N", default_value = "16", requires = "motion", value_parser = values::motion_frames)]
    pub motion_frames: u32,
    /// How far they move in a frame, metres; a sun turns by the angle that this is at ten metres
    #[arg(long, value_name = "METRES", default_value = "0.15", requires = "motion", value_parser = values::step)]
    pub step: f32,
    /// The mesh that moves; default: the largest in the picture that is no ground and no wall
    #[arg(long, value_name = "NAME", requires = "motion")]
    pub caster: Option<String>,
    /// Setup files whose cameras the camera passes, in even times, before it comes to its own place
    #[arg(long, value_name = "F.toml,...", requires = "motion", value_delimiter = ',')]
    pub path: Vec<PathBuf>,
}

/// Finds the technique, and its settings, that errs least within a budget of time
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra advise scene.glb --budget 4ms -o advice
  antumbra advise scene.glb --setup evening.toml --budget 2ms --memory 64MiB -o advice
  antumbra advise scene.glb --setup hall.toml --setup yard.toml --time 0 --time 1.5 --budget 4ms -o advice
  antumbra advise builtin:tree --budget 4x --size 240x135 --techniques pcss,essm,multi_layer
  antumbra render scene.glb --technique advice/advice.toml -o picture.png

Searches the techniques' qualities and parameters as they are declared, on small pictures first, and says what to take, why, what
comes next, and what a step up costs. A budget is of one frame's shadows of one light: milliseconds on this adapter, or times what
pcf takes as it comes (4x). With several setups or times the answer holds for all: the slowest counts, and the errors' mean square.

DIR/index.html opens from disk; DIR/advice.toml is a preset that render, compare and view take wherever they take a technique.
DIR/measurements.json holds what was measured: the same line again goes on where it was stopped. See docs/advise.md.")]
pub struct AdviseArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    /// What a frame's shadows may take: milliseconds (4ms), or times what pcf takes (4x)
    #[arg(long, value_name = "4ms|4x", value_parser = values::budget)]
    pub budget: Budget,
    /// GPU memory that the technique may hold
    #[arg(long, value_name = "64MiB", value_parser = values::memory)]
    pub memory: Option<u64>,
    /// How rough the picture may be: visible artefacts, as `roughness` in metrics.json
    #[arg(long, value_name = "0.01", value_parser = values::roughness)]
    pub roughness: Option<f64>,
    /// Camera and lights (TOML); may be given several times
    #[arg(long = "setup", value_name = "F.toml")]
    pub setups: Vec<PathBuf>,
    /// The time at which animations are sampled, in seconds; may be given several times
    #[arg(long = "time", value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub times: Vec<f32>,
    /// Stands the scene on a ground, which casts where it can hide something; auto: where the camera frames an object
    /// that stands on nothing
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
    /// The light that is judged and timed, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Width and height of the pictures; default: 1280x720, or 480x270 on a software adapter
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<UVec2>,
    /// The techniques among which to choose, separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::kinds)]
    pub techniques: values::Kinds,
    /// What is to be small: the error of the picture as it stands, or with its flicker while the camera moves
    #[arg(long, value_name = "still|motion", default_value = "still", value_parser = values::prefer)]
    pub prefer: Prefer,
    /// Light points per pixel of the truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Measures every combination of a grid instead of searching: slow; what the search is held against
    #[arg(long)]
    pub exhaustive: bool,
    /// The folder for the page, the preset and the measurements; one of an earlier advice on the same view is gone on with
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Measures the time of every pass of every technique
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra bench
  antumbra bench builtin:street scene.glb --techniques pcss --sizes 1280x720,1920x1080 --frames 100 --json times.json
  antumbra bench scene.glb --setup evening.toml --light lamp --minutes 60

Prints the median over the frames, of how many, and after how many that warm up: programs are compiled then, and lists find their room.
The JSON also holds adapter, driver, commit and sizes. The minutes are dealt
out as it goes, each measurement an equal share of what is left; slow ones time fewer frames, and what there is no time for is
said to be skipped.

  antumbra bench --suite results.json --minutes 7
  antumbra bench --suite results.json --minutes 7 --parts times,growth
  antumbra bench --tables results.json > BENCHMARKS.md

--suite runs everything that BENCHMARKS.md shows, for so many minutes, into one file; the same line again goes on where it
stopped. --tables makes the page of it.")]
pub struct BenchArgs {
    /// Scenes: .glb or .gltf files, or builtin:NAME; default: overlap, knot and street
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The light that is measured, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Sizes of the picture, separated by commas; default: 1280x720, or 480x270 on a software adapter
    #[arg(long, value_name = "WxH,...", value_delimiter = ',', value_parser = values::size)]
    pub sizes: Vec<UVec2>,
    /// Timed frames for each technique, scene and size
    #[arg(long, value_name = "N", default_value = "20", value_parser = values::frames)]
    pub frames: u32,
    /// Frames before the timed ones, at least; one is always drawn, and more until two take about as long
    #[arg(long, value_name = "N", default_value = "3", value_parser = values::warm_up)]
    pub warm_up: u32,
    /// Within so many minutes it is over, but for the measurement that runs then
    #[arg(long, value_name = "N", default_value = "10", value_parser = values::minutes)]
    pub minutes: u32,
    /// Also writes everything as JSON
    #[arg(long, value_name = "out.json")]
    pub json: Option<PathBuf>,
    /// Runs what BENCHMARKS.md shows, as far as this file lacks it and the minutes last
    #[arg(long, value_name = "results.json", conflicts_with_all = NOT_OF_A_SUITE)]
    pub suite: Option<PathBuf>,
    /// Of the suite only these tables, separated by commas
    #[arg(long, value_name = "TABLE,...", value_delimiter = ',', requires = "suite", value_parser = values::suite_part)]
    pub parts: Vec<Part>,
    /// Prints such a file as BENCHMARKS.md
    #[arg(long, value_name = "results.json", conflicts_with_all = NOT_OF_A_SUITE, conflicts_with = "suite")]
    pub tables: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// What says what is measured, which a suite says itself.
const NOT_OF_A_SUITE: [&str; 11] =
    ["scenes", "setup", "time", "ground", "light", "techniques", "settings", "sizes", "frames", "warm_up", "json"];

/// Compares in parts, on one machine or many: many scenes, sizes and settings as independent jobs in files
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra sweep plan builtin:tree builtin:street --techniques pcf,pcss --vary map_size=512,1024,2048 -o sweep
  antumbra sweep run sweep --shard 1/4
  antumbra sweep merge sweep -o results.json

A shard runs those of its jobs that have no result yet, so that one that was stopped is started again by the same line. Errors are
those of `compare`, whatever the shards. docs/sweep.md has recipes for Slurm arrays, GNU parallel and Kubernetes' indexed jobs.")]
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

/// Writes the jobs: every scene at every size by every technique with every value that varies
#[derive(Debug, Args)]
pub struct SweepPlanArgs {
    /// .glb or .gltf files, as the shards will find them, or builtin:NAME
    #[arg(value_name = "SCENE", required = true, value_parser = values::scene)]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The light that is judged and timed, by name; default: the first
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    /// Techniques and preset files (advice.toml), separated by commas, or `all`
    #[arg(long, value_name = "a,b,c|all", default_value = "all", value_parser = values::techniques)]
    pub techniques: values::Techniques,
    /// Sets a parameter of one technique, or of every technique that has it; may be given several times
    #[arg(long = "set", value_name = "NAME.KEY=VALUE", value_parser = values::setting)]
    pub settings: Vec<Setting>,
    /// Runs a technique, or each that has the parameter, once with every value; may be given several times
    #[arg(long, value_name = "NAME.KEY=V,W,...", value_parser = values::setting)]
    pub vary: Vec<Setting>,
    /// Sizes of the picture, separated by commas
    #[arg(long, value_name = "WxH,...", default_value = "1280x720", value_delimiter = ',', value_parser = values::size)]
    pub sizes: Vec<UVec2>,
    /// Light points per pixel of the truth
    #[arg(long, value_name = "N", default_value = "1024", value_parser = values::samples)]
    pub samples: u32,
    /// Timed frames for each job once it has warmed up, as in `compare`
    #[arg(long, value_name = "N", default_value = "5", value_parser = values::frames)]
    pub frames: u32,
    /// The folder for the plan, and later for the results
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Runs the jobs of a plan, or a part of them
#[derive(Debug, Args)]
pub struct SweepRunArgs {
    /// A folder that `antumbra sweep plan` wrote
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Which part of how many: 1/4 to 4/4
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = values::shard)]
    pub shard: Shard,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Puts all results of a plan into one file
#[derive(Debug, Args)]
pub struct SweepMergeArgs {
    /// The sweep's folder, or its copies from several machines
    #[arg(value_name = "DIR", required = true)]
    pub dirs: Vec<PathBuf>,
    /// Where to write the results
    #[arg(short, long, value_name = "results.json")]
    pub output: PathBuf,
}

/// Lists the techniques: what each is for and where it fails; with a name, its parameters with units, ranges and defaults
#[derive(Debug, Args)]
#[command(after_help = techniques_help())]
pub struct TechniquesArgs {
    /// A technique
    #[arg(value_name = "NAME", value_parser = values::kind)]
    pub name: Option<TechniqueKind>,
}

/// Lists the built-in scenes, or writes one as glTF
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra scenes
  antumbra scenes --export knot?triangles=100000 -o knot.glb
  antumbra scenes --export overlap -o overlap.gltf")]
pub struct ScenesArgs {
    /// The built-in scene to write
    #[arg(long, value_name = "NAME", requires = "output")]
    pub export: Option<String>,
    /// Where to write it: .glb, or .gltf as text with its buffer inside
    #[arg(short, long, value_name = "x.glb", requires = "export")]
    pub output: Option<PathBuf>,
}

/// Lists adapters, features and limits, and what each technique lacks here
#[derive(Debug, Args)]
pub struct DoctorArgs {
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Lists the papers' tables and figures, runs them, and says for each of the papers' claims whether it holds here
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra reproduce                             every entry, and which can be run
  antumbra reproduce marrs-2014/figure1          that figure: the paper's numbers beside ours
  antumbra reproduce --all -o reproduced         everything, as a page for each paper; started again, it goes on
  antumbra reproduce selgrad-2014 -o reproduced --dear

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
    pub adapter: AdapterArgs,
}
