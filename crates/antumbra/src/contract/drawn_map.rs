//! Light map of a technique, for inspection.

use glam::UVec2;

/// Depth map drawn from a light by the frame prepared last. The light's next frame overwrites it.
///
/// It is for tools that show what a technique sees; rendering does not need it.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnMap {
    /// Depth of `size_px` texels and `sample_count` samples. Bind it as a depth texture, multisampled if there are several samples.
    /// Rows run against the light's up.
    pub depth: wgpu::TextureView,
    /// Width and height, texels.
    pub size_px: UVec2,
    /// Samples per texel.
    pub sample_count: u32,
    /// Clear value: the depth of texels without a caster.
    pub empty_depth: f32,
    /// Nearest and farthest depth that the map can hold, metres along the light's axis from the view's origin.
    pub range_m: [f32; 2],
    /// Whether the map is perspective (a lamp's). Metres along the axis are `(depth − depth_offset) / depth_scale`, or the
    /// reciprocal of that if it is.
    pub is_perspective: bool,
    /// See [`is_perspective`](Self::is_perspective).
    pub depth_scale: f32,
    /// See [`is_perspective`](Self::is_perspective).
    pub depth_offset: f32,
    /// Factor of the stored depths of a window that is warped towards what the camera sees: at (u, v), rows downwards, depth was
    /// multiplied by `warp[0] + warp[1] u + warp[2] v`. (1, 0, 0) without a warp. Layers behind have the factor, levels do not.
    pub depth_warp: [f32; 3],
    /// Index of the light sample from which the map is seen, if each sample has a map of its own. Textures are reused, so only the
    /// maps of the last samples remain.
    pub light_point: Option<u32>,
    /// Peeled layers behind the map, the nearest first. Bind them as `depth`, with one sample.
    pub layers_behind: Vec<wgpu::TextureView>,
    /// Levels derived from the map that are read in addition to it or in its place, the finest first.
    pub levels: Vec<MapLevel>,
}

/// One level of textures derived from a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapLevel {
    /// 2D texture view.
    pub view: wgpu::TextureView,
    /// Corner of the level in the texture, texels.
    pub origin_px: UVec2,
    /// Width and height of the level: the texels that represent the map.
    pub size_px: UVec2,
    /// Content of the texels.
    pub texels: LevelTexels,
}

/// Content of the texels of a [`MapLevel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelTexels {
    /// Floats: minimum and maximum depth of a square of the map's texels, encoded as the map's depths.
    Extremes,
    /// 32-bit words of a filtered map's channels; the first channel is a 32-bit float.
    Float32,
    /// 32-bit words of a filtered map's channels; the first channel is a 16-bit float in the lower half.
    Float16,
    /// 32-bit words of a filtered map's channels; the first channel is a 16-bit fraction of 1 in the lower half.
    Unorm16,
    /// 32-bit words of a filtered map's channels; the first channel is an 8-bit fraction of 1 in the lowest byte.
    Unorm8,
}
