//! Caster surfaces: how a material blocks light.

use antumbra::SurfaceCoverage;
use antumbra::casters::{Surface, Texture};
use bevy::asset::AssetId;
use bevy::ecs::entity::EntityHashMap;
use bevy::image::Image;
use bevy::mesh::UvChannel;
use bevy::prelude::*;
use bevy::render::render_asset::RenderAssets;
use bevy::render::texture::GpuImage;

/// Caster surface as a material describes it; its texture is given by asset id.
#[derive(Clone, Debug, PartialEq)]
pub enum CasterSurface {
    /// Blocks all light.
    Opaque,
    /// Blocks all light where the texture's alpha × `alpha_factor` is `cutoff` or more.
    Masked {
        /// The texture.
        texture: SurfaceTexture,
        /// Multiplies the texture's alpha.
        alpha_factor: f32,
        /// Alpha threshold, 0 to 1.
        cutoff: f32,
    },
    /// Transmits `(1 − coverage) + coverage · transmitted` of each colour.
    Translucent {
        /// Fraction of the surface that is present.
        coverage: SurfaceCoverage,
        /// Transmittance of the covered part, linear: transmission × colour. Zeros for alpha-blended surfaces without
        /// transmission: they cover, and never tint.
        transmitted: [f32; 3],
        /// Texture whose RGB multiplies `transmitted` and whose alpha multiplies the coverage's.
        texture: Option<SurfaceTexture>,
    },
}

/// Texture of a surface and its mapping onto the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceTexture {
    /// The image.
    pub image: AssetId<Image>,
    /// Whether the mesh's second texture coordinates are used instead of its first.
    pub second_uvs: bool,
    /// Transform of the texture coordinates: the columns of a 2 × 3 matrix.
    pub uv_transform: [f32; 6],
}

impl SurfaceTexture {
    /// Returns a texture on the mesh's first texture coordinates, without a transform.
    pub fn of(image: &Handle<Image>) -> Self {
        let uv_transform = bevy::math::Affine2::IDENTITY.to_cols_array();
        Self { image: image.id(), second_uvs: false, uv_transform }
    }
}

impl CasterSurface {
    /// Returns the surface of a standard material; `None` if it casts nothing.
    ///
    /// Alpha is coverage. Specular transmission is tinted by the material's colour and by its volume's absorption over the
    /// thickness, half at either side. Textures of transmission, metalness and thickness are ignored: only their factors count.
    pub fn of_standard(material: &StandardMaterial) -> Option<Self> {
        let texture = material.base_color_texture.as_ref().map(|image| SurfaceTexture {
            image: image.id(),
            second_uvs: material.base_color_channel == UvChannel::Uv1,
            uv_transform: material.uv_transform.to_cols_array(),
        });
        let color = material.base_color.to_linear();
        let transmitted = transmitted_by(material);
        let translucent = |coverage| Some(Self::Translucent { coverage, transmitted, texture });
        let masked = |cutoff: f32| match texture {
            Some(texture) => Some(Self::Masked { texture, alpha_factor: color.alpha, cutoff }),
            None => (color.alpha >= cutoff).then_some(Self::Opaque),
        };
        let cut_off = |cutoff| translucent(SurfaceCoverage::Cutoff { alpha_factor: color.alpha, cutoff });
        let transmits = transmitted != [0.0; 3];
        match material.alpha_mode {
            AlphaMode::Opaque if transmits => translucent(SurfaceCoverage::Whole),
            AlphaMode::Opaque => Some(Self::Opaque),
            AlphaMode::Mask(cutoff) if transmits => cut_off(cutoff),
            AlphaMode::Mask(cutoff) => masked(cutoff),
            AlphaMode::AlphaToCoverage if transmits => cut_off(0.5),
            AlphaMode::AlphaToCoverage => masked(0.5),
            AlphaMode::Blend | AlphaMode::Premultiplied => translucent(SurfaceCoverage::Alpha(color.alpha)),
            AlphaMode::Multiply => {
                let transmitted = [color.red, color.green, color.blue];
                Some(Self::Translucent { coverage: SurfaceCoverage::Whole, transmitted, texture })
            }
            // Additive blending blocks no light.
            AlphaMode::Add => None,
        }
    }

    /// Returns the texture, if there is one.
    pub(crate) fn texture(&self) -> Option<&SurfaceTexture> {
        match self {
            Self::Opaque => None,
            Self::Masked { texture, .. } => Some(texture),
            Self::Translucent { texture, .. } => texture.as_ref(),
        }
    }

    /// Returns the library's surface; `None` while the texture is not on the GPU.
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
            Self::Translucent { coverage, transmitted, texture: of } => Surface::Translucent {
                coverage: *coverage,
                transmitted: glam::Vec3::from_array(*transmitted),
                texture: match of {
                    Some(of) => Some(texture(of)?),
                    None => None,
                },
            },
        })
    }

    /// Returns the surface for a mesh without the texture coordinates that its texture needs.
    pub(crate) fn without_texture(&self) -> Self {
        match self {
            Self::Opaque | Self::Masked { .. } => Self::Opaque,
            Self::Translucent { coverage, transmitted, .. } => {
                Self::Translucent { coverage: *coverage, transmitted: *transmitted, texture: None }
            }
        }
    }
}

/// Returns a material's transmittance, linear RGB.
fn transmitted_by(material: &StandardMaterial) -> [f32; 3] {
    let share = material.specular_transmission * (1.0 - material.metallic);
    if share <= 0.0 {
        return [0.0; 3];
    }
    // A volume has two sides, and each absorbs half. For a thin surface the power is 0.
    let power = 0.5 * material.thickness / material.attenuation_distance;
    let (color, absorbed) = (material.base_color.to_linear(), material.attenuation_color.to_linear());
    [(color.red, absorbed.red), (color.green, absorbed.green), (color.blue, absorbed.blue)]
        .map(|(color, absorbed)| share * color * absorbed.max(0.0).powf(power))
}

/// Whether a material shades surfaces without a mask: one that is not in the depth prepass, or a back side.
pub(crate) fn is_seen_without_mask(material: &StandardMaterial) -> bool {
    let transmits = material.specular_transmission > 0.0 || material.diffuse_transmission > 0.0;
    !material.unlit && (transmits || is_transparent(material.alpha_mode))
}

/// Whether surfaces of an alpha mode are drawn after all others, and not into the depth prepass.
pub(crate) fn is_transparent(mode: AlphaMode) -> bool {
    matches!(mode, AlphaMode::Blend | AlphaMode::Premultiplied | AlphaMode::Multiply | AlphaMode::Add)
}

/// Surfaces of this frame's entities with users' own materials.
#[derive(Resource, Default)]
pub struct OwnSurfaces(pub EntityHashMap<OwnSurface>);

/// Caster surface of a user's own material.
#[derive(Clone, Debug, Default)]
pub struct OwnSurface {
    /// `None` if it casts nothing, or is still loading.
    pub casts: Option<CasterSurface>,
    /// Whether the surface is not in the depth prepass.
    pub is_transparent: bool,
}
