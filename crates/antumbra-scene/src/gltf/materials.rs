//! Metallic-roughness materials, reduced to what shadows and their shading need.
//!
//! Source: glTF 2.0, section 3.9; KHR_materials_transmission, KHR_materials_volume, KHR_materials_emissive_strength,
//! KHR_materials_pbrSpecularGlossiness, KHR_texture_transform. Images of the base colour and of transmission are kept;
//! others are replaced by their means. Normal and occlusion maps are not read.
//!
//! A mesh has one set of texture coordinates, the base colour's. An image with other coordinates or another sampler is
//! replaced by its mean too, with a warning.

use glam::{Affine2, Vec2, Vec3, Vec4, Vec4Swizzles};
use gltf::json::material::{AlphaMode as JsonAlphaMode, Material as JsonMaterial};
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use serde_json::Value;

use super::fault::{Fault, Result};
use super::images::{Images, Means, wrap_of_texture};
use super::source::Source;
use crate::{AlphaMode, Material, Volume, Wrap};

/// Material, and the source of its primitives' texture coordinates.
pub(super) struct Surface {
    pub material: Material,
    /// Texture coordinates of the images; `None` without an image.
    pub uv: Option<UvSource>,
}

/// Texture coordinates of an image and their transform.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct UvSource {
    /// `TEXCOORD_n`.
    pub set: u32,
    /// KHR_texture_transform.
    pub image_from_mesh: Affine2,
}

/// Images of a material. The first one kept determines texture coordinates and address modes of all.
struct Pictures<'r, 's, 'a> {
    source: &'s Source<'a>,
    images: &'r mut Images,
    place: &'r str,
    kept: Option<(UvSource, [Wrap; 2])>,
}

/// Image of a texture, or its replacement.
enum Picture {
    /// No readable image: white.
    White,
    /// Index of the scene's image.
    Kept(usize),
    Mean(Means),
}

impl Pictures<'_, '_, '_> {
    /// Reads a texture's image, or its mean if its coordinates or address modes differ from those of the images kept before.
    fn read(&mut self, info: &Info, what: &str) -> Result<Picture> {
        let texture = info.index.value();
        let lies = (uv_source(info), wrap_of_texture(self.source, texture, self.place)?);
        if self.kept.is_some_and(|kept| kept != lies) {
            let mean = self.images.mean_of_texture(self.source, texture, self.place)?;
            self.source.warn(format!(
                "{}: its {what} has different texture coordinates or a different sampler than its base colour; the mean is used",
                self.place
            ));
            return Ok(mean.map_or(Picture::White, Picture::Mean));
        }
        let image = self.images.of_texture(self.source, texture, self.place)?;
        self.kept = self.kept.or(image.map(|_| lies));
        Ok(image.map_or(Picture::White, Picture::Kept))
    }

    /// Reads a factor and the image that multiplies it. `channel` selects the channel of a mean.
    fn factor(
        &mut self,
        factor: f32,
        info: Option<&Info>,
        what: &str,
        channel: fn(Vec4) -> f32,
    ) -> Result<(f32, Option<usize>)> {
        Ok(match info.map(|info| self.read(info, what)).transpose()? {
            None | Some(Picture::White) => (factor, None),
            Some(Picture::Kept(image)) => (factor, Some(image)),
            Some(Picture::Mean(mean)) => (factor * channel(mean.stored), None),
        })
    }

    fn mean_stored(&mut self, info: &Info) -> Result<Vec4> {
        let mean = self.images.mean_of_texture(self.source, info.index.value(), self.place)?;
        Ok(mean.map_or(Vec4::ONE, |mean| mean.stored))
    }
}

/// Metalness and roughness.
struct Microsurface {
    metallic: f32,
    roughness: f32,
    image: Option<usize>,
}

/// Transmission of a surface.
#[derive(Default)]
struct Transmitted {
    factor: f32,
    image: Option<usize>,
    volume: Option<Volume>,
}

/// Reads one material of the document.
pub(super) fn read(source: &Source, index: usize, images: &mut Images) -> Result<Surface> {
    let Some(json) = source.root.materials.get(index) else {
        return Err(Fault::unresolved("material", "materials", index, source.root.materials.len()));
    };
    let place = format!("materials[{index}]");
    check_unread(source, json, &place)?;
    let emissive = emissive(source, json, images, &place)?;
    let mut pictures = Pictures { source, images, place: &place, kept: None };
    let (base_color, base_color_image) = base_color(json, &mut pictures)?;
    let transmitted = transmitted(json, &mut pictures)?;
    let microsurface = microsurface(json, &mut pictures, transmitted.factor > 0.0)?;
    let uv = pictures.kept.map(|(uv, _)| uv);
    let material = Material {
        name: json.name.clone().unwrap_or_else(|| format!("material {index}")),
        base_color: Vec4::from_array(base_color.to_array().map(|v| fraction(v, 1.0))),
        base_color_image,
        alpha: alpha_mode(source, json, &place),
        transmission: transmitted.factor,
        transmission_image: transmitted.image,
        metallic: fraction(microsurface.metallic, 0.0),
        roughness: fraction(microsurface.roughness, 1.0),
        metallic_roughness_image: microsurface.image,
        volume: transmitted.volume,
        emissive: Vec3::from_array(emissive.to_array().map(|v| finite_or(v, 0.0).max(0.0))),
        double_sided: json.double_sided,
    };
    Ok(Surface { material, uv })
}

/// Checks references to unread images: one past the end makes the file invalid.
fn check_unread(source: &Source, json: &JsonMaterial, place: &str) -> Result<()> {
    let unread = [json.normal_texture.as_ref().map(|t| t.index), json.occlusion_texture.as_ref().map(|t| t.index)];
    match unread.into_iter().flatten().find(|texture| texture.value() >= source.root.textures.len()) {
        Some(texture) => Err(Fault::unresolved(place, "textures", texture.value(), source.root.textures.len())),
        None => Ok(()),
    }
}

fn alpha_mode(source: &Source, json: &JsonMaterial, place: &str) -> AlphaMode {
    match json.alpha_mode {
        Checked::Valid(JsonAlphaMode::Opaque) => AlphaMode::Opaque,
        Checked::Valid(JsonAlphaMode::Mask) => AlphaMode::Mask {
            // A cutoff above 1 is allowed and hides everything.
            cutoff: finite_or(json.alpha_cutoff.unwrap_or_default().0, f32::MAX).max(0.0),
        },
        Checked::Valid(JsonAlphaMode::Blend) => AlphaMode::Blend,
        Checked::Invalid => {
            source.warn(format!("{place}.alphaMode: is unknown; OPAQUE is used"));
            AlphaMode::Opaque
        }
    }
}

/// KHR_materials_pbrSpecularGlossiness, which takes precedence over the metallic-roughness values.
fn specular_glossiness(json: &JsonMaterial) -> Option<&Value> {
    json.extensions.as_ref()?.others.get("KHR_materials_pbrSpecularGlossiness")
}

/// Factor and image of the base colour.
fn base_color(json: &JsonMaterial, pictures: &mut Pictures<'_, '_, '_>) -> Result<(Vec4, Option<usize>)> {
    let pbr = &json.pbr_metallic_roughness;
    let (factor, texture) = match specular_glossiness(json) {
        Some(old) => (
            floats(old.get("diffuseFactor")).map_or(Vec4::ONE, Vec4::from_array),
            old.get("diffuseTexture").and_then(|t| serde_json::from_value(t.clone()).ok()),
        ),
        None => (Vec4::from_array(pbr.base_color_factor.0), pbr.base_color_texture.clone()),
    };
    let image = match texture.map(|texture| pictures.read(&texture, "base colour")).transpose()? {
        Some(Picture::Kept(image)) => Some(image),
        _ => None,
    };
    Ok((factor, image))
}

/// Reads metalness and roughness, with their image if `is_kept`, else with its means.
fn microsurface(json: &JsonMaterial, pictures: &mut Pictures<'_, '_, '_>, is_kept: bool) -> Result<Microsurface> {
    if let Some(old) = specular_glossiness(json) {
        let glossiness = floats(old.get("glossinessFactor")).map_or(1.0, |[g]| g);
        return Ok(Microsurface { metallic: 0.0, roughness: 1.0 - glossiness, image: None });
    }
    let pbr = &json.pbr_metallic_roughness;
    let plain = Microsurface { metallic: pbr.metallic_factor.0, roughness: pbr.roughness_factor.0, image: None };
    let Some(texture) = &pbr.metallic_roughness_texture else { return Ok(plain) };
    let mean = if is_kept {
        match pictures.read(texture, "metalness")? {
            Picture::White => return Ok(plain),
            Picture::Kept(image) => return Ok(Microsurface { image: Some(image), ..plain }),
            Picture::Mean(mean) => mean.stored,
        }
    } else {
        pictures.mean_stored(texture)?
    };
    Ok(Microsurface { metallic: plain.metallic * mean.z, roughness: plain.roughness * mean.y, image: None })
}

/// Reads KHR_materials_transmission, and KHR_materials_volume beneath it.
fn transmitted(json: &JsonMaterial, pictures: &mut Pictures<'_, '_, '_>) -> Result<Transmitted> {
    let Some(extension) = json.extensions.as_ref().and_then(|e| e.transmission.as_ref()) else {
        return Ok(Transmitted::default());
    };
    let factor = fraction(extension.transmission_factor.0, 0.0);
    if factor == 0.0 {
        return Ok(Transmitted::default());
    }
    let texture = extension.transmission_texture.as_ref();
    let (factor, image) = pictures.factor(factor, texture, "transmission", |mean| mean.x)?;
    Ok(Transmitted { factor, image, volume: volume(json, pictures)? })
}

/// Reads KHR_materials_volume; `None` if the volume absorbs nothing.
fn volume(json: &JsonMaterial, pictures: &mut Pictures<'_, '_, '_>) -> Result<Option<Volume>> {
    let Some(extension) = json.extensions.as_ref().and_then(|e| e.others.get("KHR_materials_volume")) else {
        return Ok(None);
    };
    let number = |key: &str, otherwise: f32| floats(extension.get(key)).map_or(otherwise, |[v]| v);
    let thickness_m = number("thicknessFactor", 0.0);
    let attenuation_distance_m = number("attenuationDistance", f32::INFINITY);
    let color = floats(extension.get("attenuationColor")).map_or(Vec3::ONE, Vec3::from_array);
    let attenuation_color = color.clamp(Vec3::ZERO, Vec3::ONE);
    if attenuation_distance_m <= 0.0 {
        pictures.source.warn(format!(
            "{}: its attenuationDistance is {attenuation_distance_m}, but must be greater than 0; its volume absorbs nothing",
            pictures.place
        ));
        return Ok(None);
    }
    if thickness_m <= 0.0 || attenuation_color == Vec3::ONE || attenuation_distance_m == f32::INFINITY {
        return Ok(None);
    }
    let texture: Option<Info> =
        extension.get("thicknessTexture").and_then(|texture| serde_json::from_value(texture.clone()).ok());
    let (thickness_m, thickness_image) = pictures.factor(thickness_m, texture.as_ref(), "thickness", |mean| mean.y)?;
    Ok(Some(Volume { thickness_m, thickness_image, attenuation_color, attenuation_distance_m }))
}

/// Emission of a material: its factor, its image's mean, and KHR_materials_emissive_strength.
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

fn fraction(v: f32, otherwise: f32) -> f32 {
    finite_or(v, otherwise).clamp(0.0, 1.0)
}

fn finite_or(v: f32, otherwise: f32) -> f32 {
    if v.is_finite() { v } else { otherwise }
}

/// Reads `N` numbers from untyped JSON: an array, or a bare number if `N` is 1.
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
