//! An independent host of the library: a small wgpu renderer, and a ray caster that computes reference visibility.
//!
//! Renderer and ray caster share no code with the examples, the laboratory or the reference ray tracer. They rely on the
//! public API alone for the definitions of light shapes and of visibility.
//!
//! - [`device`]: a device that catches validation messages.
//! - [`scene`]: triangles, cameras and the base scene.
//! - [`raster`]: depth and normals of a scene, in any depth format and convention.
//! - [`rays`]: visibility by brute force over all triangles, in double precision.
//! - [`host`]: casters in the host's own buffers, frames, and masks as arrays.
//!
//! The tests are in `tests/host`.

pub mod device;
pub mod host;
pub mod raster;
pub mod rays;
pub mod scene;
