//! What receives shadows: the host's depth buffer and the camera that it was rendered with.

use antumbra_light::Aabb;
use glam::{Mat4, UVec2};

/// Which way a depth buffer runs, and so what its background is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DepthConvention {
    /// 0 near, 1 far; cleared to 1.
    Standard,
    /// 1 near, 0 far or at infinity; cleared to 0.
    #[default]
    Reversed,
}

impl DepthConvention {
    /// The value a depth buffer is cleared to; pixels that hold it have no geometry.
    pub fn background(self) -> f32 {
        match self {
            Self::Standard => 1.0,
            Self::Reversed => 0.0,
        }
    }
}

/// The receivers of one frame. Positions are reconstructed from depth.
#[derive(Clone, Copy, Debug)]
pub struct Receivers<'a> {
    /// Size of the depth buffer, of the normals and of the mask.
    pub size_px: UVec2,
    /// `Depth32Float` (depth aspect) or `R32Float`, single-sampled, usage `TEXTURE_BINDING`.
    pub depth: &'a wgpu::TextureView,
    /// Which way the depth runs.
    pub depth_convention: DepthConvention,
    /// The camera's pose: rigid.
    pub view_from_world: Mat4,
    /// The camera's projection, jitter included. Finite or infinite far plane: the matrix says.
    pub clip_from_view: Mat4,
    /// World-space *geometric* normals in xyz of any float format with `TEXTURE_BINDING`, either side; 32-bit floats
    /// or 16-bit octahedral decode keep grazing light clean. `None` derives them from depth, which is less exact at
    /// silhouettes.
    pub normals: Option<&'a wgpu::TextureView>,
    /// World-space box that holds every receiver; light maps are fitted to it. `None` uses the casters' box.
    pub bounds: Option<Aabb>,
}
