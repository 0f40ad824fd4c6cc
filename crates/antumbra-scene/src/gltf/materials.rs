//! Surfaces: the metallic-roughness material, reduced to what shadows and their shading need.
//!
//! Source: glTF 2.0, section 3.9; KHR_materials_transmission, KHR_materials_emissive_strength,
//! KHR_materials_pbrSpecularGlossiness, KHR_texture_transform. Pictures other than the base colour are replaced by
//! their mean; normal and occlusion pictures are not read.

use glam::{Affine2, Vec2, Vec3, Vec4, Vec4Swizzles};
use gltf::json::material::{AlphaMode as JsonAlphaMode, Material as JsonMaterial};
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use serde_json::Value;

use super::fault::{Fault, Result};
use super::images::Images;
use super::source::Source;
use crate::{AlphaMode, Material};

/// A material, and how its primitives' texture coordinates are to be made.
pub(super) struct Surface {
    pub material: Material,
    /// The base colour picture's coordinates; `None` without a picture.
    pub uv: Option<UvSource>,
}

/// Which texture coordinates a picture uses and how they are transformed.
#[derive(Clone, Copy)]
pub(super) struct UvSource {
    /// `TEXCOORD_n`.
    pub set: u32,
    /// KHR_texture_transform.
    pub image_from_mesh: Affine2,
}

/// Reads one material of the document.
pub(super) fn read(source: &Source, index: usize, images: &mut Images) -> Result<Surface> {
    let Some(json) = source.root.materials.get(index) else {
        return Err(Fault::unresolved("material", "materials", index, source.root.materials.len()));
    };
    let place = format!("materials[{index}]");
    let pbr = &json.pbr_metallic_roughness;
    let extensions = json.extensions.as_ref();
    let other = |name: &str| extensions.and_then(|e| e.others.get(name));

    let mut base_color = Vec4::from_array(pbr.base_color_factor.0);
    let mut base_texture = pbr.base_color_texture.clone();
    let mut metallic = pbr.metallic_factor.0;
    let mut roughness = pbr.roughness_factor.0;
    if let Some(old) = other("KHR_materials_pbrSpecularGlossiness") {
        base_color = floats(old.get("diffuseFactor")).map_or(Vec4::ONE, Vec4::from_array);
        base_texture = old.get("diffuseTexture").and_then(|t| serde_json::from_value(t.clone()).ok());
        metallic = 0.0;
        roughness = 1.0 - floats(old.get("glossinessFactor")).map_or(1.0, |[g]| g);
    } else if let Some(texture) = &pbr.metallic_roughness_texture
        && let Some(mean) = images.mean_of_texture(source, texture.index.value(), &place)?
    {
        roughness *= mean.stored.y;
        metallic *= mean.stored.z;
    }

    let emissive = emissive(source, json, images, &place)?;
    let transmission = transmission(source, json, images, &place)?;

    // Unread pictures must still exist: a reference past the end is a broken file, not a matter of taste.
    let unread = [json.normal_texture.as_ref().map(|t| t.index), json.occlusion_texture.as_ref().map(|t| t.index)];
    for texture in unread.into_iter().flatten() {
        if texture.value() >= source.root.textures.len() {
            return Err(Fault::unresolved(place, "textures", texture.value(), source.root.textures.len()));
        }
    }

    let base_color_image = match &base_texture {
        Some(texture) => images.of_texture(source, texture.index.value(), &place)?,
        None => None,
    };
    let alpha = match json.alpha_mode {
        Checked::Valid(JsonAlphaMode::Opaque) => AlphaMode::Opaque,
        Checked::Valid(JsonAlphaMode::Mask) => AlphaMode::Mask {
            // A cutoff above 1 is allowed and hides everything.
            cutoff: finite_or(json.alpha_cutoff.unwrap_or_default().0, f32::MAX).max(0.0),
        },
        Checked::Valid(JsonAlphaMode::Blend) => AlphaMode::Blend,
        Checked::Invalid => {
            source.warn(format!("{place}.alphaMode: is unknown; it is taken as OPAQUE"));
            AlphaMode::Opaque
        }
    };
    let fraction = |v: f32, otherwise: f32| finite_or(v, otherwise).clamp(0.0, 1.0);
    let material = Material {
        name: json.name.clone().unwrap_or_else(|| format!("material {index}")),
        base_color: Vec4::from_array(base_color.to_array().map(|v| fraction(v, 1.0))),
        base_color_image,
        alpha,
        transmission: fraction(transmission, 0.0),
        metallic: fraction(metallic, 0.0),
        roughness: fraction(roughness, 1.0),
        emissive: Vec3::from_array(emissive.to_array().map(|v| finite_or(v, 0.0).max(0.0))),
        double_sided: json.double_sided,
    };
    let uv = base_texture.filter(|_| base_color_image.is_some()).map(|info| uv_source(&info));
    Ok(Surface { material, uv })
}

/// What a material emits: its factor, its picture's mean, and KHR_materials_emissive_strength.
fn emissive(source: &Source, json: &JsonMaterial, images: &mut Images, place: &str) -> Result<Vec3> {
    let mut emissive = Vec3::from_array(json.emissive_factor.0);
    if let Some(texture) = &json.emissive_texture {
        let mean = images.mean_of_texture(source, texture.index.value(), place)?;
        emissive *= mean.map_or(Vec3::ONE, |mean| mean.linear.xyz());
    }
    let extensions = json.extensions.as_ref();
    let strength = extensions.and_then(|e| e.others.get("KHR_materials_emissive_strength")?.get("emissiveStrength"));
    if let Some([strength]) = floats(strength) {
        emissive *= strength;
    }
    Ok(emissive)
}

/// The share of light that a material lets through: KHR_materials_transmission, its picture by its mean.
fn transmission(source: &Source, json: &JsonMaterial, images: &mut Images, place: &str) -> Result<f32> {
    let mut transmission = 0.0;
    if let Some(extension) = json.extensions.as_ref().and_then(|e| e.transmission.as_ref()) {
        transmission = extension.transmission_factor.0;
        if let Some(texture) = &extension.transmission_texture
            && let Some(mean) = images.mean_of_texture(source, texture.index.value(), place)?
        {
            transmission *= mean.stored.x;
        }
    }
    Ok(transmission)
}

/// KHR_texture_transform: translation · rotation · scale, counter-clockwise for coordinates whose v runs down.
fn uv_source(info: &Info) -> UvSource {
    let Some(transform) = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref()) else {
        return UvSource { set: info.tex_coord, image_from_mesh: Affine2::IDENTITY };
    };
    UvSource {
        set: transform.tex_coord.unwrap_or(info.tex_coord),
        image_from_mesh: Affine2::from_scale_angle_translation(
            Vec2::from_array(transform.scale.0),
            -transform.rotation.0,
            Vec2::from_array(transform.offset.0),
        ),
    }
}

fn finite_or(v: f32, otherwise: f32) -> f32 {
    if v.is_finite() { v } else { otherwise }
}

/// `N` numbers out of untyped JSON: an array, or a bare number where `N` is 1.
pub(super) fn floats<const N: usize>(value: Option<&Value>) -> Option<[f32; N]> {
    let value = value?;
    let number = |v: &Value| v.as_f64().map(|v| v as f32).filter(|v| v.is_finite());
    if N == 1
        && let Some(v) = number(value)
    {
        return Some([v; N]);
    }
    let list = value.as_array().filter(|list| list.len() == N)?;
    let mut out = [0.0; N];
    for (slot, item) in out.iter_mut().zip(list) {
        *slot = number(item)?;
    }
    Some(out)
}
