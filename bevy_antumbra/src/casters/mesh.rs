//! A mesh in Bevy's slabs, described for the library's caster set.

use antumbra::casters::{
    Indices, Mesh as CasterMesh, PositionFormat, Positions, TextureCoordinateFormat, TextureCoordinates,
};
use antumbra::light::Aabb;
use bevy::asset::AssetId;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{Mesh, MeshVertexAttribute, VertexFormat};
use bevy::render::mesh::allocator::MeshAllocator;
use bevy::render::mesh::{RenderMesh, RenderMeshBufferInfo};
use bevy::render::render_resource::PrimitiveTopology;

use super::surface::SurfaceTexture;

/// Reason why a mesh cannot cast.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// The mesh is not on the GPU yet.
    #[error("a mesh is not on the GPU yet")]
    NotThere,
    /// The mesh is not a triangle list.
    #[error("a mesh of {0:?} casts no shadow: only triangle lists are supported")]
    Topology(PrimitiveTopology),
    /// The mesh has no positions, or in an unknown format.
    #[error("a mesh with positions of {0:?} casts no shadow: only Float32x3 and Snorm16x4 are supported")]
    Positions(Option<VertexFormat>),
    /// The mesh has a skeleton, and its joints or weights are missing or of an unknown format.
    #[error(
        "a mesh with joints of {0:?} and weights of {1:?} casts no shadow: only Uint16x4 with Float32x4 or Unorm16x4 is supported"
    )]
    Joints(Option<VertexFormat>, Option<VertexFormat>),
    /// The mesh exceeds the range of a shader's 32-bit offsets.
    #[error("a mesh of more than 16 GiB casts no shadow")]
    TooFar,
}

/// Boxes that decode compressed attributes of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct MeshBoxes {
    /// Box of the undeformed mesh.
    pub positions: Aabb,
    /// Minimum and extent of both sets of texture coordinates, if compressed.
    pub uvs: [Option<[glam::Vec2; 2]>; 2],
}

/// Location and layout of a mesh in Bevy's slabs.
pub struct MeshPlace<'a> {
    pub vertices: &'a wgpu::Buffer,
    /// Offset of the first vertex, bytes.
    pub first: u64,
    pub stride: u64,
    pub vertex_count: u32,
    pub boxes: MeshBoxes,
    render_mesh: &'a RenderMesh,
}

impl<'a> MeshPlace<'a> {
    /// Size of a vertex in a morph target, bytes.
    pub const TARGET_BYTES: u64 = size_of::<MorphAttributes>() as u64;

    pub fn new(
        id: AssetId<Mesh>,
        mesh: &'a RenderMesh,
        allocator: &'a MeshAllocator,
        boxes: MeshBoxes,
    ) -> Result<Self, MeshError> {
        let topology = mesh.primitive_topology();
        if topology != PrimitiveTopology::TriangleList {
            return Err(MeshError::Topology(topology));
        }
        let slice = allocator.mesh_vertex_slice(&id).ok_or(MeshError::NotThere)?;
        let stride = mesh.layout.0.layout().array_stride;
        let first = u64::from(slice.range.start) * stride;
        Ok(Self { vertices: slice.buffer, first, stride, vertex_count: mesh.vertex_count, boxes, render_mesh: mesh })
    }

    /// Returns the offset of an attribute in a vertex, bytes, and its format.
    pub fn attribute(&self, attribute: MeshVertexAttribute) -> Option<(u64, VertexFormat)> {
        let layout = &self.render_mesh.layout.0;
        let i = layout.attribute_ids().iter().position(|id| *id == attribute.id)?;
        let attribute = &layout.layout().attributes[i];
        Some((attribute.offset, attribute.format))
    }

    /// Returns the indices; `None` if the mesh has none.
    pub fn indices(&self, id: AssetId<Mesh>, allocator: &'a MeshAllocator) -> Result<Option<Indices<'a>>, MeshError> {
        let RenderMeshBufferInfo::Indexed { count, index_format } = self.render_mesh.buffer_info else {
            return Ok(None);
        };
        let slice = allocator.mesh_index_slice(&id).ok_or(MeshError::NotThere)?;
        Ok(Some(Indices {
            buffer: slice.buffer,
            format: index_format,
            first_index: slice.range.start,
            count,
            base_vertex: 0,
        }))
    }

    /// Returns the buffer of morph targets and the offset of the first one, bytes.
    pub fn morph_targets(
        &self,
        id: AssetId<Mesh>,
        allocator: &'a MeshAllocator,
    ) -> Result<(&'a wgpu::Buffer, u64), MeshError> {
        let slice = allocator.mesh_morph_target_slice(&id).ok_or(MeshError::NotThere)?;
        Ok((slice.buffer, u64::from(slice.range.start) * Self::TARGET_BYTES))
    }

    /// Returns the texture coordinates that a texture needs; `None` if the mesh lacks them.
    pub fn uvs(&self, texture: &SurfaceTexture) -> Option<TextureCoordinates<'a>> {
        let attribute = if texture.second_uvs { Mesh::ATTRIBUTE_UV_1 } else { Mesh::ATTRIBUTE_UV_0 };
        let (offset, format) = self.attribute(attribute)?;
        let of_texture = glam::Affine2::from_cols_array(&texture.uv_transform);
        let (format, transform) = match format {
            VertexFormat::Float32x2 => (TextureCoordinateFormat::Float32x2, of_texture),
            VertexFormat::Unorm16x2 => {
                let [least, extent] = self.boxes.uvs[usize::from(texture.second_uvs)]?;
                let of_box = glam::Affine2::from_scale_angle_translation(extent, 0.0, least);
                (TextureCoordinateFormat::Unorm16x2, of_texture * of_box)
            }
            _ => return None,
        };
        Some(TextureCoordinates {
            buffer: self.vertices,
            offset: self.first + offset,
            stride: self.stride,
            format,
            transform,
        })
    }

    /// Returns the undeformed mesh as the library describes meshes. Its box decodes compressed positions.
    pub fn of_library(
        &self,
        id: AssetId<Mesh>,
        allocator: &'a MeshAllocator,
        texture: Option<&SurfaceTexture>,
    ) -> Result<CasterMesh<'a>, MeshError> {
        let bounds = self.boxes.positions;
        let position = self.attribute(Mesh::ATTRIBUTE_POSITION);
        let format = match position {
            Some((_, VertexFormat::Float32x3)) => PositionFormat::Float32x3,
            Some((_, VertexFormat::Snorm16x4)) => {
                PositionFormat::Snorm16x4 { scale: 0.5 * (bounds.max - bounds.min), offset: bounds.center() }
            }
            _ => return Err(MeshError::Positions(position.map(|(_, format)| format))),
        };
        let offset = self.first + position.map_or(0, |(offset, _)| offset);
        Ok(CasterMesh {
            vertex_count: self.vertex_count,
            positions: Positions { buffer: self.vertices, offset, stride: self.stride, format },
            texture_coordinates: texture.and_then(|texture| self.uvs(texture)),
            indices: self.indices(id, allocator)?,
            // Bevy does not know whether a mesh is closed; open is always correct.
            topology: PrimitiveTopology::TriangleList,
            closed: false,
            bounds,
        })
    }
}
