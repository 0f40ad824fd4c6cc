//! Volume that a convex body sweeps towards a sun; it contains all occluders of the body.

use antumbra_light::{Aabb, Light, polytope_corners};
use glam::{DVec4, Vec2, Vec3};

/// Bounds of a body along a sun's axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweep {
    axes: [Vec3; 3],
    min: Vec2,
    max: Vec2,
    nearest: f32,
    deepest: f32,
    /// Tangent of the half angle of the cone of light directions around the axis.
    tangent: f32,
}

impl Sweep {
    /// Returns the sweep of the convex hull of `points`.
    pub(crate) fn of(sun: &Light, points: &[Vec3]) -> Self {
        let frame = sun.frame();
        let mut sweep = Self {
            axes: [frame.right, frame.up, frame.axis],
            min: Vec2::INFINITY,
            max: Vec2::NEG_INFINITY,
            nearest: f32::INFINITY,
            deepest: f32::NEG_INFINITY,
            tangent: sun.bounding_radius(),
        };
        for point in points {
            let p = sweep.along_axes(*point);
            (sweep.min, sweep.max) = (sweep.min.min(p.truncate()), sweep.max.max(p.truncate()));
            (sweep.nearest, sweep.deepest) = (sweep.nearest.min(p.z), sweep.deepest.max(p.z));
        }
        sweep
    }

    /// Whether this volume contains another one along the same axes.
    #[cfg(test)]
    pub(crate) fn holds(&self, other: &Self) -> bool {
        let across = self.min.cmple(other.min).all() && self.max.cmpge(other.max).all();
        across && self.deepest >= other.deepest
    }

    /// Longer side across the axis, metres.
    #[cfg(test)]
    pub(crate) fn width(&self) -> f32 {
        (self.max - self.min).max_element()
    }

    fn along_axes(&self, x: Vec3) -> Vec3 {
        Vec3::from_array(self.axes.map(|axis| axis.dot(x)))
    }

    /// Returns bounds of the part of a box that may lie between the body and the sun, at most `reach_m` in front of the body; `None`
    /// if there is no such part. For boxes of any extent.
    pub(crate) fn part_within(&self, bounds: &Aabb, reach_m: f32) -> Option<Aabb> {
        let reach = self.tangent * (self.deepest - self.nearest + reach_m);
        let axis = self.axes[2].as_dvec3();
        let before = axis.extend(f64::from(reach_m - self.nearest));
        self.cut(bounds, self.min - reach, self.max + reach, Some(before))
    }

    /// Returns bounds of the part of a box that may lie between the body and the sun; `None` if there is no such part.
    pub(crate) fn part_of(&self, bounds: &Aabb) -> Option<Aabb> {
        let corners = Aabb::of(bounds.corners().map(|corner| self.along_axes(corner)));
        // The cone widens with the distance in front of the body.
        let reach = self.tangent * (self.deepest - corners.min.z).max(0.0);
        let (min, max) = (self.min - reach, self.max + reach);
        let is_beside = corners.max.truncate().cmplt(min).any() || corners.min.truncate().cmpgt(max).any();
        if is_beside || corners.min.z > self.deepest {
            return None;
        }
        // Under a low sun, a ground's box is a thousand times as deep as its part in front of a few metres. Boxes hardly
        // wider than the sweep are not cut.
        let is_wide = (corners.max - corners.min).truncate().max_element() > 2.0 * (max - min).max_element();
        Some(if is_wide { self.cut(bounds, min, max, None).unwrap_or(*bounds) } else { *bounds })
    }

    /// Returns bounds of the part of a box within these sides, not behind the body, and in front of the plane `more`.
    fn cut(&self, bounds: &Aabb, min: Vec2, max: Vec2, more: Option<DVec4>) -> Option<Aabb> {
        let [right, up, axis] = self.axes.map(Vec3::as_dvec3);
        let (min, max) = (min.as_dvec2(), max.as_dvec2());
        let sides = [
            right.extend(-min.x),
            (-right).extend(max.x),
            up.extend(-min.y),
            (-up).extend(max.y),
            (-axis).extend(f64::from(self.deepest)),
        ];
        let planes = [&sides[..], &bounds.planes(), more.as_slice()].concat();
        // Scale of the rounding tolerance: the largest possible size of the cut.
        let size_m = f64::from(bounds.diagonal()).min((max - min).length() + f64::from(self.deepest - self.nearest));
        let cut = Aabb::of(polytope_corners(&planes, size_m));
        (!cut.is_empty()).then_some(Aabb { min: cut.min.max(bounds.min), max: cut.max.min(bounds.max) })
    }
}
