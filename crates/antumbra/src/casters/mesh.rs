//! Mesh as a host provides it: places and formats of its vertices and indices.

use antumbra_light::Aabb;
use glam::{Affine2, Vec3};

/// Mesh in a host's buffers, for [`CasterSet::add_mesh`](super::CasterSet::add_mesh).
///
/// The set packs it into its own buffers. To be readable, the host's buffers need the usage `STORAGE` or `COPY_SRC`, which
/// vertex and index buffers that engines grow have anyway.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Number of vertices.
    pub vertex_count: u32,
    /// Vertex positions.
    pub positions: Positions<'a>,
    /// Vertex texture coordinates, for casters whose surface has a texture.
    pub texture_coordinates: Option<TextureCoordinates<'a>>,
    /// Indices of the corners, in the order of `topology`; `None` if the vertices are in that order.
    pub indices: Option<Indices<'a>>,
    /// `TriangleList`, or `TriangleStrip`, in which an index with all bits set starts a new strip. Other topologies cast no
    /// shadow and are refused.
    pub topology: wgpu::PrimitiveTopology,
    /// Whether the triangles, counter-clockwise from outside, bound a solid that contains no receivers, except where the
    /// camera's near plane is within its box. Some techniques then need no bias. Strips count as open.
    pub closed: bool,
    /// Object-space box of all positions, in every pose if they change; infinite on unknown sides.
    pub bounds: Aabb,
}

/// Positions, one per vertex.
#[derive(Clone, Copy, Debug)]
pub struct Positions<'a> {
    /// Buffer.
    pub buffer: &'a wgpu::Buffer,
    /// Offset of the first element, bytes; a multiple of four.
    pub offset: u64,
    /// Stride, bytes; a multiple of four.
    pub stride: u64,
    /// Element format.
    pub format: PositionFormat,
}

/// Position format.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PositionFormat {
    /// Three 32-bit floats.
    Float32x3,
    /// Four 16-bit integers, the fourth ignored: −32767 to 32767 map to −1 to 1, then × `scale` + `offset`.
    Snorm16x4 {
        /// Usually half the sides of the mesh's box.
        scale: Vec3,
        /// Usually the centre of the mesh's box.
        offset: Vec3,
    },
    /// Four 16-bit integers, the fourth ignored: 0 to 65535 map to 0 to 1, then × `scale` + `offset`.
    Unorm16x4 {
        /// Usually the sides of the mesh's box.
        scale: Vec3,
        /// Usually the minimum corner of the mesh's box.
        offset: Vec3,
    },
}

impl PositionFormat {
    /// Size of a position, bytes.
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::Float32x3 => 12,
            Self::Snorm16x4 { .. } | Self::Unorm16x4 { .. } => 8,
        }
    }
}

/// Texture coordinates, one pair per vertex.
#[derive(Clone, Copy, Debug)]
pub struct TextureCoordinates<'a> {
    /// Buffer.
    pub buffer: &'a wgpu::Buffer,
    /// Offset of the first element, bytes; a multiple of four.
    pub offset: u64,
    /// Stride, bytes; a multiple of four.
    pub stride: u64,
    /// Element format.
    pub format: TextureCoordinateFormat,
    /// Transform of the coordinates, as by `KHR_texture_transform`.
    pub transform: Affine2,
}

/// Texture coordinate format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TextureCoordinateFormat {
    /// Two 32-bit floats.
    Float32x2,
    /// Two 16-bit floats.
    Float16x2,
    /// Two 16-bit integers: 0 to 65535 map to 0 to 1.
    Unorm16x2,
    /// Two 16-bit integers: −32767 to 32767 map to −1 to 1.
    Snorm16x2,
}

impl TextureCoordinateFormat {
    /// Size of a pair, bytes.
    pub(super) fn bytes(self) -> u64 {
        if self == Self::Float32x2 { 8 } else { 4 }
    }
}

/// Index buffer range.
#[derive(Clone, Copy, Debug)]
pub struct Indices<'a> {
    /// Buffer, read from offset 0.
    pub buffer: &'a wgpu::Buffer,
    /// Index format: 16 or 32 bits.
    pub format: wgpu::IndexFormat,
    /// First index to use.
    pub first_index: u32,
    /// Number of indices to use.
    pub count: u32,
    /// Value added to each index.
    pub base_vertex: i32,
}

/// World transforms of a caster's instances.
#[derive(Clone, Copy, Debug)]
pub enum Instances<'a> {
    /// World-from-object matrices, affine.
    Matrices(&'a [glam::Mat4]),
    /// World-from-object matrices in a GPU buffer, read with the next [`CasterSet::update`](super::CasterSet::update).
    Buffer(InstanceBuffer<'a>),
}

/// World-from-object matrices in a host's buffer, which needs the usage `STORAGE` or `COPY_SRC`.
#[derive(Clone, Copy, Debug)]
pub struct InstanceBuffer<'a> {
    /// Buffer.
    pub buffer: &'a wgpu::Buffer,
    /// Offset of the first element, bytes; a multiple of four.
    pub offset: u64,
    /// Stride, bytes; a multiple of four.
    pub stride: u64,
    /// Element format.
    pub layout: InstanceLayout,
    /// Number of matrices.
    pub count: u32,
    /// World-space box of all instances, infinite on unknown sides; `None` if unknown. Parts behind or beside all receivers
    /// have no effect. Set `Receivers::bounds`, too: maps over smaller areas are finer.
    pub bounds: Option<Aabb>,
}

/// Matrix layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstanceLayout {
    /// Four columns of four 32-bit floats.
    Columns4x4,
    /// Three rows of four 32-bit floats.
    Rows3x4,
}

impl InstanceLayout {
    /// Size of a matrix, bytes.
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::Columns4x4 => 64,
            Self::Rows3x4 => 48,
        }
    }
}
