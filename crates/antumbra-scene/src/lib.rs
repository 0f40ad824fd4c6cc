//! Scenes for the Antumbra laboratory: glTF files, setup files, procedural built-in scenes.
//!
//! A [`Scene`] comes from a file or is built in; a [`Setup`] has a camera and lights. [`load()`] finds both kinds of scene
//! by name. Conventions: metres, radians, right-handed, +Y up, linear colours.

mod anchored;
mod base64;
pub mod builtin;
mod camera;
mod closed;
mod error;
mod export;
mod gltf;
mod ground;
mod load;
mod scene;
mod setup;
mod translucency;
mod units;

pub use antumbra_light::{Aabb, ShadowDistance};
pub use camera::Camera;
pub use error::SceneError;
pub use export::{export_glb, export_glb_to, export_gltf};
pub use gltf::Animations;
pub use ground::Ground;
pub use load::{LoadOptions, load, load_animated, load_bytes, load_chosen};
pub use scene::{
    AlphaMode, Image, Instance, Material, Mesh, Scene, Volume, WorldTriangle, Wrap, linear_from_srgb, srgb_from_linear,
};
pub use setup::{Assumed, Framing, Setup};
pub use translucency::{Coverage, Occluder, SurfacePicture, Translucency};
