//! Options of `render`.

use std::path::PathBuf;

use clap::Args;

use super::common::{AdapterArgs, ViewArgs};
use crate::values::{self, Setting};

/// Factor of a light's shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum ShadingFactor {
    /// Visible fraction of the light's irradiance, if the technique computes it; else visibility
    #[default]
    Ratio,
    /// Visibility
    Product,
}

/// Renders an image with soft shadows by one technique
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  antumbra render builtin:tree -o tree.png
  antumbra render scene.glb --setup evening.toml --technique multi_view --set samples=256 -o evening.png
  antumbra render scene.glb --technique pcss --set search_samples=32 --set samples=128 -o a.png --visibility a.exr

`antumbra techniques NAME` lists the parameters for --set.

--visibility writes the mask as 32-bit float OpenEXR, channel V: 1 is lit, 0 is umbra. With several lights, a.exr is the mask of the \
first and a.NAME.exr that of each other; --light NAME writes only that of NAME.")]
pub struct RenderArgs {
    /// A .glb or .gltf file, or builtin:NAME
    #[arg(value_name = "SCENE", value_parser = values::scene)]
    pub scene: String,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Technique with optional quality: pcss, pcss:fast; or a preset file: advice.toml
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
    /// Factor of a light's shading: the visible fraction of its irradiance, if the technique computes it
    /// (weights=irradiance), or visibility
    #[arg(long, value_name = "BY", value_enum, ignore_case = true, default_value = "ratio")]
    pub shading: ShadingFactor,
    /// Number of frames to draw; the last is written. Accumulating techniques converge over frames
    #[arg(long, value_name = "N", default_value = "1", value_parser = values::frames)]
    pub frames: u32,
    /// Also writes the time of every pass, in milliseconds (JSON)
    #[arg(long, value_name = "t.json")]
    pub timings: Option<PathBuf>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}
