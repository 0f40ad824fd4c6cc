//! Central views from behind the light, which hold casters that are nearer to the light than the light is large.
//!
//! From the light's centre, casters at depth z hide the light's rim at tangents up to r / z: a cover just in front of a light lies beyond
//! every window, or is seen edge-on. From a distance d behind the light, tangents are no larger than r / d: along a segment from a receiver
//! to the light, offsets change linearly with depth, and their tangents lie between those of the segment's two ends. A window that holds
//! receivers and light holds all segments between them.
//!
//! These views also see surfaces behind the light, which are left out when surfels are collected.

use antumbra_light::{Aabb, Light, LightFrame};
use glam::{DVec4, Vec3};

use crate::contract::MeshCaster;
use crate::light_map::light_spread::LightSpread;
use crate::light_map::light_view::{FollowedLight, LightView, MIDDLE_TANGENT, ViewFit};
use crate::light_map::occluding_bounds::OccludingBounds;

/// Tangent at which the light's edge is seen, just within the middle face of a cube. From nearer, casters in front of the light's rim would
/// be seen at a grazing angle; from farther, in coarser texels.
const LIGHT_TANGENT: f32 = 1.0;

/// Position behind a light, and distance to the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct CenterBehindLight {
    /// Axes of the light, at the position.
    pub(super) frame: LightFrame,
    /// Distance from the position to the light's back, metres.
    depth_m: f32,
    /// Distance from there to what counts as in front of the light, metres.
    gap_m: f32,
}

impl CenterBehindLight {
    /// Position behind a light; `None` if the view `from_middle` holds the casters near the light.
    pub(super) fn of(light: &Light, from_middle: &LightView) -> Option<Self> {
        if from_middle.complete_from_m == 0.0 {
            return None;
        }
        let LightSpread { extent, extent_axis, .. } = LightSpread::of(light);
        let tangent = light.max_angle_tangent().map_or(LIGHT_TANGENT, |reach| reach.min(LIGHT_TANGENT));
        let depth_m = extent.max_element() / tangent;
        let center = from_middle.frame.center - (depth_m + extent_axis) * from_middle.frame.axis;
        let frame = LightFrame { center, ..from_middle.frame };
        // Surfaces in the light's own plane, such as a ceiling around a panel, count as behind it.
        Some(Self { frame, depth_m, gap_m: 0.5 * from_middle.near_m })
    }

    /// View with one window; `None` without receivers, or if no window holds all of them.
    pub(super) fn plane(&self, light: &Light, casters: &[Aabb], receivers: &[Vec3]) -> Option<LightView> {
        if receivers.is_empty() {
            return None;
        }
        let LightSpread { extent, extent_axis, .. } = LightSpread::of(light);
        let LightFrame { center, right, up, axis } = self.frame;
        let corner = |i: u32| {
            let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
            let depth = self.depth_m + extent_axis * (1.0 + sign(4));
            center + sign(1) * extent.x * right + sign(2) * extent.y * up + depth * axis
        };
        let ends: Vec<Vec3> = receivers.iter().copied().chain((0..8).map(corner)).collect();
        let between = OccludingBounds::new(light, casters, receivers);
        let fit = ViewFit::perspective(
            self.frame,
            FollowedLight::Center,
            0.0,
            0.0,
            light.max_angle_tangent(),
            &between,
            &ends,
        )
        .beginning_at(self.depth_m)
        .for_many_windows();
        let view = fit.view(LightView::best_roll(|window| fit.view(window)));
        (view.window.half_size.max_element() <= MIDDLE_TANGENT).then_some(view)
    }

    /// Plane in world space from which on casters are in front of the light.
    pub(super) fn front_in_world(&self) -> DVec4 {
        let LightFrame { center, axis, .. } = self.frame;
        let (center, axis) = (center.as_dvec3(), axis.as_dvec3());
        axis.extend(-axis.dot(center) - f64::from(self.depth_m + self.gap_m))
    }
}

/// Casters as they are drawn from behind a light. A solid that may contain the light has its nearest faces behind the light and its back
/// faces in front of it; since layers leave out back faces of solids, it is drawn as open.
pub(super) fn open_about_light<'a>(light: &Light, casters: &'a [MeshCaster<'a>]) -> Vec<MeshCaster<'a>> {
    let radius = Vec3::splat(light.bounding_radius());
    let of_light = Aabb { min: light.center - radius, max: light.center + radius };
    let may_hold_light = |caster: &MeshCaster<'_>| of_light.intersection(caster.bounds).is_some();
    let open = |caster: &MeshCaster<'a>| MeshCaster { closed: caster.closed && !may_hold_light(caster), ..*caster };
    casters.iter().map(open).collect()
}
