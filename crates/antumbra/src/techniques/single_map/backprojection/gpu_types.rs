use glam::Vec2;

use crate::gpu::{gpu_structs, shared_constants};

shared_constants! {
    /// Maximum number of squares along a ring, including those around it.
    pub(crate) const MAX_SQUARES: u32 = 70, as in BACKPROJECTION_RESOLVE;
}

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct BackprojectionUniform {
        /// Number of points of a light whose area has no closed form.
        sample_count: u32,
        /// Maximum number of squares along the part of the map through which the receiver sees the light.
        squares: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on the light points' offsets along the axis.
        light_extent_axis: f32,
        /// Maximum slope of a step between neighbours of one surface, as a multiple of `SURFACE_SLOPE`.
        steepest_gap: f32,
    }
}
