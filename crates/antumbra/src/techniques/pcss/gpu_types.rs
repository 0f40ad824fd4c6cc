use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct PcssUniform {
        /// The first taps are the search's.
        search_count: u32,
        /// The rest are the filter's.
        filter_count: u32,
        rotate: u32,
        bias_scale: f32,
    }
}
