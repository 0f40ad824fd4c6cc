//! Ball around a light: casters outside it cast no shadow within the light's range.

use antumbra_light::Aabb;
use glam::Vec3;

/// Ball, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    /// Centre.
    pub(crate) center: Vec3,
    /// Radius, metres; may be infinite.
    pub(crate) radius_m: f32,
}

impl Ball {
    /// Whether a box reaches into the ball: false for an empty box, true for one with NaN.
    pub(crate) fn touches(&self, bounds: &Aabb) -> bool {
        if bounds.is_empty() {
            return false;
        }
        let off = (bounds.min - self.center).max(self.center - bounds.max).max(Vec3::ZERO);
        // Double precision, because squared distances from boxes of unknown size could be infinite.
        let is_outside = off.as_dvec3().length_squared() > f64::from(self.radius_m).powi(2);
        !is_outside
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_inside_where_their_nearest_point_is() {
        let ball = |radius_m| Ball { center: Vec3::new(1.0, 2.0, 3.0), radius_m };
        let unit_box_at = |min: Vec3| Aabb { min, max: min + 1.0 };
        // The nearest corner is at (3, 4, 4), three metres away.
        let corner = unit_box_at(Vec3::new(3.0, 4.0, 4.0));
        assert!(ball(3.001).touches(&corner) && !ball(2.999).touches(&corner));
        // The box contains the centre.
        assert!(ball(0.0).touches(&unit_box_at(Vec3::new(0.5, 1.5, 2.5))));
        let unknown = Aabb { min: Vec3::splat(f32::NEG_INFINITY), max: Vec3::splat(f32::INFINITY) };
        let nan = Aabb { min: Vec3::NAN, max: Vec3::NAN };
        assert!(ball(0.1).touches(&unknown) && ball(f32::INFINITY).touches(&corner));
        assert!(!ball(f32::INFINITY).touches(&Aabb::EMPTY) && ball(1.0).touches(&Aabb { min: nan.min, ..unknown }));
    }
}
