use glam::{Vec3, Vec4};

use crate::gpu::gpu_structs;

gpu_structs! {
    /// Settings that every pass shares; see `settings.wesl`.
    pub(crate) struct SampleSettings {
        light_min: Vec3,
        point_count: u32,
        light_max: Vec3,
        word_count: u32,
        casters_min: Vec3,
        list_bits: u32,
        casters_max: Vec3,
        projection: u32,
        total_weight: f32,
        switches: u32,
        cell_count: u32,
        list_count: u32,
        super_first: u32,
        is_weighted: u32,
        triangle_stride: u32,
        lookup_size: u32,
        first_word: u32,
        pixel_words: u32,
        rotations: u32,
        turn: f32,
        ray_offset_scale: f32,
        max_groups: u32,
        cells_across: u32,
        max_cells: u32,
        iterations_per_triangle: u32,
        max_iterations: u32,
        first_passed: u32,
        window_count: u32,
        window: u32,
        window_side: u32,
        receivers_per_instance: u32,
        subset: u32,
        window_right: Vec3,
        region_corners: u32,
        window_up: Vec3,
        matrix_rounding_m: f32,
        window_axis: Vec3,
        padding_1: u32,
        window_light_min: Vec3,
        padding_2: u32,
        window_light_max: Vec3,
        padding_3: u32,
        clip_z_row: Vec4,
        clip_w_row: Vec4,
    }

    /// Effect on light of a batch's triangles that are not opaque:
    /// [`SurfaceValues`](crate::light_map::caster_surface::SurfaceValues).
    pub(crate) struct SampleSurface {
        factor: Vec4,
        cutoff: f32,
        coverage: u32,
        padding_0: u32,
        padding_1: u32,
    }
}
