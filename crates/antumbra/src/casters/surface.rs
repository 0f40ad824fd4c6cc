//! Surfaces of casters: how much light they block.

use glam::Vec3;

use super::{MeshEntry, bad};
use crate::contract::{Error, Opacity, SurfaceCoverage, SurfaceTexture, tints};
use crate::gpu::{Gpu, ViewKind};

/// Effect of a caster's surface on light. Textures belong to the host; the set keeps handles.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// Blocks all light.
    Opaque,
    /// Blocks all light where `alpha_factor` × the texture's filtered alpha ≥ `cutoff`, and none elsewhere.
    Masked {
        /// Texture with alpha.
        texture: Texture,
        /// Multiplies the texture's alpha.
        alpha_factor: f32,
        /// Coverage threshold, 0 to 1.
        cutoff: f32,
    },
    /// Transmits `(1 − coverage) + coverage · transmitted` of each colour.
    Translucent {
        /// Coverage of the surface.
        coverage: SurfaceCoverage,
        /// Transmittance of the covered part, linear RGB, 0 to 1: transmission × tint. [`Vec3::ZERO`] for alpha-blended
        /// surfaces that transmit nothing: they cover, and never tint.
        transmitted: Vec3,
        /// Texture whose RGB multiplies `transmitted` and whose alpha multiplies the coverage's.
        texture: Option<Texture>,
    },
}

impl Surface {
    fn texture(&self) -> Option<&Texture> {
        match self {
            Self::Opaque => None,
            Self::Masked { texture, .. } => Some(texture),
            Self::Translucent { texture, .. } => texture.as_ref(),
        }
    }

    pub(super) fn tints(&self) -> bool {
        matches!(self, Self::Translucent { transmitted, texture, .. } if tints(*transmitted, texture.is_some()))
    }
}

/// Texture of a caster.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// 2D view of a filterable colour format.
    pub view: wgpu::TextureView,
    /// Filtering sampler, with the address modes.
    pub sampler: wgpu::Sampler,
}

/// Refuses a surface that is not finite or does not suit the mesh.
pub(super) fn check_surface(gpu: &Gpu, surface: &Surface, mesh: &MeshEntry) -> Result<(), Error> {
    let is_finite = match surface {
        Surface::Opaque => true,
        Surface::Masked { alpha_factor, cutoff, .. } => alpha_factor.is_finite() && cutoff.is_finite(),
        Surface::Translucent { coverage, transmitted, .. } => coverage.is_finite() && transmitted.is_finite(),
    };
    if !is_finite {
        return Err(bad("the caster's surface", "not finite".into(), "finite".into()));
    }
    let Some(texture) = surface.texture() else { return Ok(()) };
    if !mesh.source.has_uvs() {
        return Err(bad(
            "the caster's surface",
            "textured on a mesh without texture coordinates".into(),
            "on a mesh that has them".into(),
        ));
    }
    let validation_error = ViewKind::Filtered.validation_error(gpu, &texture.view);
    validation_error.map_or(Ok(()), |validation_error| {
        Err(bad(
            "the surface's texture",
            format!("a view that cannot be bound ({validation_error})"),
            "a 2D view of one layer with a filterable colour format".into(),
        ))
    })
}

/// Returns the surface as techniques receive it, with the mesh's texture coordinates.
pub(super) fn opacity_of<'a>(surface: &'a Surface, uvs: Option<&'a wgpu::Buffer>) -> Opacity<'a> {
    let textured =
        |texture: &'a Texture| uvs.map(|uvs| SurfaceTexture { uvs, view: &texture.view, sampler: &texture.sampler });
    match surface {
        Surface::Opaque => Opacity::Opaque,
        Surface::Masked { texture, alpha_factor, cutoff } => match textured(texture) {
            Some(texture) => Opacity::Masked { texture, alpha_factor: *alpha_factor, cutoff: *cutoff },
            None => Opacity::Opaque,
        },
        // Hosts mark some opaque materials as blended. A surface that blocks everything is opaque.
        Surface::Translucent { coverage, transmitted, texture: None }
            if *transmitted == Vec3::ZERO && is_whole_without_texture(*coverage) =>
        {
            Opacity::Opaque
        }
        Surface::Translucent { coverage, transmitted, texture } => Opacity::Translucent {
            coverage: *coverage,
            transmitted: *transmitted,
            texture: texture.as_ref().and_then(textured),
        },
    }
}

fn is_whole_without_texture(coverage: SurfaceCoverage) -> bool {
    match coverage {
        SurfaceCoverage::Whole => true,
        SurfaceCoverage::Alpha(alpha) => alpha >= 1.0,
        SurfaceCoverage::Cutoff { alpha_factor, cutoff } => alpha_factor >= cutoff,
    }
}
