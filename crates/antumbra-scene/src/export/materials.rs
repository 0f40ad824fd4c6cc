//! Materials, with their images and samplers.

use std::collections::HashMap;
use std::io::Cursor;

use glam::Vec4;
use serde_json::{Map, Value, json};

use super::{gl, object};
use crate::{AlphaMode, Image, Material, Scene, Volume, Wrap};

/// Materials to write, and for each mesh its material index and the divisor of its vertex colours.
///
/// glTF requires colours and factors in [0, 1]. If vertex colours exceed 1, the mesh gets a material of its own whose
/// factor is multiplied by their maximum. glTF measures the thickness of a volume in mesh space, so a material with a
/// volume is copied for each scale; a mesh's first instance determines its scale.
pub(super) fn surfaces(scene: &Scene) -> (Vec<Material>, Vec<(usize, f32)>) {
    let mut surfaces = scene.materials.clone();
    let mut scaled: HashMap<(usize, u32, u32), usize> = HashMap::new();
    let mut sizes = vec![None; scene.meshes.len()];
    for instance in &scene.instances {
        sizes[instance.mesh].get_or_insert_with(|| instance.world_from_object.determinant().abs().cbrt());
    }
    let of_mesh = scene
        .meshes
        .iter()
        .zip(sizes)
        .map(|(mesh, size)| {
            let original = &scene.materials[mesh.material];
            let scale = mesh.colors.iter().map(|c| c.truncate().max_element()).fold(1.0, f32::max);
            let size = size.filter(|size| original.volume.is_some() && size.is_normal()).unwrap_or(1.0);
            if scale == 1.0 && size == 1.0 {
                return (mesh.material, 1.0);
            }
            let index = *scaled.entry((mesh.material, scale.to_bits(), size.to_bits())).or_insert_with(|| {
                let base_color = (original.base_color.truncate() * scale).extend(original.base_color.w);
                let volume = original.volume.as_ref();
                let volume = volume.map(|volume| Volume { thickness_m: volume.thickness_m / size, ..volume.clone() });
                surfaces.push(Material { base_color, volume, ..original.clone() });
                surfaces.len() - 1
            });
            (index, scale)
        })
        .collect();
    (surfaces, of_mesh)
}

pub(super) fn png(image: &Image) -> Result<Vec<u8>, String> {
    let texels: Vec<u8> = image.rgba8.iter().flatten().copied().collect();
    let mut out = Cursor::new(Vec::new());
    image::write_buffer_with_format(
        &mut out,
        &texels,
        image.width,
        image.height,
        image::ExtendedColorType::Rgba8,
        image::ImageFormat::Png,
    )
    .map_err(|e| format!("an image of {} x {} texels: {e}", image.width, image.height))?;
    Ok(out.into_inner())
}

pub(super) fn sampler(wrap: &[Wrap; 2]) -> Value {
    let [s, t] = wrap.map(|wrap| match wrap {
        Wrap::Repeat => gl::REPEAT,
        Wrap::Mirror => gl::MIRRORED_REPEAT,
        Wrap::Clamp => gl::CLAMP_TO_EDGE,
    });
    json!({ "magFilter": gl::LINEAR, "minFilter": gl::LINEAR_MIPMAP_LINEAR, "wrapS": s, "wrapT": t })
}

pub(super) fn material(material: &Material) -> Value {
    let mut pbr = json!({
        "baseColorFactor": material.base_color.clamp(Vec4::ZERO, Vec4::ONE).to_array(),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    // One texture was written for each image, in the same order.
    let texture = |image: Option<usize>| image.map_or(Value::Null, |image| json!({ "index": image }));
    pbr["baseColorTexture"] = texture(material.base_color_image);
    pbr["metallicRoughnessTexture"] = texture(material.metallic_roughness_image);
    let mut extensions = Map::new();
    if material.transmission > 0.0 {
        let transmission = json!({
            "transmissionFactor": material.transmission,
            "transmissionTexture": texture(material.transmission_image),
        });
        extensions.insert("KHR_materials_transmission".into(), object(transmission));
    }
    if let Some(volume) = &material.volume {
        let volume = json!({
            "thicknessFactor": volume.thickness_m,
            "thicknessTexture": texture(volume.thickness_image),
            "attenuationColor": volume.attenuation_color.to_array(),
            "attenuationDistance": volume.attenuation_distance_m,
        });
        extensions.insert("KHR_materials_volume".into(), object(volume));
    }
    // The factor may not exceed 1; the strength takes the excess.
    let strength = material.emissive.max_element().max(1.0);
    if strength > 1.0 {
        extensions.insert("KHR_materials_emissive_strength".into(), json!({ "emissiveStrength": strength }));
    }
    let (mode, cutoff) = match material.alpha {
        AlphaMode::Opaque => (Value::Null, Value::Null),
        AlphaMode::Mask { cutoff } => ("MASK".into(), cutoff.into()),
        AlphaMode::Blend => ("BLEND".into(), Value::Null),
    };
    object(json!({
        "name": material.name,
        "pbrMetallicRoughness": object(pbr),
        "emissiveFactor": (material.emissive / strength).to_array(),
        "alphaMode": mode,
        "alphaCutoff": cutoff,
        "doubleSided": material.double_sided,
        "extensions": extensions,
    }))
}
