//! A camera and a light for scenes that bring none.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::FOV_Y_DEGREES;
use crate::Camera;

/// From the middle of the scene towards the camera: a three-quarter view from above, as product pictures have it.
const TOWARDS_CAMERA: Vec3 = Vec3::new(0.55, 0.45, 1.0);
/// From the middle of the scene towards the key light: above, and to the camera's left, so that shadows fall to the
/// right and are not hidden behind what casts them.
const TOWARDS_LIGHT: Vec3 = Vec3::new(-0.55, 1.0, 0.4);
/// The key light stands this many diagonals from the middle: outside the box, whose corners are half a diagonal away.
const LIGHT_DISTANCE_DIAGONALS: f32 = 0.9;
/// Side of the key light over the diagonal: soft enough to see, small enough that contact shadows stay sharp.
const LIGHT_SIDE_DIAGONALS: f32 = 1.0 / 12.0;
/// Room around the scene's box in the picture.
const MARGIN: f32 = 1.05;

/// A sphere about the scene that an f32 can resolve, wherever it is.
fn sphere(bounds: Aabb) -> (Vec3, f32) {
    if bounds.is_empty() {
        return (Vec3::ZERO, 1.0);
    }
    let center = bounds.center();
    // Far from the origin neighbouring f32 numbers lie 1e-7 of the distance apart; a hundred of them are the least
    // that a view direction can be made of. The other bound keeps squares from vanishing.
    let smallest = (1e-5 * center.length()).max(1e-9);
    (center, (0.5 * bounds.diagonal()).max(smallest))
}

/// A camera that a box fills the picture of, whatever the picture's format down to a square.
pub(super) fn camera(bounds: Aabb) -> Camera {
    let (center, radius) = sphere(bounds);
    let fov_y_rad = (FOV_Y_DEGREES as f32).to_radians();
    let towards = TOWARDS_CAMERA.normalize();
    let right = Vec3::Y.cross(towards).normalize();
    let up = towards.cross(right);
    let slope = (0.5 * fov_y_rad).tan() / MARGIN;
    // From so far a corner lies within the picture: |across| ≤ slope · (distance − nearer).
    let enough = |corner: Vec3| {
        let offset = corner - center;
        let across = offset.dot(right).abs().max(offset.dot(up).abs());
        across / slope + offset.dot(towards)
    };
    // A box of nothing has no corners, and one without extent is a point.
    let corners = if bounds.is_empty() { [center; 8] } else { bounds.corners() };
    let distance = corners.into_iter().map(enough).fold(radius, f32::max);
    Camera {
        eye: center + distance * towards,
        target: center,
        up: Vec3::Y,
        fov_y_rad,
        near_m: 0.01 * distance,
        far_m: 2.0 * (distance + radius),
        shadow_distance: None,
    }
}

/// The place in a box at these fractions of its extent.
pub(super) fn place_within(bounds: Aabb, fractions: Vec3) -> Vec3 {
    bounds.min + fractions * (bounds.max - bounds.min)
}

/// One rectangle above and beside a box.
pub(super) fn key_light(bounds: Aabb) -> Light {
    let (center, radius) = sphere(bounds);
    let diagonal = 2.0 * radius;
    let position = center + LIGHT_DISTANCE_DIAGONALS * diagonal * TOWARDS_LIGHT.normalize();
    Light::new(LightShape::Rectangle { size_m: Vec2::splat(LIGHT_SIDE_DIAGONALS * diagonal) }, position, center)
}
