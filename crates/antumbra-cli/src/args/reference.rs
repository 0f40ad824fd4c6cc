//! Options of `reference`.

use std::path::PathBuf;

use clap::Args;

use super::common::{AdapterArgs, ViewArgs};
use crate::values;

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
    /// Also writes the visibility (OpenEXR, 32-bit float; channel V, or V.R, V.G, V.B if occluders are tinted)
    #[arg(long, value_name = "v.exr")]
    pub visibility: Option<PathBuf>,
    /// Light that --visibility writes, by name; default: all
    #[arg(long, value_name = "NAME")]
    pub light: Option<String>,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}
