//! The direction in which filtered depths are measured.
//!
//! A filtered map may measure depth along any direction that every ray of its view goes forward in: what is nearer on a ray
//! stays nearer. Along the light's own axis a floor that is lit at a slant has another depth in each texel; two moments take
//! that spread for a second occluder, four have nothing left for a third. Along the floor's normal it has one.
//! What is built lies along the world's axes, most of it, so the one nearest to the light's axis is the best guess.
//!
//! Lauritzen and McCool 2008, section 5, measure "the normalized Euclidean distance to the light point or plane": along every
//! ray of the map itself. A floor then has another depth in each texel even straight below the light.

use antumbra_light::Aabb;
use glam::{Vec2, Vec3};

use crate::contract::param_choice;
use crate::light_map::light_view::{LightView, LightViewGpu};
use crate::light_map::occluding_bounds::Between;

param_choice! {
    /// The direction in which a filterable map measures depth.
    pub enum DepthAxis {
        /// The light's axis.
        Light = "light",
        /// The world's axis nearest to the light's, where every ray of the map goes along with it; else the light's.
        World = "world",
        /// Each ray of the map: the distance to the light's centre, and of a sun the light's axis.
        Distance = "distance",
    }
}

/// The least cosine between a ray and the axis: depths along the ray shrink by it, and their errors do not.
const LEAST_COSINE: f32 = 0.4;

/// Where t is 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthRange {
    /// Unit, in light space: along right, up and axis.
    pub(crate) axis: Vec3,
    /// Whether depth is the distance to the view's origin in its place.
    pub(crate) is_distance: bool,
    /// Metres from the view's origin.
    pub(crate) near_m: f32,
    /// See [`Self::near_m`].
    pub(crate) far_m: f32,
}

impl DepthRange {
    /// Along the light's axis: all that the view holds.
    pub(crate) fn of_view(view: &LightViewGpu) -> Self {
        Self { axis: Vec3::Z, is_distance: false, near_m: view.near_m, far_m: view.far_m }
    }

    /// No farther than the farthest of points that hold every receiver; as it is without any. What lies behind shades none,
    /// and texels without a caster, which count as the far end, are as near as they may be: two moments take each for an
    /// occluder, and the farther it lies the less they say of what is before it.
    pub(crate) fn up_to(self, view: &LightViewGpu, receivers: &[Vec3]) -> Self {
        let along = |p: &Vec3| {
            let from_light = *p - view.origin_in_world;
            if self.is_distance { from_light.length() } else { from_light.dot(view.axis_in_world) }
        };
        let farthest = receivers.iter().map(along).fold(f32::NEG_INFINITY, f32::max);
        if farthest <= self.near_m {
            return self;
        }
        let pad = 1e-3 * (farthest - self.near_m);
        Self { far_m: self.far_m.min(farthest + pad), ..self }
    }

    /// Along the world's axis nearest to the light's: what receives, and what casts before it. None where a ray of the view goes
    /// across it.
    pub(crate) fn along_world(view: &LightView, casters: &Between, receivers: &[Vec3]) -> Option<Self> {
        let frame = &view.frame;
        let nearest = frame.axis.abs().max_position();
        let axis_in_world = Vec3::AXES[nearest] * frame.axis[nearest].signum();
        let in_light = |v: Vec3| Vec3::new(v.dot(frame.right), v.dot(frame.up), v.dot(frame.axis));
        let axis = in_light(axis_in_world);
        let window = &view.window;
        let corners = [Vec2::ONE, Vec2::NEG_ONE, Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0)];
        let goes_along = |corner: Vec2| {
            let offset = window.half_size * corner;
            let in_plane = window.center + offset.x * window.roll + offset.y * window.roll.perp();
            let ray = if view.perspective { in_plane.extend(1.0).normalize() } else { Vec3::Z };
            ray.dot(axis) >= LEAST_COSINE
        };
        if !corners.into_iter().all(goes_along) {
            return None;
        }
        let along = |p: Vec3| (p - frame.center).dot(axis_in_world);
        let of_casters: Vec<f32> = casters.known.iter().flat_map(Aabb::corners).map(along).collect();
        let (mut near_m, mut far_m) =
            ends_of(receivers.iter().copied().map(along), &of_casters, casters.unknown.is_some());
        if let Some(unknown) = casters.unknown {
            // What lies farther before all that receives than that is deep counts as so far before it.
            let nearest = unknown.corners().into_iter().map(along).fold(near_m, f32::min);
            near_m = nearest.max(near_m - (far_m - near_m));
        }
        let pad = 1e-3 * (far_m - near_m);
        (near_m, far_m) = (near_m - pad, far_m + pad);
        if view.perspective {
            near_m = near_m.max(0.0);
        }
        (far_m - near_m > 0.0).then_some(Self { axis, is_distance: false, near_m, far_m })
    }

    /// By distance to the light's centre: what receives, and what casts before it. None for a sun, which has no centre.
    pub(crate) fn by_distance(view: &LightView, casters: &Between, receivers: &[Vec3]) -> Option<Self> {
        if !view.perspective {
            return None;
        }
        let center = view.frame.center;
        // A box's nearest point may lie on a side of it.
        let nearest = casters.all().map(|bounds| center.clamp(bounds.min, bounds.max));
        let farthest = casters.all().flat_map(|bounds| bounds.corners());
        let of_casters: Vec<f32> = nearest.chain(farthest).map(|p| p.distance(center)).collect();
        let (near_m, far_m) =
            ends_of(receivers.iter().map(|p| p.distance(center)), &of_casters, casters.unknown.is_some());
        let pad = 1e-3 * (far_m - near_m);
        (far_m > near_m).then_some(Self {
            axis: Vec3::Z,
            is_distance: true,
            near_m: (near_m - pad).max(0.0),
            far_m: far_m + pad,
        })
    }

    /// By distance to the light's centre: all that the view holds. None for a sun.
    pub(crate) fn of_view_by_distance(view: &LightViewGpu) -> Option<Self> {
        if view.perspective == 0 {
            return None;
        }
        // The longest of the rays through the window's corners, of those that go 1 m along the axis.
        let [a, b, c, d] = view.plane_from_uv;
        let ray_m = |corner: Vec2| {
            let from_origin = corner - view.uv_origin;
            let plane = Vec2::new(a, b) * from_origin.x + Vec2::new(c, d) * from_origin.y;
            plane.extend(1.0).length()
        };
        let longest = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].map(ray_m).into_iter().fold(1.0, f32::max);
        Some(Self { axis: Vec3::Z, is_distance: true, near_m: view.near_m, far_m: longest * view.far_m })
    }
}

/// The nearest and the farthest of all depths; where casters may be anywhere, the farthest of the receivers': what lies behind all
/// of them shades none.
fn ends_of(receivers: impl Iterator<Item = f32> + Clone, casters: &[f32], are_anywhere: bool) -> (f32, f32) {
    let all = || receivers.clone().chain(casters.iter().copied());
    let farthest = if are_anywhere { receivers.clone().reduce(f32::max) } else { None };
    let nearest = all().fold(f32::INFINITY, f32::min);
    (nearest, farthest.unwrap_or_else(|| all().fold(f32::NEG_INFINITY, f32::max)))
}

#[cfg(test)]
mod tests {
    use antumbra_light::{Light, LightShape};

    use super::*;
    use crate::light_map::central_view::fit_light_view;

    /// A floor below a point's light: its nearest point lies below the light, its farthest at a corner.
    #[test]
    fn distances_hold_what_casts_and_receives() {
        let light = Light::new(LightShape::Sphere { radius_m: 0.1 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
        let floor = Aabb { min: Vec3::new(-4.0, -0.1, -3.0), max: Vec3::new(4.0, 0.0, 3.0) };
        let view = fit_light_view(&light, &[floor], &[]);
        let casters = Between::of_known(&[floor]);
        let range = DepthRange::by_distance(&view, &casters, &[]).expect("a light with a centre");
        assert!(range.is_distance && (range.near_m - 5.0).abs() < 0.01, "{range:?}");
        let corner_m = Vec3::new(4.0, 5.1, 3.0).length();
        assert!((range.far_m - corner_m).abs() < 0.01, "{range:?}");
        // All that the view holds, and no receiver farther than those there are.
        let gpu_view = view.to_gpu(64);
        let all = DepthRange::of_view_by_distance(&gpu_view).expect("a light with a centre");
        assert!(all.near_m <= range.near_m && all.far_m >= range.far_m, "{all:?}");
        let below = all.up_to(&gpu_view, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)]);
        assert!((below.far_m - 34.0f32.sqrt()).abs() < 0.01, "{below:?}");
        let sun = Light { shape: LightShape::Sun { angular_diameter_rad: 0.01 }, ..light };
        assert_eq!(DepthRange::by_distance(&fit_light_view(&sun, &[floor], &[]), &casters, &[]), None);
    }
}
