//! Scenes for the Antumbra laboratory: glTF files, setup files, procedural built-in scenes.
//!
//! A [`Scene`] is what a file or a built-in holds; a [`Setup`] says where to look from and what the lights are.
//! [`load`] finds both by name. Conventions: metres, radians, right-handed, +Y up, linear colours.

mod camera;
mod scene;

pub use camera::Camera;
pub use scene::{
    Aabb, AlphaMode, Image, Instance, Material, Mesh, Occluder, Scene, WorldTriangle, Wrap, linear_from_srgb,
    srgb_from_linear,
};
