//! Triangles between primitive and mesh: parallel lists of vertex attributes.

use glam::{DVec3, Mat3, Mat4, Vec2, Vec3, Vec4};

use super::numbers::LARGEST_COORDINATE_M;

/// One set of skinning attributes, of several that a file may have.
#[derive(Clone, Debug, Default)]
pub(super) struct Influences {
    /// Four joint indices per vertex.
    pub joints: Vec<[f32; 4]>,
    /// Four weights per vertex.
    pub weights: Vec<[f32; 4]>,
}

/// Displacements of a morph target; empty lists displace nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct MorphTarget {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
}

/// Indexed triangles with all attributes that loading needs. Lists are empty or as long as `positions`.
#[derive(Clone, Debug, Default)]
pub(super) struct Geometry {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub colors: Vec<Vec4>,
    pub influences: Vec<Influences>,
    pub targets: Vec<MorphTarget>,
    /// Vertex indices, three per triangle, each below `positions.len()`.
    pub indices: Vec<u32>,
}

impl Geometry {
    /// Rebuilds every list from the vertices `from`, in that order.
    fn gather(&mut self, from: &[u32]) {
        fn picked<T: Copy>(list: &mut Vec<T>, from: &[u32]) {
            if !list.is_empty() {
                *list = from.iter().map(|&i| list[i as usize]).collect();
            }
        }
        picked(&mut self.positions, from);
        picked(&mut self.normals, from);
        picked(&mut self.uvs, from);
        picked(&mut self.colors, from);
        for set in &mut self.influences {
            picked(&mut set.joints, from);
            picked(&mut set.weights, from);
        }
        for target in &mut self.targets {
            picked(&mut target.positions, from);
            picked(&mut target.normals, from);
        }
    }

    /// Gives each triangle vertices of its own, as flat normals need.
    pub(super) fn unshare(&mut self) {
        let from = std::mem::take(&mut self.indices);
        self.gather(&from);
        self.indices = (0..from.len() as u32).collect();
    }

    /// Removes vertices that no triangle uses, because files share one vertex list among many primitives and bounds are
    /// computed from all vertices.
    pub(super) fn compact(&mut self) {
        const UNUSED: u32 = u32::MAX;
        let mut new_of_old = vec![UNUSED; self.positions.len()];
        for &i in &self.indices {
            new_of_old[i as usize] = 0;
        }
        if !new_of_old.contains(&UNUSED) {
            return;
        }
        let mut from = Vec::new();
        for (old, new) in new_of_old.iter_mut().enumerate() {
            if *new != UNUSED {
                *new = from.len() as u32;
                from.push(old as u32);
            }
        }
        self.indices.iter_mut().for_each(|i| *i = new_of_old[*i as usize]);
        // An attribute list that becomes empty would count as absent, but then there is no triangle either.
        self.gather(&from);
    }

    /// Drops triangles with a vertex that is not finite or too far away; returns their number.
    pub(super) fn drop_unbounded(&mut self) -> usize {
        // NaN fails the comparison.
        let sound: Vec<bool> =
            self.positions.iter().map(|p| p.to_array().iter().all(|v| v.abs() <= LARGEST_COORDINATE_M)).collect();
        if sound.iter().all(|&sound| sound) {
            return 0;
        }
        let before = self.indices.len();
        let indices = std::mem::take(&mut self.indices);
        self.indices =
            indices.chunks_exact(3).filter(|t| t.iter().all(|&i| sound[i as usize])).flatten().copied().collect();
        self.compact();
        (before - self.indices.len()) / 3
    }

    /// Reverses the winding of every triangle.
    pub(super) fn flip(&mut self) {
        self.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
    }

    /// Applies a transform to positions and normals; the normals need [`Self::repair_normals`] after it.
    pub(super) fn transform(&mut self, matrix: Mat4) {
        let cofactor = cofactor(Mat3::from_mat4(matrix));
        self.positions.iter_mut().for_each(|p| *p = matrix.transform_point3(*p));
        self.normals.iter_mut().for_each(|n| *n = cofactor * *n);
    }

    /// Normalizes every normal. A normal without direction is recomputed from the triangles around its vertex, weighted by
    /// area; if those have no area either, it is up.
    pub(super) fn repair_normals(&mut self) {
        self.normals.resize(self.positions.len(), Vec3::ZERO);
        let mut lost = false;
        for normal in &mut self.normals {
            *normal = unit(normal.as_dvec3()).unwrap_or(Vec3::ZERO);
            lost |= *normal == Vec3::ZERO;
        }
        if !lost {
            return;
        }
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in self.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| self.positions[triangle[k] as usize].as_dvec3());
            let doubled_area = (b - a).cross(c - a);
            triangle.iter().for_each(|&i| sums[i as usize] += doubled_area);
        }
        for (normal, sum) in self.normals.iter_mut().zip(sums) {
            if *normal == Vec3::ZERO {
                *normal = unit(sum).unwrap_or(Vec3::Y);
            }
        }
    }

    /// Whether any triangle has an area other than zero.
    pub(super) fn has_area(&self) -> bool {
        self.indices.chunks_exact(3).any(|t| {
            let [a, b, c] = [0, 1, 2].map(|k| self.positions[t[k] as usize].as_dvec3());
            (b - a).cross(c - a) != DVec3::ZERO
        })
    }
}

/// Normalizes in double precision, so that lengths such as 1e20 neither overflow nor vanish.
fn unit(v: DVec3) -> Option<Vec3> {
    let length = v.length();
    (length.is_finite() && length > 0.0).then(|| (v / length).as_vec3())
}

/// Matrix that transforms normals with a linear map: the inverse transpose times |det|, also defined for singular maps.
/// A mirror keeps the side of normals but reverses the winding; see [`Geometry::flip`].
pub(super) fn cofactor(m: Mat3) -> Mat3 {
    let c = Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    if m.determinant() < 0.0 { -1.0 * c } else { c }
}
