use glam::Vec2;

use crate::gpu::{gpu_structs, shared_constants};

shared_constants! {
    /// Squares along a ring, with those about it, at the most.
    pub(crate) const MOST_SQUARES: u32 = 70, as in BACKPROJECTION_RESOLVE;
}

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct BackprojectionUniform {
        /// Points of a light whose area has no closed form.
        sample_count: u32,
        /// Of the map, along the part of it through which the receiver sees the light, at the most.
        squares: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on their offsets along the axis.
        light_extent_axis: f32,
        /// Of a step between neighbours of one surface the steepest slope, in that of a surface.
        steepest_gap: f32,
    }
}
