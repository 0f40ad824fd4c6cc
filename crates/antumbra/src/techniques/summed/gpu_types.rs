use glam::{Vec2, Vec3};

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of every pass; `uniform.wesl` describes each field.
    pub(crate) struct SoftUniform {
        light_extent: Vec2,
        light_extent_axis: f32,
        bias_scale: f32,
        light_covariance: Vec3,
        exponent: f32,
        light_mean: Vec2,
        negative_exponent: f32,
        value_scale: f32,
        tile_log2: u32,
        range_from_map: u32,
        empty_depth: f32,
        non_planar: f32,
        subdivisions: u32,
        search_scales: u32,
        search_taps: u32,
        row_height: f32,
        is_ellipse: u32,
        with_footprint: u32,
        direct_texels: f32,
        max_part_texels: f32,
        bleeding_reduction: f32,
        may_read_map: u32,
        padding_0: f32,
        padding_1: f32,
    }
}
