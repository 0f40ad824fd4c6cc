use glam::{Vec2, Vec3};

use crate::gpu::gpu_structs;
use crate::light_map::light_spread::LightSpread;

gpu_structs! {
    /// Parameters of `resolve.wesl`.
    pub(crate) struct PcssUniform {
        /// Number of search taps, the first ones.
        search_count: u32,
        /// Number of filter taps, the ones that follow.
        filter_count: u32,
        rotate: u32,
        bias_scale: f32,
        /// Bound on the light points' offsets along right and up from the map's origin, metres (tangents for a sun).
        light_extent: Vec2,
        /// Bound on the light points' offsets along the axis.
        light_extent_axis: f32,
        /// Whether the kernel of `pcss_anisotropic` is an ellipse; `light_covariance` and `light_mean` are of that kernel, too.
        is_ellipse: u32,
        light_covariance: Vec3,
        /// Whether every tap is compared with the receiver's own depth instead of its plane.
        is_flat: u32,
        light_mean: Vec2,
        /// Whether light points are tested at the nearest blocker's own scale, too, at contacts.
        attach_contacts: u32,
        /// Number of search taps after which one blocker is enough.
        search_enough: u32,
    }
}

impl PcssUniform {
    /// Parameters for given numbers of taps over a light; all others are zero.
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
