use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `encode.wesl` and `resolve.wesl`.
    pub(crate) struct LvsmUniform {
        layer_count: u32,
        overlap: f32,
        layer_step: f32,
        blends: u32,
        shows_layers: u32,
        least_variance: f32,
        padding_y: u32,
        padding_z: u32,
    }

    /// Parameters of a draw with `targets.wesl`.
    pub(crate) struct LayerDraw {
        first_word: u32,
        padding_x: u32,
        padding_y: u32,
        padding_z: u32,
    }

    /// Parameters of `histogram.wesl` and `bleeding.wesl`.
    pub(crate) struct LvsmHistogramUniform {
        stride: u32,
        overlap: f32,
        kernel_size: f32,
        min_weight: f32,
        max_weight: f32,
        padding_x: u32,
        padding_y: u32,
        padding_z: u32,
    }
}
