//! Structs shared with this folder's shaders.

use glam::Vec3;

use crate::gpu::{gpu_structs, shared_constants};

gpu_structs! {
    /// Items of one tree, and where the tree is stored.
    pub(crate) struct Segment {
        first_item: u32,
        item_count: u32,
        first_block: u32,
        first_node: u32,
        first_triangle: u32,
        triangle_stride: u32,
        source_triangle: u32,
        padding: u32,
    }

    /// Input of a pass that builds trees.
    pub(crate) struct TreeShape {
        item_count: u32,
        segment_count: u32,
        block_count: u32,
        is_top: u32,
        step: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }

    /// Items whose triangles are in the same buffers.
    pub(crate) struct SourceRange {
        first_item: u32,
        end_item: u32,
        padding_0: u32,
        padding_1: u32,
    }

    /// Instances of a caster.
    pub(crate) struct InstanceRun {
        first_item: u32,
        first_instance: u32,
        caster: u32,
        first_node: u32,
    }

    /// Instances in the same buffer.
    pub(crate) struct InstanceRange {
        anchor_in_world: Vec3,
        first_item: u32,
        end_item: u32,
        run_count: u32,
        padding_0: u32,
        padding_1: u32,
    }

    /// Light points of a pass.
    pub(crate) struct RayBatch {
        first_point: u32,
        point_count: u32,
        share: f32,
        bias_scale: f32,
        all_points: u32,
        instance_count: u32,
        texture_group: u32,
        is_last_group: u32,
        rotate: u32,
        max_iterations: u32,
        passed_stride: u32,
        weighs_irradiance: u32,
    }
}

shared_constants! {
    /// Number of vectors per instance.
    pub(crate) const INSTANCE_VECTORS: u32 = 7, as in RAY_TRACED_TRACE;
    /// Number of vectors per caster in the table.
    pub(crate) const CASTER_VECTORS: u32 = 3, as in RAY_TRACED_TRACE;
    /// Flag: the triangles bound a solid.
    pub(crate) const FLAG_CLOSED: u32 = 1, as in RAY_TRACED_TRACE;
    /// Flag: light may pass the caster.
    pub(crate) const FLAG_OPEN: u32 = 2, as in RAY_TRACED_TRACE;
}
