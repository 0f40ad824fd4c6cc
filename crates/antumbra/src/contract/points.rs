//! Points as receivers: a host's buffer of positions in place of a depth buffer.

use antumbra_light::Aabb;
use glam::Vec3;

/// Attribute of points in a host's buffer: 32-bit floats with an offset and a stride.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointBuffer<'a> {
    /// Buffer with usage `STORAGE`. All of it is bound, so it may be as large as one binding.
    pub buffer: &'a wgpu::Buffer,
    /// Offset of the first point, bytes; a multiple of 4.
    pub offset: u64,
    /// Stride, bytes; a multiple of 4. 12 for three floats without a gap, 16 for a `vec4f`.
    pub stride: u32,
}

impl<'a> PointBuffer<'a> {
    /// Tightly packed attribute: three floats per point.
    pub fn packed(buffer: &'a wgpu::Buffer) -> Self {
        Self { buffer, offset: 0, stride: 12 }
    }

    /// Padded attribute: three floats of four, as WGSL lays out an array of `vec3f` or `vec4f`. The fourth is not read.
    pub fn padded(buffer: &'a wgpu::Buffer) -> Self {
        Self { stride: 16, ..Self::packed(buffer) }
    }
}

/// Widths of points. A point represents a square of its plane; techniques that filter over a pixel's footprint filter over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointWidths<'a> {
    /// One width for all points, metres; zero, the default, for points without extent.
    Same(f32),
    /// One float per point, metres. Negative and non-finite values count as zero.
    Each(PointBuffer<'a>),
}

impl Default for PointWidths<'_> {
    fn default() -> Self {
        Self::Same(0.0)
    }
}

/// Receivers of one frame, given as points: probes, texels of lightmaps, splats, particles.
#[derive(Clone, Copy, Debug)]
pub struct PointReceivers<'a> {
    /// Number of points.
    pub count: u32,
    /// World-space positions, three floats each. A point that is not finite is no receiver and is lit.
    pub positions: PointBuffer<'a>,
    /// World-space normals, three floats each, of any length. A point with a normal lies on a surface, which shades itself where it
    /// faces away from the light. `None`, or a normal of length zero: the point faces the light's centre. Without normals, points
    /// may lie anywhere, even inside closed casters; with them, they lie on or outside closed casters.
    pub normals: Option<PointBuffer<'a>>,
    /// Widths of the points.
    pub widths: PointWidths<'a>,
    /// Number of points in a row, if they lie in rows as the texels of a lightmap do. Random numbers are then those of pixels
    /// there, and workgroups take 8 × 8 points. `None`: a workgroup takes 64 consecutive points, so order them by position if you
    /// can.
    pub row_length: Option<u32>,
    /// World-space box that holds every point: light maps are fitted to it. Unknown sides may be infinite.
    pub bounds: Aabb,
    /// World-space points whose convex hull holds every point, for hosts that have one tighter than `bounds`; otherwise empty.
    pub hull: &'a [Vec3],
    /// A few hundred of the points. Maps whose texels differ in size place the small ones there. Empty: anywhere in the hull.
    pub seen: &'a [Vec3],
    /// Generation counter: change it whenever the buffers' contents change; see [`Receivers::version`](super::Receivers::version).
    pub version: Option<u64>,
}

impl<'a> PointReceivers<'a> {
    /// Buffers of positions, normals and widths; `None` for absent ones.
    pub(crate) fn buffers(&self) -> [Option<PointBuffer<'a>>; 3] {
        let widths = match self.widths {
            PointWidths::Same(_) => None,
            PointWidths::Each(widths) => Some(widths),
        };
        [Some(self.positions), self.normals, widths]
    }

    /// Creates receivers without normals or widths, in any order.
    pub fn new(count: u32, positions: PointBuffer<'a>, bounds: Aabb) -> Self {
        Self {
            count,
            positions,
            normals: None,
            widths: PointWidths::default(),
            row_length: None,
            bounds,
            hull: &[],
            seen: &[],
            version: None,
        }
    }
}
