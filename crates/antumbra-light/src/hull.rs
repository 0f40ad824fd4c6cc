//! Convex bodies as the corners that span them: what frusta are fitted to where a box is too loose.

use glam::{DVec3, DVec4, Vec3};

use crate::Aabb;

/// The corners of the convex body where `plane · (x, 1) ≥ 0` for all planes: the ends of its edges, each of which lies
/// where two planes meet and no other cuts off, with a little room for rounding. Corners come several times over.
/// `size_m` is about the body's size.
pub fn polytope_corners(planes: &[DVec4], size_m: f64) -> Vec<Vec3> {
    let planes: Vec<DVec4> = planes
        .iter()
        .filter(|plane| plane.truncate().length() > 0.0)
        .map(|plane| plane / plane.truncate().length())
        .collect();
    let room_m = 1e-6 * size_m;
    let mut corners = Vec::new();
    // Most lines lie outside, most of them by what cut off one of the last few.
    let mut cutters = planes.clone();
    for (i, a) in planes.iter().enumerate() {
        for b in &planes[i + 1..] {
            let Some((on_line, along)) = line_where_planes_meet(*a, *b) else { continue };
            let Some((from, to)) = part_in_front(&mut cutters, on_line, along, room_m) else { continue };
            corners.extend([from, to].into_iter().filter(|t| t.is_finite()).map(|t| (on_line + along * t).as_vec3()));
        }
    }
    corners
}

/// A point of the line where two planes meet, and the unit vector along it; `None` where they are all but parallel.
fn line_where_planes_meet(a: DVec4, b: DVec4) -> Option<(DVec3, DVec3)> {
    let (normal_a, normal_b) = (a.truncate(), b.truncate());
    let along = normal_a.cross(normal_b);
    let sine_squared = along.length_squared();
    if sine_squared < 1e-10 {
        return None;
    }
    let point = (b.w * normal_a - a.w * normal_b).cross(along) / sine_squared;
    Some((point, along / sine_squared.sqrt()))
}

/// From where to where a line is in front of all planes; where it is so nowhere, but nearly, the two places between which
/// it nearly is. The plane that tells that there is no such part comes first the next time.
fn part_in_front(planes: &mut [DVec4], on_line: DVec3, along: DVec3, room_m: f64) -> Option<(f64, f64)> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..planes.len() {
        let plane = planes[i];
        let in_front = plane.dot(on_line.extend(1.0));
        let rise = plane.truncate().dot(along);
        if rise.abs() < 1e-9 {
            if in_front < -room_m {
                planes[..=i].rotate_right(1);
                return None;
            }
        } else if rise > 0.0 {
            from = from.max(-in_front / rise);
        } else {
            to = to.min(-in_front / rise);
        }
        if from > to + room_m {
            planes[..=i].rotate_right(1);
            return None;
        }
    }
    Some((from, to))
}

/// Corners of a convex body around some points: bounded by the planes across 13 directions (a box's faces, edges and
/// corners) that touch them, so seldom much larger than their hull. None for no points.
pub fn enclosing_corners(points: &[Vec3]) -> Vec<Vec3> {
    polytope_corners(&enclosing_planes(points), f64::from(Aabb::of(points.iter().copied()).diagonal()))
}

/// The planes that bound that body: it lies where `plane · (x, 1) ≥ 0` for all of them. None for no points.
pub fn enclosing_planes(points: &[Vec3]) -> Vec<DVec4> {
    if points.is_empty() {
        return Vec::new();
    }
    let directions = [
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(0.0, 1.0, 0.0),
        DVec3::new(0.0, 0.0, 1.0),
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::new(1.0, -1.0, 0.0),
        DVec3::new(1.0, 0.0, 1.0),
        DVec3::new(1.0, 0.0, -1.0),
        DVec3::new(0.0, 1.0, 1.0),
        DVec3::new(0.0, 1.0, -1.0),
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::new(1.0, -1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
    ];
    let extents = directions.map(|direction| {
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            let at = direction.dot(point.as_dvec3());
            (low.min(at), high.max(at))
        })
    });
    let size_m = extents.iter().fold(0.0_f64, |size, (low, high)| size.max(high - low));
    // Flat and pointed sets need some thickness for their planes to meet in corners.
    let room_m = 1e-3 * size_m.max(1e-6);
    directions
        .iter()
        .zip(extents)
        .flat_map(|(direction, (low, high))| [direction.extend(room_m - low), (-direction).extend(room_m + high)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_s_corners_are_its_own() {
        let cube: Vec<Vec3> =
            (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0).collect();
        let corners = enclosing_corners(&cube);
        for corner in &cube {
            assert!(corners.iter().any(|p| p.abs_diff_eq(*corner, 0.02)), "{corner} of {corners:?}");
        }
        assert!(corners.iter().all(|p| p.abs().max_element() < 1.02), "{corners:?}");
    }

    /// Whatever way one looks along, the points lie between the corners; a ball's are at most a tenth outside.
    #[test]
    fn points_lie_within_their_corners() {
        let unit = |i: u32| crate::unit_f32(crate::hash_u32(i)) * 2.0 - 1.0;
        let in_ball = |i: u32| Vec3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2)).clamp_length_max(1.0);
        let ball: Vec<Vec3> = (0..2000).map(in_ball).collect();
        let flat: Vec<Vec3> = ball.iter().map(|p| p.with_y(0.5)).collect();
        let line: Vec<Vec3> = ball.iter().map(|p| Vec3::splat(p.x)).collect();
        for points in [ball.clone(), flat, line, vec![Vec3::new(3.0, 4.0, 5.0)]] {
            let corners = enclosing_corners(&points);
            for direction in ball.iter().take(50).map(|p| p.normalize()) {
                let most = |set: &[Vec3]| set.iter().map(|p| p.dot(direction)).fold(f32::NEG_INFINITY, f32::max);
                assert!(most(&points) <= most(&corners) + 1e-5, "{direction}");
                assert!(most(&corners) < most(&points) + 0.2, "{direction}");
            }
        }
        assert!(enclosing_corners(&[]).is_empty());
    }
}
