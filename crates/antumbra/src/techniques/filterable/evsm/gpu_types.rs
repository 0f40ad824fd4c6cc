use glam::Vec2;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `encode.wesl` and `resolve.wesl`.
    pub(crate) struct EvsmUniform {
        exponents: Vec2,
        component_count: u32,
        padding: u32,
    }
}
