use glam::UVec2;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Shape of a table made by `table.wesl`.
    pub(crate) struct TableUniform {
        size: UVec2,
        tile: u32,
        padding: u32,
    }

    /// Parameters of one step of `doubling.wesl`.
    pub(crate) struct DoublingUniform {
        size: UVec2,
        stride: UVec2,
        tile: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}
