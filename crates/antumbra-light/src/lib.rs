//! Lights: shape, pose and sample points.
//!
//! The library, the setup files and the reference ray tracer must agree on where a light lies and how its area is weighted. This
//! crate defines that, with the box that frusta are fitted to, and nothing else: no GPU, no files.
//!
//! Conventions, for the whole project: metres, radians, right-handed, +Y up, linear colours.

mod aabb;
mod anchor;
mod emission;
mod hull;
mod light;
mod light_error;
mod light_point;
mod moments;
mod sample_set;
mod shadow_distance;

pub use aabb::Aabb;
pub use anchor::anchor_near;
pub use emission::{EmissionTexture, LUMINANCE};
pub use hull::{Polytope, enclosing_corners, enclosing_planes, polytope_corners};
pub use light::{Cone, Light, LightFrame, LightShape};
pub use light_error::LightError;
pub use light_point::{LightPoint, ball_from_cube, disk_from_square};
pub use moments::{EquivalentRectangle, LightMoments};
pub use sample_set::{SampleSet, hash_u32, unit_f32};
pub use shadow_distance::ShadowDistance;
