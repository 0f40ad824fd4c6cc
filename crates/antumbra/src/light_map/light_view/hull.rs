//! Convex hulls in the light plane.

use glam::Vec2;

/// Removes points inside the polygon of the points farthest along eight directions (Akl and Toussaint, "A fast convex hull
/// algorithm", 1978). Most of many points are removed and need no sorting.
fn leave_out_inner(points: &mut Vec<Vec2>) {
    /// Minimum number of points for which this pays off.
    const WORTH_IT: usize = 64;
    if points.len() < WORTH_IT {
        return;
    }
    let along = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (-1.0, 0.0), (-1.0, -1.0), (0.0, -1.0), (1.0, -1.0)];
    let mut farthest = [(f32::NEG_INFINITY, Vec2::ZERO); 8];
    for p in &*points {
        for ((x, y), (most, place)) in along.iter().zip(&mut farthest) {
            let reach = x * p.x + y * p.y;
            if reach > *most {
                (*most, *place) = (reach, *p);
            }
        }
    }
    let corners = farthest.map(|(_, place)| place);
    // Removed points lie strictly inside every side, by more than rounding. Sides of zero length do not count.
    let size = (farthest[0].0 + farthest[4].0).max(farthest[2].0 + farthest[6].0);
    let sides: Vec<(Vec2, Vec2)> = (0..8)
        .map(|i| (corners[i], corners[(i + 1) % 8] - corners[i]))
        .filter(|(_, side)| side.length_squared() > 0.0)
        .collect();
    // All points coincide.
    if sides.is_empty() {
        return;
    }
    points.retain(|p| !sides.iter().all(|(corner, side)| side.perp_dot(*p - *corner) > 1e-5 * size * side.length()));
}

/// Returns the corners of the points' convex hull in order (Andrew's monotone chain, 1979). Windows around the hull equal those
/// around the points. Non-finite points are removed.
pub(super) fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.retain(|p| p.is_finite());
    leave_out_inner(&mut points);
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns_left = |a: Vec2, b: Vec2, c: Vec2| {
        let [a, b, c] = [a, b, c].map(Vec2::as_dvec2);
        (b - a).perp_dot(c - a) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if turns_left(a, b, p) {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}
