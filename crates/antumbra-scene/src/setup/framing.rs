//! Default camera and light for scenes that have none.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::FOV_Y_DEGREES;
use crate::{Camera, Scene};

/// Direction from the scene's centre to the camera: a three-quarter view from above, as in product images.
const TOWARDS_CAMERA: Vec3 = Vec3::new(0.55, 0.45, 1.0);
/// Direction from the scene's centre to the key light: above, and to the camera's left, so that shadows fall to the
/// right and are not hidden behind their casters.
const TOWARDS_LIGHT: Vec3 = Vec3::new(-0.55, 1.0, 0.4);
/// Distance of the key light from the centre, in diagonals: outside the box, whose corners are half a diagonal away.
const LIGHT_DISTANCE_DIAGONALS: f32 = 0.9;
/// Side of the key light over the diagonal: soft enough to see, small enough that contact shadows stay sharp.
const LIGHT_SIDE_DIAGONALS: f32 = 1.0 / 12.0;
/// Factor for the margin around the scene's box in the image.
const MARGIN: f32 = 1.05;

/// Bounding sphere of the scene, large enough that an f32 resolves it at its position.
fn sphere(bounds: Aabb) -> (Vec3, f32) {
    if bounds.is_empty() {
        return (Vec3::ZERO, 1.0);
    }
    let center = bounds.center();
    // Far from the origin, neighbouring f32 numbers are 1e-7 of the distance apart. A view direction needs at least a
    // hundred such steps. The other bound keeps squares from vanishing.
    let smallest = (1e-5 * center.length()).max(1e-9);
    (center, (0.5 * bounds.diagonal()).max(smallest))
}

/// Subject of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Subject {
    /// Bounding box that fills the image.
    pub(super) bounds: Aabb,
    /// Bounding box of the scene, which may extend beyond the subject.
    pub(super) all: Aabb,
    /// Whether the shadow on the ground belongs to the subject, because it stands alone and will be put on a ground.
    pub(super) has_shadow: bool,
}

/// Largest diagonal of a small triangle's bounding box, over the diagonal of the subject's.
const SMALL: f32 = 1.0 / 8.0;
/// Largest diagonal of the box of all small triangles, over the subject's, at which the large triangles are a ground. No large triangle
/// may rise above that box's centre.
const SPECK: f32 = 1.0 / 3.0;

impl Subject {
    /// Returns the subject: the whole scene, or its small triangles if they are no more than a speck on its ground.
    ///
    /// A ground of two triangles, kilometres wide, must not determine the framing. Large triangles around or above objects are walls and
    /// roofs, and belong to the subject.
    pub(super) fn of(scene: &Scene) -> Self {
        let all = scene.bounds();
        let mut bounds = all;
        // Each iteration leaves at most a third, so a few are enough for any scene of floats.
        for _ in 0..8 {
            let small_m = SMALL * bounds.diagonal();
            let (mut speck, mut top_of_large_m) = (Aabb::EMPTY, f32::NEG_INFINITY);
            for triangle in scene.world_triangles() {
                let one = Aabb::of(triangle.positions);
                match one.diagonal() <= small_m {
                    true => speck = speck.union(one),
                    // Triangles that an earlier iteration left out are ignored.
                    false if one.diagonal() <= bounds.diagonal() => top_of_large_m = top_of_large_m.max(one.max.y),
                    false => {}
                }
            }
            let is_speck = speck.diagonal() > 0.0 && speck.diagonal() <= SPECK * bounds.diagonal();
            if speck.is_empty() || !is_speck || top_of_large_m > speck.center().y {
                break;
            }
            bounds = speck;
        }
        Self { bounds, all, has_shadow: scene.lacks_ground() }
    }

    /// Points that must be in the image: the corners of the box and, with `has_shadow`, of the shadow of its lower half. (Shadows of the
    /// upper half may have any length.)
    fn corners(&self) -> Vec<Vec3> {
        // An empty box has no corners.
        if self.bounds.is_empty() {
            return vec![Vec3::ZERO];
        }
        let mut corners = self.bounds.corners().to_vec();
        if self.has_shadow {
            let (Aabb { min, .. }, center, light) = (self.bounds, self.bounds.center(), key_light(self.bounds).center);
            let to_ground = (light.y - min.y) / (light.y - center.y);
            let shadow = |corner: &Vec3| light + to_ground * (corner.with_y(center.y) - light);
            let shadows: Vec<Vec3> = corners.iter().map(shadow).filter(|corner| corner.is_finite()).collect();
            corners.extend(shadows);
        }
        corners
    }
}

/// Returns a camera whose image a subject fills; `aspect` is width over height.
pub(super) fn camera(subject: &Subject, aspect: f32) -> Camera {
    let (center, radius) = sphere(subject.bounds);
    let fov_y_rad = (FOV_Y_DEGREES as f32).to_radians();
    let towards = TOWARDS_CAMERA.normalize();
    let corners: Vec<Vec3> = subject.corners().into_iter().map(|corner| corner - center).collect();
    let (offset, distance) = place_filled_by(&corners, towards, Vec3::Y, (0.5 * fov_y_rad).tan(), aspect, radius);
    let (center_of_all, radius_of_all) = sphere(subject.all);
    let target = center + offset;
    Camera {
        eye: target + distance * towards,
        target,
        up: Vec3::Y,
        fov_y_rad,
        near_m: 0.01 * distance,
        far_m: 2.0 * (distance + radius.max(center.distance(center_of_all) + radius_of_all)),
        shadow_distance: None,
    }
}

/// Returns the target's offset across the view and the camera's distance from it, at least `min_m`, so that the corners fill the image.
/// `towards` is the unit direction towards the camera, `slope_y` the tangent of half its vertical field of view.
fn place_filled_by(corners: &[Vec3], towards: Vec3, up: Vec3, slope_y: f32, aspect: f32, min_m: f32) -> (Vec3, f32) {
    let right = up.cross(towards).normalize();
    let up = towards.cross(right);
    // A corner at (x, z), across the image and towards the camera, is visible if |x − e| ≤ slope · (distance − z), with the eye at
    // (e, distance). All are visible if max (x + slope · z) − slope · distance ≤ e ≤ min (x − slope · z) + slope · distance.
    let limits = |across: Vec3, slope: f32| {
        let most = corners.iter().map(|c| c.dot(across) + slope * c.dot(towards)).fold(f32::NEG_INFINITY, f32::max);
        let least = corners.iter().map(|c| c.dot(across) - slope * c.dot(towards)).fold(f32::INFINITY, f32::min);
        (most, least)
    };
    let slope = slope_y / MARGIN;
    let axes = [(right, slope * aspect), (up, slope)];
    let enough = |(across, slope): (Vec3, f32)| {
        let (most, least) = limits(across, slope);
        (most - least) / (2.0 * slope)
    };
    let distance = axes.map(enough).into_iter().fold(min_m, f32::max);
    // Of these e, the one with equal margins on both sides of the image, found by bisection.
    let middle = |(across, slope): (Vec3, f32)| {
        let (most, least) = limits(across, slope);
        let (mut low, mut high) = (most - slope * distance, least + slope * distance);
        for _ in 0..32 {
            let e = 0.5 * (low + high);
            let places = corners.iter().map(|c| (c.dot(across) - e) / (distance - c.dot(towards)));
            let (right, left) = places.fold((f32::MIN, f32::MAX), |(most, least), x| (most.max(x), least.min(x)));
            if right + left > 0.0 { low = e } else { high = e }
        }
        0.5 * (low + high)
    };
    let [x, y] = axes.map(middle);
    (x * right + y * up, distance)
}

impl Camera {
    /// Moves the camera, without turning it, so that a box fills its image; `aspect` is width over height.
    pub fn frame(&mut self, bounds: Aabb, aspect: f32) {
        if bounds.is_empty() {
            return;
        }
        let (center, radius) = sphere(bounds);
        let towards = (self.eye - self.target).normalize();
        let corners = bounds.corners().map(|corner| corner - center);
        let slope_y = (0.5 * self.fov_y_rad).tan();
        let min_m = radius.max(4.0 * self.near_m);
        let (offset, distance) = place_filled_by(&corners, towards, self.up, slope_y, aspect, min_m);
        self.target = center + offset;
        self.eye = self.target + distance * towards;
    }
}

/// Point in a box at these fractions of its extent.
pub(super) fn place_within(bounds: Aabb, fractions: Vec3) -> Vec3 {
    bounds.min + fractions * (bounds.max - bounds.min)
}

/// Default key light: a rectangle above and beside a box.
pub(super) fn key_light(bounds: Aabb) -> Light {
    let (center, radius) = sphere(bounds);
    let diagonal = 2.0 * radius;
    let position = center + LIGHT_DISTANCE_DIAGONALS * diagonal * TOWARDS_LIGHT.normalize();
    Light::new(LightShape::Rectangle { size_m: Vec2::splat(LIGHT_SIDE_DIAGONALS * diagonal) }, position, center)
}
