use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct PcfUniform {
        kernel_size_texels: f32,
        /// Number of taps; 0 for the box.
        tap_count: u32,
        rotate: u32,
        bias_scale: f32,
        attach_contacts: u32,
    }
}
