use glam::{Vec2, Vec3};

use crate::gpu::gpu_structs;
use crate::light_map::light_spread::LightSpread;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct PcssUniform {
        /// The first taps are the search's.
        search_count: u32,
        /// The rest are the filter's.
        filter_count: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on their offsets along the axis.
        light_extent_axis: f32,
        /// Of the kernel of `pcss_anisotropic`, as the rest.
        is_ellipse: u32,
        light_covariance: Vec3,
        /// Every tap is compared with the receiver's own depth.
        is_flat: u32,
        light_mean: Vec2,
        /// The nearest blocker's own scale counts where it is a contact's.
        attach_contacts: u32,
        /// Taps of the search after which one blocker is enough.
        search_enough: u32,
    }
}

impl PcssUniform {
    /// So many taps over a light.
    pub(crate) fn of(search_count: u32, filter_count: u32, light: &LightSpread) -> Self {
        Self {
            search_count,
            search_enough: search_count,
            filter_count,
            light_extent: light.extent,
            light_extent_axis: light.extent_axis,
            ..Self::default()
        }
    }
}
