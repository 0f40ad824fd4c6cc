//! A mesh as a host has it: where its vertices and indices lie, and how they are written.

use antumbra_light::Aabb;
use glam::{Affine2, Vec3};

/// A mesh in a host's buffers, for [`CasterSet::add_mesh`](super::CasterSet::add_mesh).
///
/// The set packs it into buffers of its own. To that end buffers need the usage `STORAGE` or `COPY_SRC`, which vertex and
/// index buffers that engines grow have anyway.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Number of vertices.
    pub vertex_count: u32,
    /// Vertex positions.
    pub positions: Positions<'a>,
    /// Vertex texture coordinates, for casters whose surface has a texture.
    pub texture_coordinates: Option<TextureCoordinates<'a>>,
    /// Corners in the order of `topology`; `None`: vertices are in that order.
    pub indices: Option<Indices<'a>>,
    /// `TriangleList`, or `TriangleStrip`, in which the index of all ones begins another strip. Others cast nothing, and are
    /// refused.
    pub topology: wgpu::PrimitiveTopology,
    /// Triangles counter-clockwise from outside bound a solid, which holds no receivers but where the camera's near plane is
    /// within its box. Some techniques then need no bias. Strips are taken for open.
    pub closed: bool,
    /// Object-space box of all positions, of every pose where they change; infinite on sides that are not known.
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
    /// Four 16-bit integers, of which three count: −32767 to 32767 stand for −1 to 1, times `scale`, plus `offset`.
    Snorm16x4 {
        /// Half the mesh's sides, as a rule.
        scale: Vec3,
        /// The mesh's middle, as a rule.
        offset: Vec3,
    },
    /// Four 16-bit integers, of which three count: 0 to 65535 stand for 0 to 1, times `scale`, plus `offset`.
    Unorm16x4 {
        /// The mesh's sides, as a rule.
        scale: Vec3,
        /// The mesh's least corner, as a rule.
        offset: Vec3,
    },
}

impl PositionFormat {
    /// Bytes of one.
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
    /// Two 16-bit integers: 0 to 65535 stand for 0 to 1.
    Unorm16x2,
    /// Two 16-bit integers: −32767 to 32767 stand for −1 to 1.
    Snorm16x2,
}

impl TextureCoordinateFormat {
    /// Bytes of a pair.
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
    /// The same on the GPU, read with the next [`CasterSet::update`](super::CasterSet::update).
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
    /// World-space box of all of them, infinite on sides that are not known; `None` where nothing is. What of it lies behind all that
    /// receives, or beside, changes nothing; say where that is (`Receivers::bounds`), for maps are as fine as they are small.
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
    /// Bytes of one.
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::Columns4x4 => 64,
            Self::Rows3x4 => 48,
        }
    }
}
