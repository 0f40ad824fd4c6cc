use glam::Vec2;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct SmrtUniform {
        /// The first taps are the search's,
        tile_search_count: u32,
        /// of which a pixel takes so many.
        search_count: u32,
        /// The rest are the rays' ends.
        ray_count: u32,
        /// Reads along a ray at the most.
        most_steps: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on their offsets along the axis.
        light_extent_axis: f32,
        /// Cells of equal numbers of the rays' ends along each side of a rectangle.
        cells: f32,
        /// How thick a surface counts as, and one of the last layer; widths of a texel.
        thickness_texels: Vec2,
        /// Half the light's narrow side, metres (a sun's tangent).
        narrow_half_extent: f32,
        padding: u32,
    }
}
