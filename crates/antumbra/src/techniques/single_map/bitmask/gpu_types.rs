use glam::Vec2;

use crate::gpu::{gpu_structs, shared_constants};

shared_constants! {
    /// Words of 32 points' bits, at the most.
    pub(crate) const MOST_WORDS: u32 = 8, as in BITMASK_RESOLVE;
}

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct BitmaskUniform {
        sample_count: u32,
        /// Of the light's width a patch hides one part in so many at the most, unless it is a texel's.
        patches: u32,
        rotate: u32,
        /// Of a step between neighbours over which a gap is filled the steepest slope, in that of one surface; negative where none is.
        steepest_gap: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on their offsets along the axis.
        light_extent_axis: f32,
        bias_scale: f32,
    }
}
