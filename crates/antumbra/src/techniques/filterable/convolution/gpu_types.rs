use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `encode.wesl` and `resolve.wesl`.
    pub(crate) struct ConvolutionUniform {
        term_count: u32,
        depth_scale: f32,
        padding_x: u32,
        padding_y: u32,
    }
}
