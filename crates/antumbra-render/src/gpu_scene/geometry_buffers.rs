//! Buffers of vertices and triangles. As many geometries share them as fit a binding, because readers of casters' triangles process
//! all geometries in the same buffers at once.

use antumbra::Gpu;
use glam::{Vec2, Vec3, Vec4};
use wgpu::util::DeviceExt;

use super::GEOMETRY_USAGE;
use super::split::MeshPart;

/// Vertices and triangles of several geometries on the GPU.
#[derive(Debug)]
pub(crate) struct GeometryBuffers {
    pub positions: wgpu::Buffer,
    pub normals: wgpu::Buffer,
    pub uvs: Option<wgpu::Buffer>,
    pub colors: Option<wgpu::Buffer>,
    /// Vertex indices, counted from the buffers' first vertex.
    pub indices: wgpu::Buffer,
}

/// Location of a geometry's vertices and triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Index into [`GpuScene::buffers`](super::GpuScene::buffers).
    pub buffers: usize,
    pub first_vertex: u32,
    pub first_index: u32,
}

/// Vertices and triangles of several geometries.
#[derive(Debug, Default)]
struct Joined {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec4>,
    indices: Vec<u32>,
    /// Whether no further geometry may be added.
    is_closed: bool,
}

/// Buffers of a scene before their upload.
#[derive(Debug)]
pub(super) struct JoinedGeometries {
    joined: Vec<Joined>,
    binding_bytes: u64,
}

impl JoinedGeometries {
    pub(super) fn new(binding_bytes: u64) -> Self {
        Self { joined: Vec::new(), binding_bytes }
    }

    /// Adds a geometry, to new buffers unless it shares existing ones.
    pub(super) fn push(&mut self, part: &MeshPart<'_>, shares: bool) -> Place {
        let takes = |joined: &Joined| joined.takes(part, self.binding_bytes);
        let open = if shares { self.joined.iter().rposition(takes) } else { None };
        let buffers = open.unwrap_or_else(|| {
            self.joined.push(Joined { is_closed: !shares, ..Joined::default() });
            self.joined.len() - 1
        });
        let joined = &mut self.joined[buffers];
        let place =
            Place { buffers, first_vertex: joined.positions.len() as u32, first_index: joined.indices.len() as u32 };
        joined.positions.extend_from_slice(&part.positions);
        joined.normals.extend_from_slice(&part.normals);
        joined.uvs.extend_from_slice(&part.uvs);
        joined.colors.extend_from_slice(&part.colors);
        joined.indices.extend(part.indices.iter().map(|index| place.first_vertex + index));
        place
    }

    /// Uploads all buffers; also returns their bytes.
    pub(super) fn upload(self, gpu: &Gpu) -> (Vec<GeometryBuffers>, u64) {
        let mut bytes = 0;
        let mut buffer = |label: &str, contents: &[u8], usage| {
            bytes += contents.len() as u64;
            let usage = GEOMETRY_USAGE | usage;
            gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
        };
        let nothing_else = wgpu::BufferUsages::empty();
        let buffers = self.joined.iter().map(|joined| GeometryBuffers {
            positions: buffer("positions", bytemuck::cast_slice(&joined.positions), nothing_else),
            normals: buffer("normals", bytemuck::cast_slice(&joined.normals), nothing_else),
            uvs: (!joined.uvs.is_empty())
                .then(|| buffer("texture coordinates", bytemuck::cast_slice(&joined.uvs), nothing_else)),
            colors: (!joined.colors.is_empty())
                .then(|| buffer("vertex colours", bytemuck::cast_slice(&joined.colors), nothing_else)),
            indices: buffer("indices", bytemuck::cast_slice(&joined.indices), wgpu::BufferUsages::INDEX),
        });
        let buffers = buffers.collect();
        (buffers, bytes)
    }
}

impl Joined {
    /// Whether a geometry has the same attributes and fits.
    fn takes(&self, part: &MeshPart<'_>, binding_bytes: u64) -> bool {
        let attributes = (self.uvs.is_empty(), self.colors.is_empty());
        // Colours are the widest of the vertex buffers.
        let vertex_bytes = (self.positions.len() + part.positions.len()) * size_of::<Vec4>();
        let index_bytes = (self.indices.len() + part.indices.len()) * size_of::<u32>();
        !self.is_closed
            && attributes == (part.uvs.is_empty(), part.colors.is_empty())
            && vertex_bytes.max(index_bytes) as u64 <= binding_bytes
    }
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use super::*;

    fn triangle(uvs: usize) -> MeshPart<'static> {
        MeshPart {
            positions: Cow::Owned(vec![Vec3::X, Vec3::Y, Vec3::Z]),
            normals: Cow::Owned(vec![Vec3::Y; 3]),
            uvs: Cow::Owned(vec![Vec2::ONE; uvs]),
            colors: Cow::Owned(Vec::new()),
            indices: Cow::Owned(vec![0, 1, 2]),
        }
    }

    #[test]
    fn geometries_of_the_same_attributes_share_buffers_as_long_as_they_fit() {
        // Room for seven vertices.
        let mut all = JoinedGeometries::new(7 * size_of::<Vec4>() as u64);
        let mut places = Vec::new();
        for (uvs, shares) in [(0, true), (3, true), (0, true), (0, false), (3, true), (0, true)] {
            let Place { buffers, first_vertex, first_index } = all.push(&triangle(uvs), shares);
            places.push((buffers, first_vertex, first_index));
        }
        assert_eq!(places, [(0, 0, 0), (1, 0, 0), (0, 3, 3), (2, 0, 0), (1, 3, 3), (3, 0, 0)]);
        assert_eq!(all.joined[0].indices, [0, 1, 2, 3, 4, 5]);
        assert_eq!((all.joined[1].uvs.len(), all.joined[0].uvs.len()), (6, 0));
    }
}
