use glam::Vec3;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters that the encode, resolve and exact passes of every basis share.
    pub(crate) struct FilterUniform {
        packing: u32,
        sample_count: u32,
        kernel_radius: u32,
        max_anisotropy: u32,
        bias_scale: f32,
        t_step: f32,
        near_m: f32,
        far_m: f32,
        depth_axis: Vec3,
        level_count: u32,
    }
}
