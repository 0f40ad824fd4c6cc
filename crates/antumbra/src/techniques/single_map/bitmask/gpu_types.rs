use glam::Vec2;

use crate::gpu::{gpu_structs, shared_constants};

shared_constants! {
    /// Maximum number of 32-bit words; each light point has one bit.
    pub(crate) const MAX_WORDS: u32 = 8, as in BITMASK_RESOLVE;
}

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct BitmaskUniform {
        sample_count: u32,
        /// Number of patches along the light: a patch hides at most 1 / `patches` of the light's width, unless it is a single texel's.
        patches: u32,
        rotate: u32,
        /// Maximum slope of a step over which a gap is filled, as a multiple of `SURFACE_SLOPE`; negative if gaps stay open.
        steepest_gap: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on the light points' offsets along the axis.
        light_extent_axis: f32,
        bias_scale: f32,
    }
}
