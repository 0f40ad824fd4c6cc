use crate::gpu::{gpu_structs, shared_constants};

shared_constants! {
    /// Channel value of batches that write the same visibility to all of the mask's channels.
    pub(crate) const ALL_CHANNELS: u32 = 255, as in MULTI_VIEW_ACCUMULATE;
}

gpu_structs! {
    /// Batch of light points whose maps exist at the same time.
    pub(crate) struct ViewBatch {
        /// Index of the batch's first light point.
        first: u32,
        /// Number of the batch's light points.
        count: u32,
        /// Number of maps per light point: 1, or the faces of a cube.
        faces: u32,
        /// 1 for the hardware's comparison sampler, otherwise 0.
        hardware_compare: u32,
        bias_scale: f32,
        /// Distance from its centre at which a texel's depth may have been taken, texels.
        slope_bias_texels: f32,
        /// Standard deviation of the kernel of `multi_view`'s sharp comparison, texels; 0 for all others.
        kernel_texels: f32,
        /// Radius of the light around its centre, metres; for a sun, tangents.
        light_radius: f32,
        /// Channel of the mask that is added to; [`ALL_CHANNELS`] for all.
        channel: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }

    /// Light point.
    pub(crate) struct ViewSample {
        /// Homogeneous position, or direction towards the light.
        point: [f32; 4],
        /// Share of the light's emission; all shares add up to 1.
        weight: f32,
        padding_0: f32,
        padding_1: f32,
        padding_2: f32,
    }
}
