//! Rooms: scenes that are seen from inside, since from outside one sees their walls alone.
//!
//! A room is where faces look at one from nearly everywhere. From within a solid one sees the backs of its faces, from a
//! street the sky; a hall without a roof has walls and floor enough. Rays are cast against every triangle, of which there
//! are so few rays that no tree would pay.

use std::f32::consts::TAU;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Vec2, Vec3};

use super::framing::place_within;
use crate::{Camera, Scene};

/// A point is enclosed where so much of what is around it looks at it: a hall without its roof is, a street is not.
const ENCLOSED: f32 = 0.8;
/// Of the points that are asked, a room encloses so many.
const LEAST_ENCLOSED: usize = 3;
/// Directions from a point, evenly over the sphere.
const DIRECTIONS: u32 = 32;
/// One stands in no room that is lower, metres.
const LEAST_HEIGHT_M: f32 = 1.5;
/// Eyes of someone who stands, metres above the floor, where the room is high enough.
const EYE_HEIGHT_M: f32 = 1.6;
/// More triangles than these times the rays would be seconds of work.
const MOST_TRIANGLES: usize = 2_000_000;
/// Vertical: wide, as rooms are drawn.
const FOV_Y_DEGREES: f32 = 65.0;
/// How far up from the eye towards the ceiling the lamp hangs.
const LAMP_HEIGHT: f32 = 0.85;
/// The lamp's side over the height above the eye.
const LAMP_SIDE: f32 = 0.2;

/// What a ray met first.
#[derive(Clone, Copy, Debug)]
struct Hit {
    distance_m: f32,
    /// The face looks at the ray's origin.
    is_front: bool,
}

/// The camera and the lamp for a room; `None` where the scene is none.
pub(super) fn inside(scene: &Scene) -> Option<(Camera, Light)> {
    if scene.triangle_count() > MOST_TRIANGLES {
        return None;
    }
    let bounds = scene.bounds();
    let faces = faces(scene);
    let places: Vec<Vec3> = [(0.5, 0.5), (0.3, 0.3), (0.7, 0.3), (0.3, 0.7), (0.7, 0.7)]
        .map(|(x, z)| place_within(bounds, Vec3::new(x, 0.4, z)))
        .to_vec();
    if places.iter().filter(|place| is_enclosed(&faces, **place)).count() < LEAST_ENCLOSED {
        return None;
    }
    let view = longest_view(&faces, bounds)?;
    let ahead = view.eye + 0.4 * view.length_m * view.direction;
    // Under open sky the scene's own height is the room's.
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

/// A place to stand and a way to look.
#[derive(Clone, Copy, Debug)]
struct View {
    eye: Vec3,
    /// Unit, level.
    direction: Vec3,
    /// Until something is in the way, metres.
    length_m: f32,
}

/// Where one stands on a floor and sees farthest with most room around: the greatest product of the way that is looked and
/// the nearest thing at eye's height, so that a hall comes before the passage behind its wall.
fn longest_view(faces: &[[Vec3; 3]], bounds: Aabb) -> Option<View> {
    const STEPS: [f32; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
    const WAYS: u32 = 12;
    /// What is longer by so much than it is wide to either side shows no more for it.
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
            (height_m >= LEAST_HEIGHT_M).then_some(*place + (eye_m - down) * Vec3::Y)
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

/// Whether faces look at a place from nearly everywhere.
fn is_enclosed(faces: &[[Vec3; 3]], place: Vec3) -> bool {
    /// 2π (1 − 1/φ): turns by it fill the circle evenly (Vogel 1979).
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

/// What each ray, of an origin and a direction, meets first (Möller and Trumbore 1997).
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
            // A ray in the face's plane divides by nothing, and what comes of that compares as false.
            let meets = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance_m > 0.0;
            if meets && hit.is_none_or(|nearest| distance_m < nearest.distance_m) {
                *hit = Some(Hit { distance_m, is_front: determinant > 0.0 });
            }
        }
    }
    hits
}
