use crate::contract::params;

params! {
    /// Parameters of [`Hard`](super::Hard).
    pub struct HardParams {
        /// Texels along a side of the light map.
        map_size: u32 = 1024, in 16..=8192, unit "texels", scale Log,
            more "Finer edges; memory and fill grow with the square.";
        /// Scale of the automatic bias.
        bias_scale: f32 = 1.0, in 0.0..=8.0,
            more "Above 1 detaches contact shadows, below 1 risks acne in concave corners.";
    }
    Fast { map_size: 512, }
    High { map_size: 2048, }
    Best { map_size: 4096, }
}
