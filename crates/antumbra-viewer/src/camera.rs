//! Camera motions: orbit, look, pan, zoom and flight.
//!
//! Every motion keeps the camera usable: the view never becomes parallel to the up hint, and the eye never reaches the
//! target.

use antumbra_scene::Camera;
use glam::{Quat, Vec2, Vec3};

/// Minimum angle between view direction and up hint, radians: the horizon is still well defined there.
const MIN_POLE_ANGLE_RAD: f32 = 0.02;

/// Unit vectors of the image's axes in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Into the image.
    pub forward: Vec3,
    /// To the image's right.
    pub right: Vec3,
    /// To the image's top.
    pub up: Vec3,
}

/// Returns the image's axes.
pub fn axes(camera: &Camera) -> Axes {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    Axes { forward, right, up: right.cross(forward) }
}

/// Turns `forward` by `yaw_rad` about the up hint, to the left, and by `pitch_rad` upwards, but never past a pole.
fn turned(camera: &Camera, yaw_rad: f32, pitch_rad: f32) -> Vec3 {
    let Axes { forward, right, .. } = axes(camera);
    let pole = camera.up.normalize();
    let angle_from_pole = forward.angle_between(pole);
    let room = MIN_POLE_ANGLE_RAD..=std::f32::consts::PI - MIN_POLE_ANGLE_RAD;
    let pitch_rad = angle_from_pole - (angle_from_pole - pitch_rad).clamp(*room.start(), *room.end());
    (Quat::from_axis_angle(pole, yaw_rad) * Quat::from_axis_angle(right, pitch_rad) * forward).normalize()
}

/// Moves the eye around the target, so that the view turns by these angles.
pub fn orbit(camera: &mut Camera, yaw_rad: f32, pitch_rad: f32) {
    let distance = camera.eye.distance(camera.target);
    camera.eye = camera.target - distance * turned(camera, yaw_rad, pitch_rad);
}

/// Turns the view about the eye.
pub fn look(camera: &mut Camera, yaw_rad: f32, pitch_rad: f32) {
    let distance = camera.eye.distance(camera.target);
    camera.target = camera.eye + distance * turned(camera, yaw_rad, pitch_rad);
}

/// Moves eye and target parallel to the image; `by_heights` is in image heights, right and down. Points at the target's
/// distance follow the pointer.
pub fn pan(camera: &mut Camera, by_heights: Vec2) {
    let Axes { right, up, .. } = axes(camera);
    let height_m = 2.0 * camera.eye.distance(camera.target) * (0.5 * camera.fov_y_rad).tan();
    let offset = height_m * (up * by_heights.y - right * by_heights.x);
    camera.eye += offset;
    camera.target += offset;
}

/// Multiplies the distance to the target.
pub fn zoom(camera: &mut Camera, factor: f32) {
    let away = camera.eye - camera.target;
    // The near plane would cut off a nearer target; single precision would lose a farther one.
    let min_m = 4.0 * camera.near_m;
    let distance = (away.length() * factor).clamp(min_m, 1e6 * min_m);
    camera.eye = camera.target + distance * away.normalize();
}

/// Moves eye and target along the image's axes, metres: right, up, forward.
pub fn fly(camera: &mut Camera, by_m: Vec3) {
    let Axes { forward, right, up } = axes(camera);
    let offset = right * by_m.x + up * by_m.y + forward * by_m.z;
    camera.eye += offset;
    camera.target += offset;
}

#[cfg(test)]
mod tests {
    use antumbra_scene::Aabb;

    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: Vec3::new(3.0, 2.0, 6.0),
            target: Vec3::new(0.0, 0.5, 0.0),
            up: Vec3::Y,
            fov_y_rad: 0.8,
            near_m: 0.05,
            far_m: 100.0,
            shadow_distance: None,
        }
    }

    #[test]
    fn orbiting_keeps_distance_and_never_passes_a_pole() {
        let mut moved = camera();
        let distance = moved.eye.distance(moved.target);
        for step in 0..200 {
            orbit(&mut moved, 0.1, if step < 100 { 0.3 } else { -0.3 });
            let Axes { forward, right, up } = axes(&moved);
            assert!(forward.is_finite() && right.is_finite() && up.dot(Vec3::Y) > 0.0, "step {step}: {moved:?}");
            assert!((moved.eye.distance(moved.target) - distance).abs() < 1e-3 * distance);
        }
        let mut looked = camera();
        look(&mut looked, 0.0, -9.0);
        assert_eq!(looked.eye, camera().eye);
        assert!(axes(&looked).forward.y < -0.99);
    }

    #[test]
    fn panning_follows_the_hand() {
        let mut moved = camera();
        let size = glam::UVec2::new(160, 90);
        let place = |camera: &Camera, x: Vec3| {
            let ndc = (camera.clip_from_view(size) * camera.view_from_world()).project_point3(x);
            Vec2::new(ndc.x, -ndc.y) * 0.5 * size.as_vec2() / 90.0
        };
        let before = place(&moved, camera().target);
        pan(&mut moved, Vec2::new(0.25, -0.125));
        let by = place(&moved, camera().target) - before;
        assert!(by.abs_diff_eq(Vec2::new(0.25, -0.125), 1e-3), "{by}");
    }

    #[test]
    fn zooming_and_framing_end_where_everything_is_seen() {
        let mut moved = camera();
        for _ in 0..500 {
            zoom(&mut moved, 0.5);
        }
        assert!(moved.eye.distance(moved.target) > moved.near_m);
        let bounds = Aabb { min: Vec3::new(-3.0, 0.0, -1.0), max: Vec3::new(5.0, 4.0, 1.0) };
        let forward = axes(&moved).forward;
        for size_px in [glam::UVec2::new(50, 100), glam::UVec2::new(160, 90)] {
            moved.frame(bounds, size_px.x as f32 / size_px.y as f32);
            assert!(axes(&moved).forward.abs_diff_eq(forward, 1e-4));
            let clip = moved.clip_from_view(size_px) * moved.view_from_world();
            let corners = bounds.corners().map(|corner| clip.project_point3(corner));
            let widest = corners.iter().fold(Vec2::ZERO, |widest, ndc| widest.max(ndc.truncate().abs()));
            assert!(widest.max_element() <= 1.0 && widest.max_element() > 0.9, "{size_px}: {widest}");
        }
    }
}
