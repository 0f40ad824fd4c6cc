use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `accumulate.wesl`.
    pub(crate) struct MultiViewBatch {
        /// The batch's first view.
        first: u32,
        /// How many views it has.
        count: u32,
        hardware_compare: u32,
        bias_scale: f32,
    }

    /// A light point.
    pub(crate) struct MultiViewSample {
        /// Homogeneous: a position, or a direction towards the light.
        point: [f32; 4],
        /// Share of the light's emission; all shares add up to 1.
        weight: f32,
        padding_0: f32,
        padding_1: f32,
        padding_2: f32,
    }
}
