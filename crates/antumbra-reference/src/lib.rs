//! Ray-traced ground truth of soft shadows, on the CPU.
//!
//! A [`Tracer`] is built from a scene. [`Tracer::primary`] finds what a camera sees, [`Tracer::visibility`] the visibility
//! of a light from each pixel, as `docs/formats.md` defines it: the fraction of the light's emitting area along segments
//! that no opaque triangle blocks, whichever way it faces, with alpha masks, and with the product of the transmittances
//! of translucent surfaces.
//!
//! ```
//! use antumbra_light::{Light, LightShape};
//! use antumbra_reference::{Tracer, VisibilityOptions};
//! use antumbra_scene::{Camera, Scene};
//! use glam::{UVec2, Vec2, Vec3};
//! use std::sync::atomic::AtomicBool;
//!
//! let scene = Scene::default();
//! let camera = Camera {
//!     eye: Vec3::new(4.0, 4.0, 6.0),
//!     target: Vec3::ZERO,
//!     up: Vec3::Y,
//!     fov_y_rad: 0.8,
//!     near_m: 0.05,
//!     far_m: 100.0,
//!     shadow_distance: None,
//! };
//! let light = Light::new(LightShape::Rectangle { size_m: Vec2::ONE }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
//!
//! let tracer = Tracer::new(&scene)?;
//! let receivers = tracer.primary(&camera, UVec2::new(64, 36));
//! let options = VisibilityOptions::default();
//! let image = tracer.visibility(&receivers, &light, &options, &|_| {}, &AtomicBool::new(false))?;
//! assert!(image.values.iter().all(|v| *v == [1.0; 3]), "an empty scene is all background");
//! # Ok::<(), antumbra_reference::ReferenceError>(())
//! ```
//!
//! Performance: the segments of one receiver are traced together (`walk.rs`). Correctness: every shortcut gives the same
//! bits as testing each triangle against each light point.

mod error;
mod geometry;
mod lanes;
mod planes;
mod ray;
mod receivers;
mod sampled_light;
mod shaft;
mod surface;
#[cfg(test)]
mod tests;
mod tracer;
mod tree;
mod visibility;
mod walk;

pub use error::ReferenceError;
pub use receivers::{ReceiverPoint, Receivers};
pub use sampled_light::SampledLight;
pub use tracer::Tracer;
pub use visibility::{VisibilityImage, VisibilityOptions};

/// Progress callback, which receives the completed fraction from 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f32) + Sync);
