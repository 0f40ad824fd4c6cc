//! Soft shadows for Bevy's lights, by adding one plugin.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_antumbra::AntumbraPlugin;
//!
//! App::new().add_plugins((DefaultPlugins, AntumbraPlugin::default())).run();
//! ```
//!
//! Materials, lights and scenes stay unchanged. Lights with `shadow_maps_enabled` get soft shadows in place of Bevy's own, and
//! every `RectLight` casts shadows. Softness depends on the lights' own sizes: `width` and `height` of a `RectLight`, `radius` of
//! a `PointLight` or a `SpotLight`, the `SunDisk` of a `DirectionalLight`. There is no bias to set.
//!
//! [`SoftShadows`] on a light or a camera, or in the plugin, sets technique, quality and parameters. [`CasterMaterial`] defines
//! how materials other than the standard one cast.
//!
#![doc = include_str!("../docs/pictures.md")]
//!
//! How it works: [Antumbra](antumbra) writes a visibility mask for each light and view, from the depth prepass and the
//! casters' meshes. Bevy's lighting is multiplied by it. The README lists the limits.
#![forbid(unsafe_code)]

mod bind_masks;
mod casters;
mod convert;
mod counting;
mod counts;
mod device;
mod draw;
mod layers;
mod lights;
mod masks;
mod normals;
mod patch;
mod patched;
mod plugin;
mod seen;
mod settings;
mod warnings;

pub use casters::{CasterMaterial, CasterMaterialPlugin, CasterSurface, SurfaceTexture};
pub use counts::{Counts, ShadowCounts};
pub use patch::Patch;
pub use plugin::AntumbraPlugin;
pub use settings::{
    BevyMaps, NoSoftShadows, ShadowDenoise, ShadowParameter, ShadowQuality, ShadowTechnique, ShadowValue, SoftShadows,
};

pub use antumbra::{self, SurfaceCoverage};
