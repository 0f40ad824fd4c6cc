use crate::gpu::{gpu_structs, shared_constants};

shared_constants! {
    /// The same to each of the mask's channels.
    pub(crate) const ALL_CHANNELS: u32 = 255, as in MULTI_VIEW_ACCUMULATE;
}

gpu_structs! {
    /// A batch of light points whose maps exist at one time.
    pub(crate) struct ViewBatch {
        /// The batch's first light point.
        first: u32,
        /// How many it has.
        count: u32,
        /// Maps of each: 1, or the faces of a cube.
        faces: u32,
        /// 1: the hardware's comparison sampler.
        hardware_compare: u32,
        bias_scale: f32,
        /// How far from its centre a texel's depth may have been taken, texels.
        slope_bias_texels: f32,
        /// Of `multi_view`'s sharp comparison: the standard deviation of its kernel, texels; 0 for all others.
        kernel_texels: f32,
        /// How far light points lie from the light's centre, metres; for a sun, tangents.
        light_radius: f32,
        /// Of the mask, the channel that is added to; [`ALL_CHANNELS`] for all.
        channel: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }

    /// A light point.
    pub(crate) struct ViewSample {
        /// Homogeneous: a position, or a direction towards the light.
        point: [f32; 4],
        /// Share of the light's emission; all shares add up to 1.
        weight: f32,
        padding_0: f32,
        padding_1: f32,
        padding_2: f32,
    }
}
