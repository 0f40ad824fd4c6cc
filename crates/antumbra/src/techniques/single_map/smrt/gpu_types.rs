use glam::Vec2;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct SmrtUniform {
        /// Number of search taps of a tile, the first taps.
        tile_search_count: u32,
        /// Number of search taps that a pixel takes.
        search_count: u32,
        /// Number of rays, whose ends are the remaining taps.
        ray_count: u32,
        /// Maximum number of reads along a ray.
        max_steps: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on the light points' offsets along the axis.
        light_extent_axis: f32,
        /// Number of cells along each side of a rectangle, each with the same number of ray ends.
        cells: f32,
        /// Assumed thickness of a surface, and of one in the last layer; texel widths.
        thickness_texels: Vec2,
        /// Half the light's narrow side, metres (tangent for a sun).
        narrow_half_extent: f32,
        padding: u32,
    }
}
