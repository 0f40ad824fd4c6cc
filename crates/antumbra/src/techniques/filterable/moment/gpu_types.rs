use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct MomentUniform {
        moment_bias: f32,
        is_bounded: u32,
        padding_x: u32,
        padding_y: u32,
    }
}
