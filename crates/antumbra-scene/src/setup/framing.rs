//! A camera and a light for scenes that bring none.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::FOV_Y_DEGREES;
use crate::{Camera, Scene};

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

/// What a picture is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Subject {
    /// What fills the picture.
    pub(super) bounds: Aabb,
    /// The scene, which may go on around it.
    pub(super) all: Aabb,
    /// It stands alone: shadows on the ground that it will be put on belong to it.
    pub(super) has_shadow: bool,
}

/// A triangle is small where its box is so much smaller than the scene's, diagonal over diagonal.
const SMALL: f32 = 1.0 / 8.0;
/// What is large is a ground where all small triangles lie together within such a part of the scene, and none of it rises above their
/// middle.
const SPECK: f32 = 1.0 / 3.0;

impl Subject {
    /// The scene, or what of it is no more than a speck on its ground.
    ///
    /// A ground of two triangles, kilometres wide, says nothing of what the scene shows. Large triangles about things, or above them, are
    /// walls and roofs, and belong to it.
    pub(super) fn of(scene: &Scene) -> Self {
        let all = scene.bounds();
        let mut bounds = all;
        // Each turn leaves a third at most: a few are enough for any scene of floats.
        for _ in 0..8 {
            let small_m = SMALL * bounds.diagonal();
            let (mut speck, mut top_of_large_m) = (Aabb::EMPTY, f32::NEG_INFINITY);
            for triangle in scene.world_triangles() {
                let one = Aabb::of(triangle.positions);
                match one.diagonal() <= small_m {
                    true => speck = speck.union(one),
                    // What was left out before is not looked at again.
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
        Self { bounds, all, has_shadow: scene.stands_on_nothing() }
    }

    /// The corners that are to be in the picture: of the box, and of the shadow of its lower half, where that belongs to it. (Of the
    /// upper half shadows are as long as one likes.)
    fn corners(&self) -> Vec<Vec3> {
        // A box of nothing has no corners.
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

/// A camera whose picture, of that width over its height, is filled by a subject.
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

/// Where a camera looks, across its view, and how far it stands from there, at `least_m` or farther, so that corners fill its picture.
/// `towards` is the unit direction towards the camera, `slope_y` the tangent of half its vertical field of view.
fn place_filled_by(corners: &[Vec3], towards: Vec3, up: Vec3, slope_y: f32, aspect: f32, least_m: f32) -> (Vec3, f32) {
    let right = up.cross(towards).normalize();
    let up = towards.cross(right);
    // A corner at (x, z) across the picture and towards the camera lies within it where |x − e| ≤ slope · (distance − z), with the eye
    // at (e, distance). All of them do where max (x + slope · z) − slope · distance ≤ e ≤ min (x − slope · z) + slope · distance.
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
    let distance = axes.map(enough).into_iter().fold(least_m, f32::max);
    // Of those e the one that leaves as much room on both sides of the picture, found by halving.
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
    /// Moves the camera, which keeps its direction, to where a box fills its picture of this width over its height.
    pub fn frame(&mut self, bounds: Aabb, aspect: f32) {
        if bounds.is_empty() {
            return;
        }
        let (center, radius) = sphere(bounds);
        let towards = (self.eye - self.target).normalize();
        let corners = bounds.corners().map(|corner| corner - center);
        let slope_y = (0.5 * self.fov_y_rad).tan();
        let least_m = radius.max(4.0 * self.near_m);
        let (offset, distance) = place_filled_by(&corners, towards, self.up, slope_y, aspect, least_m);
        self.target = center + offset;
        self.eye = self.target + distance * towards;
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
