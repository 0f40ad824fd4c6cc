//! Convex bodies as the corners that span them, to fit frusta where a box is too loose.

use glam::{DVec3, DVec4, Vec3};

use crate::Aabb;

/// Returns the corners of the convex body where `plane · (x, 1) ≥ 0` for all planes: [`Polytope::corners`].
pub fn polytope_corners(planes: &[DVec4], size_m: f64) -> Vec<Vec3> {
    Polytope::new(planes, size_m).corners
}

/// Convex body between planes, with its edges, from which bodies cut out of it by a few further planes are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Polytope {
    /// Bounding planes, with unit normals.
    planes: Vec<DVec4>,
    room_m: f64,
    edges: Vec<Edge>,
    faces: Vec<Face>,
    corners: Vec<Vec3>,
    /// Whether the body is finite in all directions.
    is_bounded: bool,
}

/// Edge of a polytope: the part of a line that is in front of all planes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    /// Indices of the two planes that meet there, in ascending order.
    planes: [usize; 2],
    on_line: DVec3,
    along: DVec3,
    from: f64,
    to: f64,
}

/// Face of a polytope in one of its planes.
#[derive(Clone, Debug, PartialEq)]
struct Face {
    edges: Vec<usize>,
    /// The other planes of its edges, which alone bound the face; all planes if it has no edge.
    bounded_by: Vec<DVec4>,
}

/// Distance of a plane from a polytope, as a fraction of its size, beyond which the plane cuts off nothing or everything.
const CLEARLY_BESIDE: f64 = 1e-2;

/// Tolerance for rounding, as a fraction of a polytope's size.
const ROOM: f64 = 1e-6;

impl Polytope {
    /// Creates the body where `plane · (x, 1) ≥ 0` for all planes, of about the size `size_m`.
    pub fn new(planes: &[DVec4], size_m: f64) -> Self {
        let planes = with_unit_normals(planes);
        let room_m = ROOM * size_m;
        let mut edges = Vec::new();
        // Most lines lie outside, mostly behind a plane that cut off one of the last few lines.
        let mut cutters = planes.clone();
        for (plane, a) in planes.iter().enumerate() {
            for (other, b) in planes.iter().enumerate().skip(plane + 1) {
                edges.extend(Edge::between([plane, other], *a, *b, [&mut cutters], room_m));
            }
        }
        let corners = edges.iter().flat_map(Edge::corners).collect();
        let is_bounded = edges.len() >= 6 && edges.iter().all(|edge| edge.from.is_finite() && edge.to.is_finite());
        let faces = (0..planes.len()).map(|plane| Face::of(plane, &planes, &edges)).collect();
        Self { planes, room_m, edges, faces, corners, is_bounded }
    }

    /// Ends of its edges, each on the line where two planes meet and in front of all others, with a tolerance for rounding. Corners
    /// occur several times.
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }

    /// Returns the corners of the part in front of further planes, as [`polytope_corners`] of all planes does.
    pub fn corners_within(&self, further: &[DVec4]) -> Vec<Vec3> {
        let further = with_unit_normals(further);
        let Some(cuts) = self.cuts_by(&further) else { return Vec::new() };
        let mut cutters_of_edges: Vec<DVec4> = cuts.iter().map(|cut| cut.plane).collect();
        let mut bounding = Vec::new();
        let mut corners = Vec::with_capacity(self.corners.len());
        let mut edges = self.edges.iter().enumerate().peekable();
        for (i, a) in self.planes.iter().enumerate() {
            while let Some((k, edge)) = edges.next_if(|(_, edge)| edge.planes[0] == i) {
                match Side::of_edge(&cuts, k) {
                    Side::InFront => corners.extend(edge.corners()),
                    Side::Behind => {}
                    Side::Across => {
                        let (from, to) = (edge.from, edge.to);
                        let part =
                            part_in_front(&mut cutters_of_edges, edge.on_line, edge.along, self.room_m, (from, to));
                        corners.extend(part.into_iter().flat_map(|(from, to)| Edge { from, to, ..*edge }.corners()));
                    }
                }
            }
            let face = &self.faces[i];
            bounding.clear();
            bounding.extend_from_slice(&face.bounded_by);
            for cut in cuts.iter().filter(|cut| cut.meets_face(&face.edges)) {
                let cutters = [&mut cutters_of_edges[..], &mut bounding];
                let edge = Edge::between([i, i], *a, cut.plane, cutters, self.room_m);
                corners.extend(edge.iter().flat_map(Edge::corners));
            }
        }
        bounding.clone_from(&self.planes);
        for (i, a) in cuts.iter().enumerate() {
            for b in &cuts[i + 1..] {
                let cutters = [&mut cutters_of_edges[..], &mut bounding];
                let edge = Edge::between([i, i], a.plane, b.plane, cutters, self.room_m);
                corners.extend(edge.iter().flat_map(Edge::corners));
            }
        }
        corners
    }

    /// Returns those planes that cut something off; `None` if one leaves nothing.
    fn cuts_by(&self, planes: &[DVec4]) -> Option<Vec<Cut>> {
        let mut cuts = Vec::with_capacity(planes.len());
        for plane in planes {
            if !self.is_bounded {
                cuts.push(Cut { plane: *plane, edges: Vec::new() });
                continue;
            }
            let margin_m = CLEARLY_BESIDE / ROOM * self.room_m;
            let side_of_edge = |ends: &[Vec3]| {
                let [from, to] = [ends[0], ends[1]].map(|end| plane.dot(end.as_dvec3().extend(1.0)));
                Side::of(from.min(to), from.max(to), margin_m)
            };
            let edges: Vec<Side> = self.corners.chunks_exact(2).map(side_of_edge).collect();
            if edges.iter().all(|side| *side == Side::Behind) {
                return None;
            }
            if edges.iter().any(|side| *side != Side::InFront) {
                cuts.push(Cut { plane: *plane, edges });
            }
        }
        Some(cuts)
    }
}

impl Face {
    /// Creates the face in the plane with an index.
    fn of(plane: usize, planes: &[DVec4], edges: &[Edge]) -> Self {
        let of_face: Vec<usize> = (0..edges.len()).filter(|k| edges[*k].planes.contains(&plane)).collect();
        let other_side = |k: &usize| {
            let [a, b] = edges[*k].planes;
            planes[if a == plane { b } else { a }]
        };
        let bounded_by = if of_face.is_empty() { planes.to_vec() } else { of_face.iter().map(other_side).collect() };
        Self { edges: of_face, bounded_by }
    }
}

/// Plane that cuts something off a polytope.
struct Cut {
    plane: DVec4,
    /// Side of the plane on which each edge is; empty for a polytope without bounds.
    edges: Vec<Side>,
}

impl Cut {
    /// Whether the plane may meet a face of these edges; true for a face without edges.
    fn meets_face(&self, edges: &[usize]) -> bool {
        let are_all = |side: Side| edges.iter().all(|edge| self.edges[*edge] == side);
        edges.is_empty() || self.edges.is_empty() || !(are_all(Side::InFront) || are_all(Side::Behind))
    }
}

/// Side of a plane, by a margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    InFront,
    Behind,
    /// On both sides, or too near to decide.
    Across,
}

impl Side {
    /// Side of a range of heights above the plane.
    fn of(low: f64, high: f64, margin_m: f64) -> Self {
        if low > margin_m {
            Self::InFront
        } else if high < -margin_m {
            Self::Behind
        } else {
            Self::Across
        }
    }

    /// Side of an edge with regard to all cuts together.
    fn of_edge(cuts: &[Cut], edge: usize) -> Self {
        let side_of = |cut: &Cut| cut.edges.get(edge).copied().unwrap_or(Self::Across);
        if cuts.iter().any(|cut| side_of(cut) == Self::Behind) {
            Self::Behind
        } else if cuts.iter().all(|cut| side_of(cut) == Self::InFront) {
            Self::InFront
        } else {
            Self::Across
        }
    }
}

impl Edge {
    /// Creates the edge where two planes meet; `None` if `cutters`, tested in their order, cut off all of it.
    fn between<const N: usize>(
        planes: [usize; 2],
        a: DVec4,
        b: DVec4,
        cutters: [&mut [DVec4]; N],
        room_m: f64,
    ) -> Option<Self> {
        let (on_line, along) = line_where_planes_meet(a, b)?;
        let whole = (f64::NEG_INFINITY, f64::INFINITY);
        let (from, to) =
            cutters.into_iter().try_fold(whole, |part, planes| part_in_front(planes, on_line, along, room_m, part))?;
        Some(Self { planes, on_line, along, from, to })
    }

    /// Finite ends of the edge.
    fn corners(&self) -> impl Iterator<Item = Vec3> + use<> {
        let Self { on_line, along, from, to, .. } = *self;
        [from, to].into_iter().filter(|t| t.is_finite()).map(move |t| (on_line + along * t).as_vec3())
    }
}

fn with_unit_normals(planes: &[DVec4]) -> Vec<DVec4> {
    let has_normal = |plane: &&DVec4| plane.truncate().length() > 0.0;
    planes.iter().filter(has_normal).map(|plane| plane / plane.truncate().length()).collect()
}

/// Returns a point of the line where two planes meet, and the unit vector along it; `None` if they are nearly parallel.
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

/// Returns the interval of a line that is in front of all planes, with swapped ends if it exists only within the tolerance. If
/// there is none, returns `None` and moves the plane that decided this to the front for the next call.
fn part_in_front(
    planes: &mut [DVec4],
    on_line: DVec3,
    along: DVec3,
    room_m: f64,
    (mut from, mut to): (f64, f64),
) -> Option<(f64, f64)> {
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

/// Corners of a convex body around some points, bounded by the planes across 13 directions (a box's faces, edges and corners) that
/// touch them, so seldom much larger than their hull. Empty for no points.
pub fn enclosing_corners(points: &[Vec3]) -> Vec<Vec3> {
    polytope_corners(&enclosing_planes(points), f64::from(Aabb::of(points.iter().copied()).diagonal()))
}

/// Planes that bound the body of [`enclosing_corners`]: `plane · (x, 1) ≥ 0` inside for all of them. Empty for no points.
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

    /// The corners of a body within further planes are those of all planes, in order and to the bit, whether a plane cuts the body,
    /// misses it or leaves nothing of it.
    #[test]
    fn a_part_of_a_body_is_that_of_all_planes() {
        let unit = |i: u32| f64::from(crate::unit_f32(crate::hash_u32(i))) * 2.0 - 1.0;
        let direction = |i: u32| DVec3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2)).normalize();
        let (mut empty, mut cut) = (0, 0);
        for case in 0..400 {
            let first = 100 * case;
            let body: Vec<DVec4> =
                (0..14).map(|i| direction(first + i).extend(1.0 + 0.2 * unit(first + 50 + i))).collect();
            let further: Vec<DVec4> = (14..18)
                .map(|i| 3.0 * direction(first + i).extend(1.2 * unit(first + 70 + i)))
                .chain([DVec4::ZERO])
                .collect();
            let all = [&body[..], &further].concat();
            let polytope = Polytope::new(&body, 2.0);
            let within = polytope.corners_within(&further);
            assert_eq!(within, polytope_corners(&all, 2.0), "case {case}");
            empty += u32::from(within.is_empty());
            cut += u32::from(!within.is_empty() && within != polytope.corners());
        }
        assert!(empty > 20 && cut > 100, "{empty} cases leave nothing, {cut} are cut");
    }

    /// In every direction the points lie between the corners, which reach at most .2 beyond them, a tenth of a ball's diameter.
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
