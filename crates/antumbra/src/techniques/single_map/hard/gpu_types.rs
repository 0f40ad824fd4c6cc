use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct HardUniform {
        bias_scale: f32,
    }
}
