use crate::gpu::gpu_structs;

gpu_structs! {
    /// Parameters for scattering one central view into the maps of a batch; see `splat.wesl`.
    pub(crate) struct SplatBatch {
        view_size: u32,
        row_texels: u32,
        first_group: u32,
        group_count: u32,
        first_slice: u32,
        has_receivers: u32,
        reach: f32,
        steepest: f32,
        width_of_depth: f32,
        width: f32,
        face_half_size: f32,
        face_slack_m: f32,
        light_reach: [f32; 4],
        light_axis: [f32; 4],
        light_front: [f32; 4],
        receivers: [[f32; 4]; 8],
    }

    /// Maps that a central view is scattered into together; see `splat.wesl`.
    pub(crate) struct ViewGroup {
        target_from_central: [[f32; 16]; 8],
        metres_from_central: [f32; 16],
        first_map: u32,
        map_step: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: [[u32; 4]; 11],
    }

    /// Rows of one slice of the central maps, whose surfels are listed together; see `surfels.wesl`.
    #[derive(PartialEq)]
    pub(crate) struct SurfelPiece {
        slice: u32,
        first_row: u32,
        first_name: u32,
        first_count: u32,
        padding: [[u32; 4]; 15],
    }

    /// Layout of the integer maps; see `draw.wesl`.
    pub(crate) struct DrawMaps {
        view_size: u32,
        row_texels: u32,
        padding_0: u32,
        padding_1: u32,
    }
}
