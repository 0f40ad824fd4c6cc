//! Fraction of the image that a light's range may cover.

use std::f64::consts::FRAC_PI_4;

use antumbra_light::Aabb;
use glam::DVec4;

use crate::casters::Ball;
use crate::contract::{Camera, PreparedReceivers, Receivers};

/// Space that a camera sees, with the bounds of the receivers there.
#[derive(Debug)]
pub(super) struct SeenSpace {
    camera: Camera,
    /// Frustum planes, and the plane of the shadow distance if there is one.
    planes: Vec<DVec4>,
    /// Box of the receivers; `None` if the host gives none.
    bounds: Option<Aabb>,
}

impl SeenSpace {
    pub(super) fn of(receivers: &Receivers<'_>) -> Self {
        let prepared = PreparedReceivers::from(*receivers);
        let mut planes: Vec<DVec4> = prepared.frustum_planes().into_iter().flatten().collect();
        planes.extend(prepared.shadow_end_plane());
        let of_hull = (!receivers.hull.is_empty()).then(|| Aabb::of(receivers.hull.iter().copied()));
        Self { camera: receivers.camera(), planes, bounds: of_hull.or(receivers.bounds) }
    }

    /// Returns the fraction of the image that a ball may cover, 0 to 1; `None` if no receiver in the ball can be visible.
    pub(super) fn share_of(&self, ball: &Ball) -> Option<f32> {
        let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius_m));
        let is_beyond = |plane: &DVec4| plane.dot(center.extend(1.0)) < -radius * plane.truncate().length();
        let is_seen = !self.planes.iter().any(is_beyond) && self.bounds.is_none_or(|bounds| ball.touches(&bounds));
        is_seen.then(|| self.area_of(ball) as f32)
    }

    /// Returns the area of an ellipse around the ball as if it were in the middle of the image; 1 if the ball contains the eye.
    fn area_of(&self, ball: &Ball) -> f64 {
        let Camera { view_from_world, clip_from_view, .. } = &self.camera;
        let radius = f64::from(ball.radius_m);
        let is_parallel = clip_from_view.row(3).truncate() == glam::Vec3::ZERO;
        let along_view = view_from_world.as_dmat4().transform_point3(ball.center.as_dvec3());
        let distance_squared = along_view.length_squared();
        if !is_parallel && distance_squared <= radius * radius {
            return 1.0;
        }
        // Tangent of the angle between the ball's centre and its rim.
        let tangent = if is_parallel { radius } else { radius / (distance_squared - radius * radius).sqrt() };
        let half = |axis: glam::Vec4| tangent * f64::from(axis.truncate().length());
        (FRAC_PI_4 * half(clip_from_view.row(0)) * half(clip_from_view.row(1))).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::{proj::directx, view::look_at_mat4};
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::contract::DepthConvention;

    /// Space of a camera at the origin that looks along −z.
    fn space(clip_from_view: Mat4, bounds: Option<Aabb>, end_m: Option<f32>) -> SeenSpace {
        let camera = Camera {
            view_from_world: look_at_mat4(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y),
            clip_from_view,
            depth_convention: DepthConvention::Reversed,
        };
        // The camera looks along −z from the origin.
        let end = end_m.map(|end_m| DVec4::new(0.0, 0.0, 1.0, f64::from(end_m)));
        SeenSpace { camera, planes: camera.frustum_planes().into_iter().chain(end).collect(), bounds }
    }

    fn perspective() -> Mat4 {
        directx::perspective_infinite_reverse(std::f32::consts::FRAC_PI_2, 1.0, 0.1)
    }

    fn ball(center: [f32; 3], radius_m: f32) -> Ball {
        Ball { center: Vec3::from(center), radius_m }
    }

    #[test]
    fn balls_beside_the_view_are_not_seen() {
        let seen = space(perspective(), None, None);
        for (ball, is_seen) in [
            (ball([0.0, 0.0, -5.0], 1.0), true),
            (ball([0.0, 0.0, 5.0], 1.0), false),
            (ball([0.0, 0.0, 5.0], 5.1), true),
            // The view's side is at 45 degrees: 10 / √2 away.
            (ball([15.0, 0.0, -5.0], 7.0), false),
            (ball([15.0, 0.0, -5.0], 7.1), true),
            (ball([500.0, 0.0, 5.0], f32::INFINITY), true),
        ] {
            assert_eq!(seen.share_of(&ball).is_some(), is_seen, "{ball:?}");
        }
        let near = Aabb { min: Vec3::new(-1.0, -1.0, -3.0), max: Vec3::new(1.0, 1.0, -1.0) };
        let far_ball = ball([0.0, 0.0, -9.0], 5.0);
        assert!(seen.share_of(&far_ball).is_some());
        assert!(space(perspective(), Some(near), None).share_of(&far_ball).is_none());
        assert!(space(perspective(), None, Some(3.9)).share_of(&far_ball).is_none());
        assert!(space(perspective(), Some(Aabb::EMPTY), None).share_of(&far_ball).is_none());
    }

    #[test]
    fn shares_are_areas_of_the_image() {
        let seen = space(perspective(), None, None);
        // A rim at 45 degrees touches all four sides.
        let touching = ball([0.0, 0.0, -(2f32.sqrt())], 1.0);
        let share = |seen: &SeenSpace, ball: &Ball| seen.share_of(ball).expect("seen");
        assert!((share(&seen, &touching) - std::f32::consts::FRAC_PI_4).abs() < 1e-5);
        assert_eq!(share(&seen, &ball([0.0, 0.0, -1.0], 2.0)), 1.0);
        assert_eq!(share(&seen, &ball([0.0, 0.0, -1.0], f32::INFINITY)), 1.0);
        let halves = [4.0, 8.0].map(|z| share(&seen, &ball([0.0, 0.0, -z], 0.1)));
        assert!((halves[0] / halves[1] - 4.0).abs() < 0.01, "{halves:?}");
        // Four metres wide and high, wherever the ball is.
        let parallel = space(directx::orthographic(-2.0, 2.0, -2.0, 2.0, 20.0, 0.1), None, None);
        for z in [3.0, 9.0] {
            let got = share(&parallel, &ball([0.0, 0.0, -z], 1.0));
            assert!((got - std::f32::consts::PI / 16.0).abs() < 1e-5, "{got}");
        }
    }
}
