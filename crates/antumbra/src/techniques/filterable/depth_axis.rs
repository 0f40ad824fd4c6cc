//! Direction in which filtered depths are measured.
//!
//! A filtered map may measure depth along any direction along which every ray of its view runs forward: the order of depths on
//! a ray is then kept. Along the light's own axis, a floor that is lit at a slant has a different depth in each texel. Two
//! moments take this spread for a second occluder, and four have nothing left for a third. Along the floor's normal it has one
//! depth. Most built geometry lies along the world axes, so the axis nearest to the light's is the best guess.
//!
//! Lauritzen and McCool 2008, section 5, measure "the normalized Euclidean distance to the light point or plane", along each
//! ray of the map. A floor then has a different depth in each texel even straight below the light.

use antumbra_light::Aabb;
use glam::{Vec2, Vec3};

use crate::contract::param_choice;
use crate::light_map::light_view::{LightView, LightViewGpu};
use crate::light_map::occluding_bounds::OccludingBounds;

param_choice! {
    /// Direction in which a filterable map measures depth.
    pub enum DepthAxis {
        /// The light's axis.
        Light = "light",
        /// World axis nearest to the light's axis if every ray of the map runs forward along it; otherwise the light's axis.
        World = "world",
        /// Each ray of the map: the distance to the light's centre. A sun uses its axis.
        Distance = "distance",
    }
}

/// Smallest cosine allowed between a ray and the axis: depths along the ray shrink by it, while their errors do not.
const MIN_COSINE: f32 = 0.4;

/// Depth axis and range of a map: t is 0 at `near_m` and 1 at `far_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthRange {
    /// Unit vector in light space: right, up, axis.
    pub(crate) axis: Vec3,
    /// Whether depth is the distance to the view's origin instead.
    pub(crate) is_distance: bool,
    /// Depth at which t is 0, metres from the view's origin.
    pub(crate) near_m: f32,
    /// Depth at which t is 1; see [`Self::near_m`].
    pub(crate) far_m: f32,
}

impl DepthRange {
    /// Returns the whole range of the view along the light's axis.
    pub(crate) fn of_view(view: &LightViewGpu) -> Self {
        Self { axis: Vec3::Z, is_distance: false, near_m: view.near_m, far_m: view.far_m }
    }

    /// Cuts the range at the farthest of `receivers`, points that enclose every receiver; none leave it unchanged. Geometry
    /// behind them shades nothing. Texels without a caster count as the far end, so it should be near: two moments take such a
    /// texel for an occluder, and the farther it lies, the less they resolve in front of it.
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

    /// Returns the range of receivers, and of casters in front of them, along the world axis nearest to the light's. `None` if
    /// a ray of the view runs at too large an angle to the axis.
    pub(crate) fn along_world(view: &LightView, casters: &OccludingBounds, receivers: &[Vec3]) -> Option<Self> {
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
            ray.dot(axis) >= MIN_COSINE
        };
        if !corners.into_iter().all(goes_along) {
            return None;
        }
        let along = |p: Vec3| (p - frame.center).dot(axis_in_world);
        let of_casters: Vec<f32> = casters.known.iter().flat_map(Aabb::corners).map(along).collect();
        let (mut near_m, mut far_m) =
            ends_of(receivers.iter().copied().map(along), &of_casters, casters.unknown.is_some());
        if let Some(unknown) = casters.unknown {
            // Unknown casters at most double the range; those even nearer to the light are clamped to its near end.
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

    /// Returns the range of receivers and casters by distance to the light's centre. `None` for a sun, which has no centre.
    pub(crate) fn by_distance(view: &LightView, casters: &OccludingBounds, receivers: &[Vec3]) -> Option<Self> {
        if !view.perspective {
            return None;
        }
        let center = view.frame.center;
        // A box's nearest point may lie on a face, not at a corner.
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

    /// Returns the whole range of the view by distance to the light's centre. `None` for a sun.
    pub(crate) fn of_view_by_distance(view: &LightViewGpu) -> Option<Self> {
        if view.perspective == 0 {
            return None;
        }
        // The longest ray through a corner of the window, per metre along the axis.
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

/// Returns the nearest and the farthest of all depths. If casters may be anywhere, the farthest is that of the receivers,
/// because geometry behind all of them shades nothing.
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

    /// A floor below a point light: its nearest point lies below the light, its farthest at a corner.
    #[test]
    fn distances_hold_what_casts_and_receives() {
        let light = Light::new(LightShape::Sphere { radius_m: 0.1 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
        let floor = Aabb { min: Vec3::new(-4.0, -0.1, -3.0), max: Vec3::new(4.0, 0.0, 3.0) };
        let view = fit_light_view(&light, &[floor], &[]);
        let casters = OccludingBounds::of_known(&[floor]);
        let range = DepthRange::by_distance(&view, &casters, &[]).expect("a light with a centre");
        assert!(range.is_distance && (range.near_m - 5.0).abs() < 0.01, "{range:?}");
        let corner_m = Vec3::new(4.0, 5.1, 3.0).length();
        assert!((range.far_m - corner_m).abs() < 0.01, "{range:?}");
        // The view's range contains it, and receivers cut it at the farthest of them.
        let gpu_view = view.to_gpu(64);
        let all = DepthRange::of_view_by_distance(&gpu_view).expect("a light with a centre");
        assert!(all.near_m <= range.near_m && all.far_m >= range.far_m, "{all:?}");
        let below = all.up_to(&gpu_view, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)]);
        assert!((below.far_m - 34.0f32.sqrt()).abs() < 0.01, "{below:?}");
        let sun = Light { shape: LightShape::Sun { angular_diameter_rad: 0.01 }, ..light };
        assert_eq!(DepthRange::by_distance(&fit_light_view(&sun, &[floor], &[]), &casters, &[]), None);
    }
}
