//! Options that several commands share: scene, view and adapter.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;

use crate::values;

/// Camera, lights and time of a scene.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Setup file with camera and lights (TOML); default: the scene's own, or assumed ones, which are printed
    #[arg(long, value_name = "F.toml")]
    pub setup: Option<PathBuf>,
    /// Time at which animations are sampled, in seconds
    #[arg(long, value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = values::time)]
    pub time: f32,
    /// Adds a ground plane below the scene; auto: only if the scene is an object without ground
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
    /// Converts to the scene crate's type.
    pub fn when(self) -> antumbra_scene::Ground {
        match self {
            Self::Auto => antumbra_scene::Ground::Auto,
            Self::Yes => antumbra_scene::Ground::Yes,
            Self::No => antumbra_scene::Ground::No,
        }
    }
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
