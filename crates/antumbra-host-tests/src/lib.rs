//! An independent host of the library: a small wgpu renderer, and a ray caster that judges the masks.
//!
//! Renderer and ray caster share no code with the examples, the laboratory or the reference ray tracer. What both sides
//! read alike stands in the public API alone: the definition of a light's shape, and of visibility.
//!
//! - [`device`]: a device, and what catches its validation messages.
//! - [`scene`]: triangles, cameras and the base scene.
//! - [`raster`]: depth and normals of a scene, in any depth format and convention.
//! - [`rays`]: visibility by brute force over all triangles, in double precision.
//! - [`host`]: casters in the host's own buffers, frames, and masks as numbers.
//!
//! The tests are in `tests/host`.

pub mod device;
pub mod host;
pub mod raster;
pub mod rays;
pub mod scene;
