//! Contract between a host and every technique: inputs and outputs. It contains no pipelines.
//!
//! # Conventions
//! - World space: metres, right-handed, +Y up. Angles in radians. Colours linear.
//! - An image's first row is the top; the sample of pixel (i, j) lies at (i + ½, j + ½).
//! - Clip space as WebGPU's: x right, y up, depth 0 to 1. Each depth buffer of a host comes with its [`DepthConvention`]; the
//!   library's own light maps are reversed: 1 at the near plane, 0 at the far.
//! - A light looks along its axis; [`LightFrame`](antumbra_light::LightFrame)'s (right, up, −axis) is right-handed.
//! - *Visibility* is 1 where lit and 0 in the umbra; *occlusion* is 1 − visibility.

mod casters;
mod casters_key;
mod coherent;
mod denoise;
mod drawn_lists;
mod drawn_map;
mod error;
mod frame;
mod map_size;
mod mask;
mod param_macros;
mod params;
mod points;
mod quality;
mod receivers;
mod sample_weights;

pub(crate) use casters::tints;
pub use casters::{DepthMapCaster, MeshCaster, MeshVersion, Opacity, PreparedCasters, SurfaceCoverage, SurfaceTexture};
pub(crate) use casters_key::CastersKey;
pub use coherent::{COHERENT_WGSL, VertexFaces};
pub use denoise::Denoise;
pub use drawn_lists::{DrawnLists, ListLengths, ListLevel, ListOrder};
pub use drawn_map::{DrawnMap, LevelTexels, MapLevel};
pub use error::{Error, ParamError};
pub use frame::{Overflow, PreparedFrame};
pub use map_size::MapSize;
pub use mask::{Mask, MaskChannels, MaskPlace};
pub(crate) use param_macros::{declare_params, param_choice, params, params_in_full};
pub use params::{ParamList, ParamScale, ParamSpec, ParamType, ParamValue, Params};
pub use points::{PointBuffer, PointReceivers, PointWidths};
pub use quality::{Departure, PublishedForm, Quality};
pub(crate) use receivers::SeenPoint;
pub use receivers::{Camera, DepthConvention, PreparedReceivers, Receivers, Surfaces};
pub use sample_weights::SampleWeights;
