//! Coherent shading: smooth shading that is dark wherever triangles are in their own shadow.
//!
//! A host that shades by smooth vertex normals lights triangles that the light does not reach; exact visibility cuts that
//! light off along the triangles' edges. Sintorn, Eisemann, Assarsson 2008 (section 4.3, figure 8) bend the normals: a
//! vertex is as bright as the darkest of the triangles around it,
//!
//! ```text
//! l_bend = min over F in adj(v) of  l · n_F          at each vertex, interpolated
//! α      = min(1, max(3 l_bend, 0))                  at each pixel
//! shade  = α l_f + (1 − α) l_bend                    l_f: by the smooth normal
//! ```
//!
//! A triangle that faces away is adjacent to all of its own vertices, so it is black. Surfaces that face the light well keep their
//! shading. [`VertexFaces`] has the data for the host's vertex shader, [`COHERENT_WGSL`] the rest. For an area light, replace the
//! cosine by its irradiance divided by that of a surface facing the light: then only triangles turned away from all of the light
//! are black.

use std::collections::HashMap;

use glam::Vec3;

/// WGSL of `fn coherent_cosine(smooth_cosine: f32, bent_cosine: f32) -> f32`: the last two lines of the formula, at least 0.
pub const COHERENT_WGSL: &str = include_str!("coherent.wgsl");

/// Face normals around each vertex.
///
/// A triangle is adjacent to a vertex if one of its corners has the vertex's position and normal: seams of texture coordinates do
/// not separate triangles, hard edges do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexFaces {
    /// Offsets into `normals`: vertex `v` has those from `first[v]` up to `first[v + 1]`; one entry more than vertices.
    pub first: Vec<u32>,
    /// Unit normals in the space of the positions, on the counter-clockwise side.
    pub normals: Vec<Vec3>,
}

impl VertexFaces {
    /// Gathers the triangles around each vertex. Triangles without area are ignored.
    ///
    /// # Panics
    /// If the numbers of normals and positions differ, or an index is out of range.
    pub fn new(positions: &[Vec3], normals: &[Vec3], indices: &[u32]) -> Self {
        assert_eq!(positions.len(), normals.len(), "the number of normals must equal the number of positions");
        // Adding zero turns −0 into +0, so that both have one key.
        let key = |v: usize| [positions[v], normals[v]].map(|p| (p + Vec3::ZERO).to_array().map(f32::to_bits));
        let mut places = HashMap::with_capacity(positions.len());
        let place_of: Vec<usize> = (0..positions.len())
            .map(|v| {
                let next = places.len();
                *places.entry(key(v)).or_insert(next)
            })
            .collect();
        let mut around: Vec<Vec<Vec3>> = vec![Vec::new(); places.len()];
        for triangle in indices.chunks_exact(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|i| i as usize);
            let edges = [positions[b] - positions[a], positions[c] - positions[a]].map(Vec3::as_dvec3);
            let Some(normal) = edges[0].cross(edges[1]).try_normalize() else { continue };
            for corner in [a, b, c] {
                around[place_of[corner]].push(normal.as_vec3());
            }
        }
        let mut faces = Self { first: vec![0], normals: Vec::new() };
        for place in place_of {
            faces.normals.extend_from_slice(&around[place]);
            faces.first.push(faces.normals.len() as u32);
        }
        faces
    }

    /// Face normals around one vertex; empty for a vertex without triangles.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn of(&self, vertex: usize) -> &[Vec3] {
        &self.normals[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seams_do_not_part_and_hard_edges_do() {
        // A roof of two sides along the z axis: its ridge is doubled, once as a seam and once as a hard edge.
        let ridge = [Vec3::Y, Vec3::new(0.0, 1.0, 1.0)];
        let positions = [ridge[0], ridge[1], Vec3::NEG_X, ridge[0], ridge[1], Vec3::X];
        let indices = [0, 2, 1, 3, 4, 5];
        let seam = VertexFaces::new(&positions, &[Vec3::Y; 6], &indices);
        assert_eq!((seam.of(0).len(), seam.of(3).len(), seam.of(2).len()), (2, 2, 1));
        assert!(seam.of(0).iter().all(|n| n.y > 0.7) && seam.of(2)[0].x < -0.7);
        let sides = [Vec3::NEG_X, Vec3::NEG_X, Vec3::NEG_X, Vec3::X, Vec3::X, Vec3::X];
        let edge = VertexFaces::new(&positions, &sides, &indices);
        assert!((0..6).all(|v| edge.of(v).len() == 1));
    }

    #[test]
    fn triangles_without_area_count_for_none() {
        let faces = VertexFaces::new(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], &[Vec3::Y; 3], &[0, 1, 2]);
        assert!(faces.normals.is_empty() && faces.first == [0; 4]);
    }
}
