//! Rooms: scenes that are viewed from inside, because only their walls are visible from outside.
//!
//! A scene is a room if rays from its inside meet front faces in nearly all directions. Inside a solid they meet back faces,
//! in a street the sky; a hall without a roof has enough walls and floor. Rays are tested against every triangle: there are
//! so few rays that a tree would not pay.

use std::f32::consts::TAU;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::framing::place_within;
use crate::{Camera, Scene};

/// Smallest fraction of rays from an enclosed point that meet front faces: true in a hall without a roof, not in a street.
const ENCLOSED: f32 = 0.8;
/// Smallest number of enclosed test points in a room.
const MIN_ENCLOSED: usize = 3;
/// Number of rays from a point, evenly distributed over the sphere.
const DIRECTIONS: u32 = 32;
/// Smallest height of a room, metres.
const MIN_HEIGHT_M: f32 = 1.5;
/// Eye height above the floor, metres, if the room is high enough.
const EYE_HEIGHT_M: f32 = 1.6;
/// Largest number of triangles that are tested: with more, the rays would take seconds.
const MAX_TRIANGLES: usize = 2_000_000;
/// Vertical field of view, degrees: wide, as is usual for rooms.
const FOV_Y_DEGREES: f32 = 65.0;
/// Height of the lamp, as a fraction of the way from the eye to the ceiling.
const LAMP_HEIGHT: f32 = 0.85;
/// Side of the lamp over the ceiling's height above the eye.
const LAMP_SIDE: f32 = 0.2;

/// First intersection of a ray.
#[derive(Clone, Copy, Debug)]
struct Hit {
    distance_m: f32,
    /// Whether the triangle's front faces the ray's origin.
    is_front: bool,
}

/// Returns a room's default camera and lamp; `None` if the scene is no room.
pub(super) fn inside(scene: &Scene) -> Option<(Camera, Light)> {
    if scene.triangle_count() > MAX_TRIANGLES {
        return None;
    }
    let bounds = scene.bounds();
    let faces = faces(scene);
    let places: Vec<Vec3> = [(0.5, 0.5), (0.3, 0.3), (0.7, 0.3), (0.3, 0.7), (0.7, 0.7)]
        .map(|(x, z)| place_within(bounds, Vec3::new(x, 0.4, z)))
        .to_vec();
    if places.iter().filter(|place| is_enclosed(&faces, **place)).count() < MIN_ENCLOSED {
        return None;
    }
    let view = longest_view(&faces, bounds)?;
    let ahead = view.eye + 0.4 * view.length_m * view.direction;
    // Without a ceiling, the scene's height is the room's.
    let above = cast(&faces, &[(ahead, Vec3::Y)])[0].map_or(bounds.max.y - ahead.y, |hit| hit.distance_m);
    let center = ahead + LAMP_HEIGHT * above * Vec3::Y;
    let lamp = Light::new(LightShape::Rectangle { size_m: Vec2::splat(LAMP_SIDE * above) }, center, center - Vec3::Y);
    let camera = Camera {
        eye: view.eye,
        target: view.eye + 0.5 * view.length_m * view.direction,
        up: Vec3::Y,
        fov_y_rad: FOV_Y_DEGREES.to_radians(),
        near_m: 0.05,
        far_m: 2.0 * bounds.diagonal(),
        shadow_distance: None,
    };
    (above > 0.0).then_some((camera, lamp))
}

/// Eye position and view direction.
#[derive(Clone, Copy, Debug)]
struct View {
    eye: Vec3,
    /// Unit view direction, horizontal.
    direction: Vec3,
    /// Distance to the first intersection, metres.
    length_m: f32,
}

/// Returns the best view from above a floor: the greatest product of the view's length and the distance to the nearest
/// surface at eye height. This prefers a hall to the passage behind its wall.
fn longest_view(faces: &[[Vec3; 3]], bounds: Aabb) -> Option<View> {
    const STEPS: [f32; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
    const WAYS: u32 = 12;
    /// Largest view length that counts, as a multiple of the distance to the nearest surface.
    const PASSAGE: f32 = 8.0;
    let places: Vec<Vec3> =
        STEPS.iter().flat_map(|x| STEPS.map(|z| place_within(bounds, Vec3::new(*x, 0.4, z)))).collect();
    let columns: Vec<_> = places.iter().flat_map(|place| [(*place, Vec3::NEG_Y), (*place, Vec3::Y)]).collect();
    let eyes: Vec<Vec3> = (places.iter().zip(cast(faces, &columns).chunks_exact(2)))
        .filter_map(|(place, column)| {
            let down = column[0].filter(|hit| hit.is_front)?.distance_m;
            let up = column[1].map_or(bounds.max.y - place.y, |hit| hit.distance_m);
            let height_m = down + up;
            let eye_m = EYE_HEIGHT_M.min(0.5 * height_m);
            (height_m >= MIN_HEIGHT_M).then_some(*place + (eye_m - down) * Vec3::Y)
        })
        .collect();
    let way = |k: u32| Vec3::new((TAU * k as f32 / WAYS as f32).cos(), 0.0, (TAU * k as f32 / WAYS as f32).sin());
    let rays: Vec<_> = eyes.iter().flat_map(|eye| (0..WAYS).map(|k| (*eye, way(k)))).collect();
    let hits = cast(faces, &rays);
    let around = rays.chunks_exact(WAYS as usize).zip(hits.chunks_exact(WAYS as usize));
    let views = around.flat_map(|(rays, hits)| {
        let clear_m = hits.iter().flatten().map(|hit| hit.distance_m).fold(f32::INFINITY, f32::min);
        rays.iter().zip(hits).filter_map(move |(&(eye, direction), hit)| {
            let hit = hit.filter(|hit| hit.is_front)?;
            let counted_m = hit.distance_m.min(PASSAGE * clear_m);
            Some((View { eye, direction, length_m: hit.distance_m }, counted_m * clear_m))
        })
    });
    views.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(view, _)| view)
}

/// Whether rays from a place meet front faces in nearly all directions.
fn is_enclosed(faces: &[[Vec3; 3]], place: Vec3) -> bool {
    /// Golden angle, 2π (1 − 1/φ), radians: turns by it fill the circle evenly (Vogel 1979).
    const GOLDEN_ANGLE: f32 = 2.399_963;
    let direction = |k: u32| {
        let y = 1.0 - 2.0 * (k as f32 + 0.5) / DIRECTIONS as f32;
        let (sin, cos) = (GOLDEN_ANGLE * k as f32).sin_cos();
        let across = (1.0 - y * y).sqrt();
        (place, Vec3::new(across * cos, y, across * sin))
    };
    let rays: Vec<_> = (0..DIRECTIONS).map(direction).collect();
    let looking = cast(faces, &rays).into_iter().flatten().filter(|hit| hit.is_front).count();
    looking as f32 >= ENCLOSED * DIRECTIONS as f32
}

/// Every triangle in world space, counter-clockwise seen from its front.
fn faces(scene: &Scene) -> Vec<[Vec3; 3]> {
    let front = |triangle: crate::WorldTriangle| {
        let [a, b, c] = triangle.positions;
        let mirrors = scene.instances[triangle.instance as usize].world_from_object.determinant() < 0.0;
        if mirrors { [a, c, b] } else { [a, b, c] }
    };
    scene.world_triangles().map(front).collect()
}

/// First intersection of each ray, given by origin and direction (Möller and Trumbore 1997).
fn cast(faces: &[[Vec3; 3]], rays: &[(Vec3, Vec3)]) -> Vec<Option<Hit>> {
    let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
    for [a, b, c] in faces {
        let (ab, ac) = (*b - *a, *c - *a);
        for ((origin, direction), hit) in rays.iter().zip(&mut hits) {
            let p = direction.cross(ac);
            let determinant = ab.dot(p);
            let inverse = determinant.recip();
            let from_a = *origin - *a;
            let u = from_a.dot(p) * inverse;
            let q = from_a.cross(ab);
            let v = direction.dot(q) * inverse;
            let distance_m = ac.dot(q) * inverse;
            // For a ray in the triangle's plane the determinant is 0; the NaN or infinity that results fails the comparison.
            let meets = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance_m > 0.0;
            if meets && hit.is_none_or(|nearest| distance_m < nearest.distance_m) {
                *hit = Some(Hit { distance_m, is_front: determinant > 0.0 });
            }
        }
    }
    hits
}
