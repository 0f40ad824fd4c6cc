use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct VsmUniform {
        bleeding_reduction: f32,
        padding_x: f32,
        padding_y: f32,
        padding_z: f32,
    }
}
