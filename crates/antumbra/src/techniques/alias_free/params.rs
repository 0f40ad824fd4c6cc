use crate::contract::params;

params! {
    /// Parameters of [`AliasFree`](super::AliasFree).
    pub struct AliasFreeParams {
        /// Texels along a side of the map whose texels hold the lists of receivers; rounded up to a power of two.
        map_size: u32 = 512, in 16..=2048, unit "texels", scale Log,
            more "Shorter lists, which changes the time and never the shadow.";
        /// Scale of the distance off their surface at which segments start where casters are not closed.
        bias_scale: f32 = 1.0, in 0.0..=8.0,
            more "Above 1 detaches contact shadows by micrometres, below 1 risks acne on open meshes.";
    }
}
