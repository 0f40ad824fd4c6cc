//! Solids as triangles: boxes, tubes, lathed profiles, prisms.
//!
//! Every shape is closed and winds counter-clockwise seen from outside, unless its name says *sheet*. Parts may pass
//! through one another; they must not share corners, or the edges between those corners would have four triangles.
//! Corners that belong to two faces are computed once, so that joining equal positions finds them equal bit by bit.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Mat3, Vec2, Vec3, Vec4};

use crate::Mesh;

/// Mesh builder: shapes are appended with a current placement and a current colour.
#[derive(Clone, Debug)]
pub(super) struct MeshBuilder {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec4>,
    indices: Vec<u32>,
    closed: bool,
    mesh_from_part: Affine3A,
    mesh_from_part_normal: Mat3,
    color: Vec3,
    is_colored: bool,
}

impl Default for MeshBuilder {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            indices: Vec::new(),
            closed: true,
            mesh_from_part: Affine3A::IDENTITY,
            mesh_from_part_normal: Mat3::IDENTITY,
            color: Vec3::ONE,
            is_colored: false,
        }
    }
}

impl MeshBuilder {
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the placement of the shapes that follow. It must not mirror, because that would turn them inside out.
    pub fn place(&mut self, mesh_from_part: Affine3A) -> &mut Self {
        debug_assert!(mesh_from_part.matrix3.determinant() > 0.0, "a placement must not mirror");
        self.mesh_from_part = mesh_from_part;
        self.mesh_from_part_normal = Mat3::from(mesh_from_part.matrix3).inverse().transpose();
        self
    }

    /// Multiplies the material's colour by `color`, linear RGB, for the shapes that follow.
    pub fn tint(&mut self, color: Vec3) -> &mut Self {
        self.color = color;
        self.is_colored |= color != Vec3::ONE;
        self
    }

    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Returns the finished mesh.
    pub fn build(self, name: &str, material: usize) -> Mesh {
        Mesh {
            name: name.into(),
            positions: self.positions,
            normals: self.normals,
            uvs: self.uvs,
            colors: if self.is_colored { self.colors } else { Vec::new() },
            indices: self.indices,
            material,
            closed: self.closed,
        }
    }

    fn vertex(&mut self, position: Vec3, normal: Vec3) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(self.mesh_from_part.transform_point3(position));
        self.normals.push((self.mesh_from_part_normal * normal).normalize());
        self.colors.push(self.color.extend(1.0));
        index
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        self.indices.extend(corners);
    }

    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.indices.extend([a, b, c, a, c, d]);
    }

    fn flat_quad(&mut self, corners: [Vec3; 4], normal: Vec3) {
        let quad = corners.map(|p| self.vertex(p, normal));
        self.quad(quad);
    }

    /// A flat convex polygon as a fan about its first corner.
    fn flat_fan(&mut self, corners: impl IntoIterator<Item = Vec3>, normal: Vec3) {
        let ring: Vec<u32> = corners.into_iter().map(|p| self.vertex(p, normal)).collect();
        for pair in ring[1..].windows(2) {
            self.triangle([ring[0], pair[0], pair[1]]);
        }
    }

    /// A box about `center` with unit right-handed `axes`; 12 triangles.
    pub fn oriented_box(&mut self, center: Vec3, axes: [Vec3; 3], half_size_m: Vec3) -> &mut Self {
        let half = half_size_m.to_array();
        let corner = |signs: [f32; 3]| center + (0..3).map(|k| axes[k] * (signs[k] * half[k])).sum::<Vec3>();
        for (k, axis) in axes.into_iter().enumerate() {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            for side in [-1.0, 1.0] {
                // Counter-clockwise about +axis k; mirrored along u for the opposite face.
                let corners = [(-side, -1.0), (side, -1.0), (side, 1.0), (-side, 1.0)].map(|(su, sv)| {
                    let mut signs = [side; 3];
                    signs[u] = su;
                    signs[v] = sv;
                    corner(signs)
                });
                self.flat_quad(corners, axis * side);
            }
        }
        self
    }

    /// The box between two opposite corners.
    pub fn box_between(&mut self, a: Vec3, b: Vec3) -> &mut Self {
        self.oriented_box(0.5 * (a + b), [Vec3::X, Vec3::Y, Vec3::Z], 0.5 * (b - a).abs())
    }

    /// A box of `size_m` whose base is centred on `base`.
    pub fn box_on(&mut self, base: Vec3, size_m: Vec3) -> &mut Self {
        self.oriented_box(base + Vec3::Y * (0.5 * size_m.y), [Vec3::X, Vec3::Y, Vec3::Z], 0.5 * size_m)
    }

    /// A square-cut beam from `a` to `b`: `width_m` across, `depth_m` along the direction nearest to `depth_hint`.
    pub fn beam(&mut self, a: Vec3, b: Vec3, width_m: f32, depth_m: f32, depth_hint: Vec3) -> &mut Self {
        let along = (b - a).normalize();
        let across = along.cross(depth_hint).normalize();
        let depth = across.cross(along);
        let half = 0.5 * Vec3::new(width_m, a.distance(b), depth_m);
        self.oriented_box(0.5 * (a + b), [across, along, depth], half)
    }

    /// A cylinder with flat ends; `4 · sides − 4` triangles.
    pub fn cylinder(&mut self, a: Vec3, b: Vec3, radius_m: f32, sides: u32) -> &mut Self {
        self.frustum(a, b, radius_m, radius_m, sides)
    }

    /// A cone with its base at `base`; `2 · sides − 2` triangles.
    pub fn cone(&mut self, base: Vec3, tip: Vec3, radius_m: f32, sides: u32) -> &mut Self {
        self.frustum(base, tip, radius_m, 0.0, sides)
    }

    /// A cylinder that tapers from `radius_a_m` to `radius_b_m ≥ 0`.
    pub fn frustum(&mut self, a: Vec3, b: Vec3, radius_a_m: f32, radius_b_m: f32, sides: u32) -> &mut Self {
        let height = a.distance(b);
        let mut profile = vec![Vec2::ZERO, Vec2::new(radius_a_m, 0.0), Vec2::new(radius_b_m, height)];
        if radius_b_m > 0.0 {
            profile.push(Vec2::new(0.0, height));
        }
        self.lathe(a, b - a, &profile, sides)
    }

    /// Turns a profile about an axis.
    ///
    /// `profile` holds (radius, height along the axis), metres, bottom to top on the outside; it starts and ends on
    /// the axis. Bends below 40 degrees are smoothed. A flat end disc is a fan without a middle vertex.
    pub fn lathe(&mut self, origin: Vec3, axis: Vec3, profile: &[Vec2], sides: u32) -> &mut Self {
        const SMOOTH_COS: f32 = 0.766;
        let axis = axis.normalize();
        let (u, v) = axis.any_orthonormal_pair();
        let spoke = |i: u32| {
            let (sin, cos) = (TAU * (i % sides) as f32 / sides as f32).sin_cos();
            u * cos + v * sin
        };
        let segment_normal = |k: usize| {
            let d = (profile[k + 1] - profile[k]).normalize();
            Vec2::new(d.y, -d.x)
        };
        let last = profile.len() - 2;
        let at = |p: Vec2, i: u32| origin + axis * p.y + spoke(i) * p.x;
        for k in 0..=last {
            let (p, q) = (profile[k], profile[k + 1]);
            let own = segment_normal(k);
            if p.y == q.y && p.x == 0.0 {
                self.flat_fan((0..sides).rev().map(|i| at(q, i)), -axis);
                continue;
            }
            if p.y == q.y && q.x == 0.0 {
                self.flat_fan((0..sides).map(|i| at(p, i)), axis);
                continue;
            }
            let shared = |other: Option<usize>| match other.map(segment_normal) {
                Some(n) if n.dot(own) > SMOOTH_COS => (n + own).normalize(),
                _ => own,
            };
            let (np, nq) = (shared(k.checked_sub(1)), shared((k < last).then_some(k + 1)));
            let to_3d = |n: Vec2, i: f32| {
                let (sin, cos) = (TAU * i / sides as f32).sin_cos();
                (u * cos + v * sin) * n.x + axis * n.y
            };
            let mut column = |i: u32| {
                // At a pole each side has its own normal, that of its middle.
                let turn = |p: Vec2| if p.x == 0.0 { i as f32 + 0.5 } else { i as f32 };
                (self.vertex(at(p, i), to_3d(np, turn(p))), self.vertex(at(q, i), to_3d(nq, turn(q))))
            };
            let columns: Vec<(u32, u32)> = (0..=sides).map(&mut column).collect();
            for pair in columns.windows(2) {
                let ((p0, q0), (p1, q1)) = (pair[0], pair[1]);
                if p.x > 0.0 {
                    self.triangle([p0, p1, if q.x > 0.0 { q1 } else { q0 }]);
                }
                if q.x > 0.0 {
                    self.triangle([p0, q1, q0]);
                }
            }
        }
        self
    }

    /// Turns a closed ring of (radius, height) about an axis: a hollow solid such as a torus. The ring winds as a
    /// lathe's profile does, up on the outside; its corners are sharp.
    pub fn lathe_ring(&mut self, origin: Vec3, axis: Vec3, ring: &[Vec2], sides: u32) -> &mut Self {
        let axis = axis.normalize();
        let (u, v) = axis.any_orthonormal_pair();
        let spoke = |i: u32| {
            let (sin, cos) = (TAU * (i % sides) as f32 / sides as f32).sin_cos();
            u * cos + v * sin
        };
        for (k, p) in ring.iter().enumerate() {
            let q = ring[(k + 1) % ring.len()];
            let d = (q - *p).normalize();
            let columns: Vec<(u32, u32)> = (0..=sides)
                .map(|i| {
                    let normal = spoke(i) * d.y - axis * d.x;
                    let at = |p: Vec2| origin + axis * p.y + spoke(i) * p.x;
                    (self.vertex(at(*p), normal), self.vertex(at(q), normal))
                })
                .collect();
            for pair in columns.windows(2) {
                self.quad([pair[0].0, pair[1].0, pair[1].1, pair[0].1]);
            }
        }
        self
    }

    /// A sphere of meridians and parallels; `2 · segments · (rings − 1)` triangles.
    pub fn sphere(&mut self, center: Vec3, radius_m: f32, segments: u32, rings: u32) -> &mut Self {
        let at = |ring: u32, segment: u32| {
            let (sin, cos) = match ring {
                0 => (0.0, 1.0),
                r if r == rings => (0.0, -1.0),
                r => (PI * r as f32 / rings as f32).sin_cos(),
            };
            let around = Vec2::from_angle(TAU * (segment % segments) as f32 / segments as f32);
            // Around +Y, counter-clockwise seen from above is from +z towards +x.
            Vec3::new(sin * around.y, -cos, sin * around.x)
        };
        let columns = segments + 1;
        let first = self.positions.len() as u32;
        for ring in 0..=rings {
            for segment in 0..columns {
                let n = at(ring, segment);
                self.vertex(center + n * radius_m, n);
            }
        }
        for ring in 0..rings {
            for segment in 0..segments {
                let a = first + ring * columns + segment;
                let [b, c, d] = [a + 1, a + columns + 1, a + columns];
                if ring > 0 {
                    self.triangle([a, b, c]);
                }
                if ring + 1 < rings {
                    self.triangle([a, c, d]);
                }
            }
        }
        self
    }

    /// A round tube along a polyline, with flat ends; `2 · sides · (points − 1) + 2 · (sides − 2)` triangles.
    pub fn tube(&mut self, points: &[Vec3], sides: u32, radius_m: impl Fn(usize) -> f32) -> &mut Self {
        let n = points.len();
        let tangent = |k: usize| (points[(k + 1).min(n - 1)] - points[k.saturating_sub(1)]).normalize();
        let mut across = tangent(0).any_orthonormal_vector();
        let first = self.positions.len() as u32;
        let mut ends = [const { Vec::new() }; 2];
        for (k, center) in points.iter().enumerate() {
            // Parallel transport: the last frame, made orthogonal to the new tangent.
            let t = tangent(k);
            across = across.reject_from_normalized(t).normalize();
            let other = t.cross(across);
            let ring: Vec<Vec3> = (0..sides)
                .map(|i| {
                    let (sin, cos) = (TAU * i as f32 / sides as f32).sin_cos();
                    across * cos + other * sin
                })
                .collect();
            let corners: Vec<Vec3> = ring.iter().map(|spoke| *center + *spoke * radius_m(k)).collect();
            for (corner, spoke) in corners.iter().zip(&ring) {
                self.vertex(*corner, *spoke);
            }
            if k == 0 {
                ends[0] = corners;
            } else if k == n - 1 {
                ends[1] = corners;
            }
        }
        for k in 0..n as u32 - 1 {
            for i in 0..sides {
                let [a, b] = [i, (i + 1) % sides].map(|i| first + k * sides + i);
                self.quad([a, b, b + sides, a + sides]);
            }
        }
        let [start, end] = ends;
        self.flat_fan(start.into_iter().rev(), -tangent(0));
        self.flat_fan(end, tangent(n - 1));
        self
    }

    /// A closed surface with the topology of a torus: `2 · columns · rows` triangles. `at(i, j)` turns from +i
    /// towards +j counter-clockwise seen from outside.
    pub fn torus_grid(&mut self, columns: u32, rows: u32, at: impl Fn(u32, u32) -> Vec3) -> &mut Self {
        let first = self.positions.len();
        let index = |i: u32, j: u32| first as u32 + (j % rows) * columns + i % columns;
        for j in 0..rows {
            for i in 0..columns {
                self.vertex(at(i, j), Vec3::Y);
            }
        }
        let first_index = self.indices.len();
        for j in 0..rows {
            for i in 0..columns {
                self.quad([index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]);
            }
        }
        // Area-weighted: a cross product is twice its triangle's area long.
        self.normals[first..].fill(Vec3::ZERO);
        for t in self.indices[first_index..].chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| self.positions[i as usize]);
            let area_normal = (b - a).cross(c - a);
            for i in t {
                self.normals[*i as usize] += area_normal;
            }
        }
        for normal in &mut self.normals[first..] {
            *normal = normal.normalize();
        }
        self
    }

    /// A convex polygon in the xy plane of `part`, counter-clockwise, extruded along its +z from 0 to `height_m`;
    /// `4 · corners − 4` triangles. `part` is rigid.
    pub fn prism(&mut self, part: Affine3A, polygon: &[Vec2], height_m: f32) -> &mut Self {
        let at = |p: Vec2, z: f32| part.transform_point3(p.extend(z));
        let z = part.transform_vector3(Vec3::Z);
        for (i, p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let normal = part.transform_vector3((q - *p).perp().extend(0.0) * -1.0).normalize();
            self.flat_quad([at(*p, 0.0), at(q, 0.0), at(q, height_m), at(*p, height_m)], normal);
        }
        self.flat_fan(polygon.iter().map(|p| at(*p, height_m)), z);
        self.flat_fan(polygon.iter().rev().map(|p| at(*p, 0.0)), -z);
        self
    }

    /// The strip between two polylines of `n` points each in the xy plane of `part`, extruded along its +z from 0 to
    /// `height_m`; `8 · n − 4` triangles. Both run along +x, `upper` above `lower`; bends are smoothed. `part` is
    /// rigid.
    pub fn strip_prism(&mut self, part: Affine3A, lower: &[Vec2], upper: &[Vec2], height_m: f32) -> &mut Self {
        let at = |p: Vec2, z: f32| part.transform_point3(p.extend(z));
        let z_axis = part.transform_vector3(Vec3::Z);
        let last = lower.len() - 1;
        let normal_of = |line: &[Vec2], k: usize| {
            let d = line[(k + 1).min(last)] - line[k.saturating_sub(1)];
            part.transform_vector3(d.perp().extend(0.0)).normalize()
        };
        for (line, is_upper) in [(lower, false), (upper, true)] {
            let columns: Vec<[u32; 2]> = (0..=last)
                .map(|k| {
                    let normal = if is_upper { normal_of(line, k) } else { -normal_of(line, k) };
                    [0.0, height_m].map(|z| self.vertex(at(line[k], z), normal))
                })
                .collect();
            for pair in columns.windows(2) {
                let ([a, b], [c, d]) = (pair[0], pair[1]);
                self.quad(if is_upper { [a, b, d, c] } else { [a, c, d, b] });
            }
        }
        for (z, normal, is_top) in [(0.0, -z_axis, false), (height_m, z_axis, true)] {
            for k in 0..last {
                let [a, b, c, d] = [lower[k], lower[k + 1], upper[k + 1], upper[k]].map(|p| at(p, z));
                self.flat_quad(if is_top { [a, b, c, d] } else { [a, d, c, b] }, normal);
            }
        }
        for (k, is_end) in [(0, false), (last, true)] {
            let [a, b] = [lower[k], upper[k]];
            let outward = (b - a).perp() * if is_end { -1.0 } else { 1.0 };
            let normal = part.transform_vector3(outward.extend(0.0)).normalize();
            let [p, q, r, s] = [at(a, 0.0), at(b, 0.0), at(b, height_m), at(a, height_m)];
            self.flat_quad(if is_end { [p, q, r, s] } else { [p, s, r, q] }, normal);
        }
        self
    }

    /// An open sheet of triangles in a fan about its first corner, with one normal; counter-clockwise is the front.
    pub fn sheet(&mut self, corners: &[Vec3], normal: Vec3) -> &mut Self {
        self.closed = false;
        self.flat_fan(corners.iter().copied(), normal);
        self
    }

    /// An open strip of quads that ends in a point: `left`/`right` pairs from the root up, then `tip`. The front is
    /// where left is left; `2 · pairs − 1` triangles.
    pub fn blade_sheet(&mut self, pairs: &[[Vec3; 2]], tip: Vec3, normal: Vec3) -> &mut Self {
        self.closed = false;
        let mut below: Option<[u32; 2]> = None;
        for pair in pairs {
            let [left, right] = pair.map(|p| self.vertex(p, normal));
            if let Some([l, r]) = below {
                self.quad([l, r, right, left]);
            }
            below = Some([left, right]);
        }
        if let Some([l, r]) = below {
            let tip = self.vertex(tip, normal);
            self.triangle([l, r, tip]);
        }
        self
    }

    /// An open textured quad: lower left, lower right, upper right, upper left, with texture coordinates for each.
    /// A mesh that has one must consist of such quads.
    pub fn card_sheet(&mut self, corners: [Vec3; 4], uvs: [Vec2; 4], normal: Vec3) -> &mut Self {
        self.closed = false;
        self.uvs.extend(uvs);
        self.flat_quad(corners, normal);
        self
    }
}
