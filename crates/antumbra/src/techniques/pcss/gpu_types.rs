use glam::Vec2;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct PcssUniform {
        /// The first taps are the search's.
        search_count: u32,
        /// The rest are the filter's.
        filter_count: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on their offsets along the axis.
        light_extent_axis: f32,
        padding: f32,
    }
}
