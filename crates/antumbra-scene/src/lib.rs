//! Scenes for the Antumbra laboratory: glTF files, setup files, procedural built-in scenes.
//!
//! A [`Scene`] is what a file or a built-in holds; a [`Setup`] says where to look from and what the lights are.
//! [`load`] finds both by name. Conventions: metres, radians, right-handed, +Y up, linear colours.

pub mod builtin;
mod camera;
mod error;
mod load;
mod scene;
mod setup;

pub use antumbra_light::Aabb;
pub use camera::Camera;
pub use error::SceneError;
pub use load::{LoadOptions, load};
pub use scene::{
    AlphaMode, Image, Instance, Material, Mesh, Occluder, Scene, WorldTriangle, Wrap, linear_from_srgb,
    srgb_from_linear,
};
pub use setup::Setup;
