use glam::UVec2;

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters of `filter.wesl`.
    pub(crate) struct FilterStep {
        source_size: UVec2,
        target_size: UVec2,
        source_first: u32,
        target_first: u32,
        stride: u32,
        near_child: i32,
        far_child: i32,
        subsample: u32,
        epsilon_slope: f32,
        epsilon_m: f32,
        capacity: u32,
        z_limit_m: f32,
        complete_from_m: f32,
        padding_0: u32,
    }

    /// Parameters of `nearest.wesl`.
    pub(crate) struct NearestStep {
        map_size: UVec2,
        level: u32,
        first: u32,
        source_first: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }

    /// Rung of the lookup ladder of `resolve.wesl`: a level for one filter width.
    pub(crate) struct MultiLayerRung {
        size: UVec2,
        /// Index of the level's first list.
        first: u32,
        spacing: f32,
        offset: f32,
        width: f32,
        epsilon_slope: f32,
        epsilon_m: f32,
        squared: f32,
        squared_finer: f32,
        squared_coarser: f32,
        reach: f32,
        square_shift: u32,
        square_first: u32,
        merged: f32,
        padding_0: u32,
    }

    /// Rungs that `resolve.wesl` looks up, from the receiver towards the light.
    pub(crate) struct MultiLayerLadder {
        rungs: [MultiLayerRung; 32],
    }

    /// Parameters of `resolve.wesl`.
    pub(crate) struct MultiLayerUniform {
        rung_count: u32,
        filter_per_g: f32,
        footprint_px: f32,
        bias_texels: f32,
    }
}
