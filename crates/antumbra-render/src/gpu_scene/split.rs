//! Splitting of meshes so that each of their buffers fits one binding.

use std::borrow::Cow;
use std::collections::HashMap;

use antumbra_scene::Mesh;
use glam::{Vec2, Vec3, Vec4};

/// All or some triangles of a mesh, with the vertices that they use.
#[derive(Clone, Debug)]
pub(crate) struct MeshPart<'a> {
    pub positions: Cow<'a, [Vec3]>,
    pub normals: Cow<'a, [Vec3]>,
    /// Texture coordinates, as many as positions, or none.
    pub uvs: Cow<'a, [Vec2]>,
    /// Vertex colours, as many as positions, or none.
    pub colors: Cow<'a, [Vec4]>,
    pub indices: Cow<'a, [u32]>,
}

/// Returns the whole mesh if its buffers fit `binding_bytes`, else runs of triangles that fit.
pub(crate) fn split_mesh(mesh: &Mesh, binding_bytes: u64) -> Vec<MeshPart<'_>> {
    // Colours are the widest of the vertex buffers.
    let vertex_capacity = binding_bytes as usize / size_of::<Vec4>();
    let index_capacity = binding_bytes as usize / size_of::<u32>() / 3 * 3;
    let triangle_index_count = mesh.indices.len() / 3 * 3;
    let indices = &mesh.indices[..triangle_index_count];
    if mesh.positions.len() <= vertex_capacity && indices.len() <= index_capacity {
        return vec![MeshPart {
            positions: Cow::Borrowed(&mesh.positions),
            normals: Cow::Borrowed(&mesh.normals),
            uvs: Cow::Borrowed(&mesh.uvs),
            colors: Cow::Borrowed(&mesh.colors),
            indices: Cow::Borrowed(indices),
        }];
    }
    let mut parts = Vec::new();
    let mut run = Run::default();
    for triangle in indices.chunks_exact(3) {
        if run.old_vertices.len() + 3 > vertex_capacity || run.indices.len() + 3 > index_capacity {
            parts.push(std::mem::take(&mut run).part_of(mesh));
        }
        run.push(triangle);
    }
    parts.push(run.part_of(mesh));
    parts
}

/// Run of triangles with renumbered vertices.
#[derive(Default)]
struct Run {
    indices: Vec<u32>,
    old_vertices: Vec<u32>,
    new_of_old: HashMap<u32, u32>,
}

impl Run {
    fn push(&mut self, triangle: &[u32]) {
        for old in triangle {
            let new = *self.new_of_old.entry(*old).or_insert_with(|| {
                self.old_vertices.push(*old);
                self.old_vertices.len() as u32 - 1
            });
            self.indices.push(new);
        }
    }

    fn part_of(self, mesh: &Mesh) -> MeshPart<'static> {
        fn gather<T: Copy>(old_vertices: &[u32], values: &[T]) -> Cow<'static, [T]> {
            if values.is_empty() {
                return Cow::Owned(Vec::new());
            }
            Cow::Owned(old_vertices.iter().map(|old| values[*old as usize]).collect())
        }
        MeshPart {
            positions: gather(&self.old_vertices, &mesh.positions),
            normals: gather(&self.old_vertices, &mesh.normals),
            uvs: gather(&self.old_vertices, &mesh.uvs),
            colors: gather(&self.old_vertices, &mesh.colors),
            indices: Cow::Owned(self.indices),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_the_same_triangles() {
        let n = 20u32;
        let mesh = Mesh {
            positions: (0..n).map(|i| Vec3::splat(i as f32)).collect(),
            normals: vec![Vec3::Y; n as usize],
            colors: (0..n).map(|i| Vec4::splat(i as f32)).collect(),
            indices: (0..n - 2).flat_map(|i| [i, i + 1, i + 2]).collect(),
            ..Mesh::default()
        };
        let corners = |parts: &[MeshPart<'_>]| -> Vec<(Vec3, Vec4)> {
            let of_part = |part: &MeshPart<'_>| -> Vec<_> {
                part.indices.iter().map(|i| (part.positions[*i as usize], part.colors[*i as usize])).collect()
            };
            parts.iter().flat_map(of_part).collect()
        };
        let whole = split_mesh(&mesh, 1 << 20);
        assert_eq!(whole.len(), 1);
        let bytes = 7 * size_of::<Vec4>() as u64;
        let parts = split_mesh(&mesh, bytes);
        assert!(parts.len() > 2);
        assert!(parts.iter().all(|part| part.colors.len() <= 7 && size_of_val(&part.indices[..]) as u64 <= bytes));
        assert!(parts.iter().all(|part| part.uvs.is_empty()));
        assert_eq!(corners(&parts), corners(&whole));
    }
}
