//! What a material does to light that meets it.

use antumbra::casters::{Surface, Texture};
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::mesh::UvChannel;
use bevy::prelude::*;
use bevy::render::render_asset::RenderAssets;
use bevy::render::texture::GpuImage;

/// A surface as a material describes it; its texture by name.
#[derive(Clone, Debug, PartialEq)]
pub enum CasterSurface {
    /// Blocks all.
    Opaque,
    /// Blocks all where the texture's alpha × `alpha_factor` is `cutoff` or more.
    Masked {
        /// The texture.
        texture: SurfaceTexture,
        /// Multiplies its alpha.
        alpha_factor: f32,
        /// 0 to 1.
        cutoff: f32,
    },
    /// Lets pass `1 − opacity · (1 − tint)` of each colour.
    Tinted {
        /// Linear tint, and opacity as alpha.
        tint: [f32; 4],
        /// Multiplies it.
        texture: Option<SurfaceTexture>,
        /// The texture's alpha is not opacity.
        texture_tints_only: bool,
    },
}

/// A texture of a surface, and where on the mesh it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceTexture {
    /// The image.
    pub image: AssetId<Image>,
    /// The mesh's second texture coordinates instead of its first.
    pub second_uvs: bool,
    /// What is done to coordinates before they are used: the columns of a 2 × 3 matrix.
    pub uv_transform: [f32; 6],
}

impl SurfaceTexture {
    /// A texture on a mesh's first coordinates as they are.
    pub fn of(image: &Handle<Image>) -> Self {
        let uv_transform = bevy::math::Affine2::IDENTITY.to_cols_array();
        Self { image: image.id(), second_uvs: false, uv_transform }
    }
}

impl CasterSurface {
    /// What a material does to light; `None` where it casts nothing at all.
    pub fn of_standard(material: &StandardMaterial) -> Option<Self> {
        let texture = material.base_color_texture.as_ref().map(|image| SurfaceTexture {
            image: image.id(),
            second_uvs: material.base_color_channel == UvChannel::Uv1,
            uv_transform: material.uv_transform.to_cols_array(),
        });
        let color = material.base_color.to_linear();
        let tint = [color.red, color.green, color.blue, color.alpha];
        let masked = |cutoff: f32| match texture {
            Some(texture) => Some(Self::Masked { texture, alpha_factor: color.alpha, cutoff }),
            None => (color.alpha >= cutoff).then_some(Self::Opaque),
        };
        if material.specular_transmission > 0.0 {
            let t = material.specular_transmission;
            let tint = [t * color.red, t * color.green, t * color.blue, 1.0];
            return Some(Self::Tinted { tint, texture, texture_tints_only: true });
        }
        match material.alpha_mode {
            AlphaMode::Opaque => Some(Self::Opaque),
            AlphaMode::Mask(cutoff) => masked(cutoff),
            AlphaMode::AlphaToCoverage => masked(0.5),
            AlphaMode::Blend | AlphaMode::Premultiplied => {
                Some(Self::Tinted { tint, texture, texture_tints_only: false })
            }
            AlphaMode::Multiply => {
                let tint = [color.red, color.green, color.blue, 1.0];
                Some(Self::Tinted { tint, texture, texture_tints_only: true })
            }
            // What only adds light takes none away.
            AlphaMode::Add => None,
        }
    }

    /// Its texture.
    pub(crate) fn texture(&self) -> Option<&SurfaceTexture> {
        match self {
            Self::Opaque => None,
            Self::Masked { texture, .. } => Some(texture),
            Self::Tinted { texture, .. } => texture.as_ref(),
        }
    }

    /// The same for the library; `None` while the texture is not on the GPU.
    pub(crate) fn of_library(&self, images: &RenderAssets<GpuImage>) -> Option<Surface> {
        let texture = |texture: &SurfaceTexture| {
            let image = images.get(texture.image)?;
            Some(Texture { view: (*image.texture_view).clone(), sampler: (*image.sampler).clone() })
        };
        Some(match self {
            Self::Opaque => Surface::Opaque,
            Self::Masked { texture: of, alpha_factor, cutoff } => {
                Surface::Masked { texture: texture(of)?, alpha_factor: *alpha_factor, cutoff: *cutoff }
            }
            Self::Tinted { tint, texture: of, texture_tints_only } => Surface::Tinted {
                tint: glam::Vec4::from_array(*tint),
                texture: match of {
                    Some(of) => Some(texture(of)?),
                    None => None,
                },
                texture_tints_only: *texture_tints_only,
            },
        })
    }

    /// The same on a mesh without the coordinates that its texture needs.
    pub(crate) fn without_texture(&self) -> Self {
        match self {
            Self::Opaque | Self::Masked { .. } => Self::Opaque,
            Self::Tinted { tint, texture_tints_only, .. } => {
                Self::Tinted { tint: *tint, texture: None, texture_tints_only: *texture_tints_only }
            }
        }
    }
}

/// Whether a material shades what no mask is of: a surface that is not in the depth prepass, or a far side.
pub(crate) fn is_seen_without_mask(material: &StandardMaterial) -> bool {
    let transmits = material.specular_transmission > 0.0 || material.diffuse_transmission > 0.0;
    !material.unlit && (transmits || is_transparent(material.alpha_mode))
}

/// Whether surfaces of a mode are drawn after all others, and not into the depth prepass.
pub(crate) fn is_transparent(mode: AlphaMode) -> bool {
    matches!(mode, AlphaMode::Blend | AlphaMode::Premultiplied | AlphaMode::Multiply | AlphaMode::Add)
}
