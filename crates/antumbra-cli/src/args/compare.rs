//! Options of `compare`, and of the motion that it measures.

use std::path::PathBuf;

use antumbra_lab::compare::Truth;
use antumbra_lab::reproduce::Preset;
use clap::Args;

use super::common::{AdapterArgs, ViewArgs};
use super::run::RunArgs;
use crate::values::{self, Setting};

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

Open DIR/index.html; DIR/metrics.json has the numbers. Results are written while the command runs: if it is stopped, DIR keeps them, \
and --resume continues. --baseline takes the metrics.json of another run or, for several scenes, its folder.

A technique may have a quality: fast, balanced, high or best; `all:fast` is every technique at fast. `essm:paper` is the technique as \
published; --preset selects all techniques of a paper's comparison. With `+half` masks are drawn at half the width and height and \
interpolated; with `+denoised` (pcss:fast+denoised) they are denoised over --frames frames. `--set NAME.KEY=VALUE` sets a parameter of \
one technique, `--set KEY=VALUE` of every technique that has it.

--motion moves one thing to the camera's right, so that it ends where the scene and the setup place it, and measures flicker (rms of \
the mask's change from frame to frame minus the truth's) and lag (the number of frames until the mask is settled after the stop). Each \
frame is traced, so use small images.")]
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
    /// Ground truth: traced rays, or, for techniques with a kernel of fixed width, exact filtering of their own shadow map by that kernel
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
    /// Also measures flicker and lag in motion; of several, each moves separately
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
