//! Options of `advise`.

use std::path::PathBuf;

use antumbra_lab::advise::{Budget, Prefer};
use clap::Args;
use glam::UVec2;

use super::common::{AdapterArgs, Ground};
use crate::values;

/// Recommends the technique and settings with the least error within a time budget
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra advise scene.glb --budget 4ms -o advice
  antumbra advise scene.glb --setup evening.toml --budget 2ms --memory 64MiB -o advice
  antumbra advise scene.glb --setup hall.toml --setup yard.toml --time 0 --time 1.5 --budget 4ms -o advice
  antumbra advise builtin:tree --budget 4x --size 240x135 --techniques pcss,essm,multi_layer
  antumbra render scene.glb --technique advice/advice.toml -o picture.png

Searches techniques, qualities and parameters, on small images first. Prints the recommendation with reasons, the next best candidates, \
and the cost of more quality. The budget is for one frame's shadows of one light: in milliseconds on this adapter, or in multiples of \
the time of pcf at its defaults (4x). With several setups or times, one recommendation is made for all: the slowest view must keep the \
budget, and the mean square error is minimised.

Open DIR/index.html. DIR/advice.toml is a preset for render, compare and view. DIR/measurements.json has all measurements: run the same \
command again to continue. See docs/advise.md.")]
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
    /// Adds a ground plane below the scene; auto: only if the scene is an object without ground
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
    /// Measures all combinations of a grid instead of searching: slow, to verify the search
    #[arg(long)]
    pub exhaustive: bool,
    /// Folder for the page, the preset and the measurements; an earlier search on the same view is resumed
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}
