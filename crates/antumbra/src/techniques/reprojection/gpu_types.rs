use crate::gpu::gpu_structs;

gpu_structs! {
    /// One central view's fragments into one batch of targets; see `splat.wesl`.
    pub(crate) struct SplatBatch {
        view_size: u32,
        row_texels: u32,
        first: u32,
        count: u32,
        faces: u32,
        points: u32,
        first_slice: u32,
        synchronized: u32,
        kind: u32,
        reach: f32,
        steepest: f32,
        width_of_depth: f32,
        width: f32,
        first_face: u32,
        face_half_size: f32,
        face_slack_m: f32,
        padding_0: u32,
        padding_1: u32,
    }

    /// How the integer maps lie; see `draw.wesl`.
    pub(crate) struct DrawMaps {
        view_size: u32,
        row_texels: u32,
        padding_0: u32,
        padding_1: u32,
    }
}
