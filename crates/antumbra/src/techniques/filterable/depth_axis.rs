//! The direction in which filtered depths are measured.
//!
//! A filtered map may measure depth along any direction that every ray of its view goes forward in: what is nearer on a ray
//! stays nearer. Along the light's own axis a floor that is lit at a slant has another depth in each texel; two moments take
//! that spread for a second occluder, four have nothing left for a third. Along the floor's normal it has one.
//! What is built lies along the world's axes, most of it, so the one nearest to the light's axis is the best guess.

use antumbra_light::Aabb;
use glam::{Vec2, Vec3};

use crate::contract::param_choice;
use crate::light_map::light_view::{LightView, LightViewGpu};

param_choice! {
    /// The direction in which a filterable map measures depth.
    pub enum DepthAxis {
        /// The light's axis.
        Light = "light",
        /// The world's axis nearest to the light's, where every ray of the map goes along with it; else the light's.
        World = "world",
    }
}

/// The least cosine between a ray and the axis: depths along the ray shrink by it, and their errors do not.
const LEAST_COSINE: f32 = 0.4;

/// Where t is 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthRange {
    /// Unit, in light space: along right, up and axis.
    pub(crate) axis: Vec3,
    /// Metres along it from the view's origin.
    pub(crate) near_m: f32,
    /// See [`Self::near_m`].
    pub(crate) far_m: f32,
}

impl DepthRange {
    /// Along the light's axis: all that the view holds.
    pub(crate) fn of_view(view: &LightViewGpu) -> Self {
        Self { axis: Vec3::Z, near_m: view.near_m, far_m: view.far_m }
    }

    /// No farther than the farthest of points that hold every receiver; as it is without any. What lies behind shades none,
    /// and texels without a caster, which count as the far end, are as near as they may be: two moments take each for an
    /// occluder, and the farther it lies the less they say of what is before it.
    pub(crate) fn up_to(self, view: &LightViewGpu, receivers: &[Vec3]) -> Self {
        let along = |p: &Vec3| (*p - view.origin_in_world).dot(view.axis_in_world);
        let farthest = receivers.iter().map(along).fold(f32::NEG_INFINITY, f32::max);
        if farthest <= self.near_m {
            return self;
        }
        let pad = 1e-3 * (farthest - self.near_m);
        Self { far_m: self.far_m.min(farthest + pad), ..self }
    }

    /// Along the world's axis nearest to the light's: what casts and what receives. None where a ray of the view goes
    /// across it.
    pub(crate) fn along_world(view: &LightView, casters: &[Aabb], receivers: &[Vec3]) -> Option<Self> {
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
        let (mut near_m, mut far_m) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in casters.iter().flat_map(Aabb::corners) {
            near_m = near_m.min(along(corner));
            far_m = far_m.max(along(corner));
        }
        far_m = receivers.iter().fold(far_m, |far, p| far.max(along(*p)));
        let pad = 1e-3 * (far_m - near_m);
        (near_m, far_m) = (near_m - pad, far_m + pad);
        if view.perspective {
            near_m = near_m.max(0.0);
        }
        (far_m - near_m > 0.0).then_some(Self { axis, near_m, far_m })
    }
}
