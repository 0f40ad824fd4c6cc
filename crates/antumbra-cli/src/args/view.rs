//! Options of `view`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;

use super::common::{AdapterArgs, Ground};
use crate::values::{self, Setting};

/// Opens a window: move camera and lights, try techniques, compare two of them
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra view
  antumbra view scene.glb --setup evening.toml
  antumbra view builtin:street --technique pcss --against vsm:fast --set map_size=2048
  antumbra view builtin:overlap --show error --screenshot error.png

Controls: drag to rotate the camera, Shift-drag to move it sideways, wheel to zoom, W A S D Q E to fly, F to show the whole scene, \
Space to play animations, I to inspect the pixel under the pointer. Drop a scene or a setup on the window to open it. Save the view as \
a setup for the other commands.")]
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
    /// Adds a ground plane below the scene; auto: only if the scene is an object without ground
    #[arg(long, value_name = "WHEN", value_enum, ignore_case = true, num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "yes")]
    pub ground: Ground,
    /// Technique with optional quality: pcss, pcss:fast; or a preset file: advice.toml
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
