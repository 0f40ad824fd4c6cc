//! Light map of a technique, for inspection.

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
    /// Samples per texel.
    pub sample_count: u32,
    /// Clear value: the depth of texels without a caster.
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
    /// Of a window that is warped towards what the camera sees, what its depths were multiplied with before they were stored: of
    /// the place (u, v), rows downwards, `warp[0] + warp[1] u + warp[2] v`. Of all others (1, 0, 0). Layers behind have it, levels
    /// do not.
    pub depth_warp: [f32; 3],
    /// Of which of the light's points it is seen, counted from 0, where each has a map of its own; maps take turns, so that
    /// those of the last points are there.
    pub light_point: Option<u32>,
    /// Layers of casters behind the map's, the nearest first: to be bound as `depth`, with one sample.
    pub layers_behind: Vec<wgpu::TextureView>,
    /// What was made of the map and is read besides it or in its place, the finest first.
    pub levels: Vec<MapLevel>,
}

/// One level of textures derived from a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapLevel {
    /// 2D texture view.
    pub view: wgpu::TextureView,
    /// Corner of the level in the texture, texels.
    pub origin_px: UVec2,
    /// Width and height of the level: the texels that stand for the map.
    pub size_px: UVec2,
    /// Content of the texels.
    pub texels: LevelTexels,
}

/// Content of the texels of a [`MapLevel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelTexels {
    /// Floats: the least and the greatest depth of a square of the map's texels, stored as the map's are.
    Extremes,
    /// Words of 32 bits with channels of a filtered map; the first channel has all of the word.
    Float32,
    /// The same: a float in the word's lower half.
    Float16,
    /// The same: a fraction of 1 in the word's lower half.
    Unorm16,
    /// The same: a fraction of 1 in the word's lowest byte.
    Unorm8,
}
