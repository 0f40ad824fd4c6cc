//! Points as receivers: a host's buffer of positions in place of a depth buffer.

use antumbra_light::Aabb;
use glam::Vec3;

/// Numbers of points in a host's buffer: so many 32-bit floats for each, interleaved with others as the host likes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointBuffer<'a> {
    /// Usage `STORAGE`; all of it is bound, so that it may be as large as one binding.
    pub buffer: &'a wgpu::Buffer,
    /// Bytes before the first point's; a multiple of 4.
    pub offset: u64,
    /// Bytes from a point to the next; a multiple of 4. 12 for three floats without a gap, 16 for a `vec4f`.
    pub stride: u32,
}

impl<'a> PointBuffer<'a> {
    /// Three floats a point, one after the other.
    pub fn packed(buffer: &'a wgpu::Buffer) -> Self {
        Self { buffer, offset: 0, stride: 12 }
    }

    /// Three floats of four, as WGSL lays out an array of `vec3f` or `vec4f`; the fourth is not read.
    pub fn padded(buffer: &'a wgpu::Buffer) -> Self {
        Self { stride: 16, ..Self::packed(buffer) }
    }
}

/// How wide points are: each stands for a square of its plane, over which techniques that filter by a pixel's footprint filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointWidths<'a> {
    /// Metres, of all. Zero, the usual: points without an extent.
    Same(f32),
    /// Metres, a float a point. What is negative or not finite is taken as zero.
    Each(PointBuffer<'a>),
}

impl Default for PointWidths<'_> {
    fn default() -> Self {
        Self::Same(0.0)
    }
}

/// The receivers of one frame, given as points: probes, texels of lightmaps, splats, particles.
#[derive(Clone, Copy, Debug)]
pub struct PointReceivers<'a> {
    /// How many.
    pub count: u32,
    /// World-space positions, three floats each. One that is not finite receives nothing, and is lit.
    pub positions: PointBuffer<'a>,
    /// World-space normals, three floats each, of any length. A point with a normal lies on a surface, which shades itself where
    /// it faces away from the light. `None`, or a normal of length zero: the point faces the light's centre. Without normals points may lie
    /// anywhere, within closed casters too; with them they lie on or outside closed casters.
    pub normals: Option<PointBuffer<'a>>,
    /// Widths of the points.
    pub widths: PointWidths<'a>,
    /// Points in a row, of points that lie in rows as pixels do: a lightmap's, say. Random numbers are those of pixels there, and
    /// workgroups take 8 × 8. `None`: a workgroup takes 64 points that follow one another, so order them by place if you can.
    pub row_length: Option<u32>,
    /// World-space box that holds every point: light maps are fitted to it. Sides that are not known may be infinitely far.
    pub bounds: Aabb,
    /// World-space points whose convex hull holds every point, for hosts that know it tighter than `bounds`; empty for all others.
    pub hull: &'a [Vec3],
    /// Some hundreds of the points. Maps whose texels may differ in size have the small ones there. Empty: anywhere in the hull.
    pub seen: &'a [Vec3],
    /// A number that is another one whenever the buffers hold something else: as [`Receivers::version`](super::Receivers::version).
    pub version: Option<u64>,
}

impl<'a> PointReceivers<'a> {
    /// Creates receivers without normals or widths, in no order.
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
