//! What a technique's light map holds, for whoever wants to look at it.

use glam::UVec2;

/// A depth map that was drawn from a light, by the frame that was prepared last; the next one of the same light draws over it.
///
/// Masks want none of it: it is for tools that show what a technique sees.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnMap {
    /// Depth of `size_px` texels and `sample_count` samples, to be bound as a depth texture, multisampled where there are
    /// several. Rows run against the light's up.
    pub depth: wgpu::TextureView,
    /// Width and height, texels.
    pub size_px: UVec2,
    /// Samples a texel.
    pub sample_count: u32,
    /// What it holds where nothing casts.
    pub empty_depth: f32,
    /// The nearest and the farthest place that it has room for, metres along the light's axis from where it is seen from.
    pub range_m: [f32; 2],
    /// How it holds them: metres along the axis are `(depth − depth_offset) / depth_scale`, of a lamp's map the reciprocal of
    /// that.
    pub is_perspective: bool,
    /// See [`is_perspective`](Self::is_perspective).
    pub depth_scale: f32,
    /// See [`is_perspective`](Self::is_perspective).
    pub depth_offset: f32,
}
