use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `encode.wesl` and `resolve.wesl`.
    pub(crate) struct EsmUniform {
        exponent: f32,
        padding_x: f32,
        padding_y: f32,
        padding_z: f32,
    }
}
