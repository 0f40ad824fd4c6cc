//! Any scene as one binary glTF 2.0 file.
//!
//! What glTF's extensions cannot say of a light (its shape and size, its exposure) goes into `extras`, which
//! the loader of this crate reads back and other programs ignore.

use std::collections::HashMap;
use std::f32::consts::FRAC_PI_2;
use std::io::{Cursor, Write};

use antumbra_light::{EmissionTexture, Light, LightShape};
use glam::{Mat3, Mat4, Quat, Vec3, Vec4};
use serde_json::{Map, Value, json};

use crate::base64;
use crate::{AlphaMode, Camera, Image, Material, Mesh, Scene, SceneError, Volume, Wrap};

/// Numbers that glTF 2.0 takes over from OpenGL.
mod gl {
    pub const FLOAT: u32 = 5126;
    pub const UNSIGNED_INT: u32 = 5125;
    pub const ARRAY_BUFFER: u32 = 34962;
    pub const ELEMENT_ARRAY_BUFFER: u32 = 34963;
    pub const LINEAR: u32 = 9729;
    pub const LINEAR_MIPMAP_LINEAR: u32 = 9987;
    pub const REPEAT: u32 = 10497;
    pub const MIRRORED_REPEAT: u32 = 33648;
    pub const CLAMP_TO_EDGE: u32 = 33071;
}

/// Writes a scene as `.glb`: meshes, instances as nodes, materials, pictures as PNG inside, cameras, lights.
///
/// Loading it gives the same triangles, materials, cameras and lights, the numbers of cameras and lights within
/// rounding.
///
/// # Errors
/// The scene exceeds the container's 4 GiB, or a picture cannot be encoded.
pub fn export_glb(scene: &Scene) -> Result<Vec<u8>, SceneError> {
    let failed = |problem: String| SceneError::Export { scene: scene.name.clone(), problem };
    let (document, bin) = Writer::default().document(scene).map_err(failed)?;
    container(&document, bin).map_err(failed)
}

/// The same as `.gltf`: text, with the binary buffer inside as a data URI.
///
/// # Errors
/// As [`export_glb`].
pub fn export_gltf(scene: &Scene) -> Result<Vec<u8>, SceneError> {
    let failed = |problem: String| SceneError::Export { scene: scene.name.clone(), problem };
    let (mut document, bin) = Writer::default().document(scene).map_err(failed)?;
    if !bin.is_empty() {
        let uri = format!("data:application/octet-stream;base64,{}", base64::encode(&bin));
        document["buffers"][0]["uri"] = Value::String(uri);
    }
    let mut text = document.to_string().into_bytes();
    text.push(b'\n');
    Ok(text)
}

/// [`export_glb`] into a writer.
///
/// # Errors
/// As [`export_glb`], or the writer fails.
pub fn export_glb_to(scene: &Scene, mut writer: impl Write) -> Result<(), SceneError> {
    let bytes = export_glb(scene)?;
    writer.write_all(&bytes).map_err(|e| SceneError::Export { scene: scene.name.clone(), problem: e.to_string() })
}

/// Header, JSON chunk, BIN chunk (glTF 2.0, section 4).
pub(crate) fn container(document: &Value, mut bin: Vec<u8>) -> Result<Vec<u8>, String> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    const HEADER_BYTES: usize = 12;
    const CHUNK_HEADER_BYTES: usize = 8;
    let bin_chunk_bytes = if bin.is_empty() { 0 } else { CHUNK_HEADER_BYTES + bin.len() };
    let total = HEADER_BYTES + CHUNK_HEADER_BYTES + json.len() + bin_chunk_bytes;
    let total =
        u32::try_from(total).map_err(|_| format!("{total} bytes exceed the 4 GiB of a .glb; split the scene"))?;
    let mut out = Vec::with_capacity(total as usize);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&total.to_le_bytes());
    let chunks: [(&[u8], &[u8]); 2] = [(b"JSON", &json), (b"BIN\0", &bin)];
    for (kind, data) in chunks.into_iter().filter(|(_, data)| !data.is_empty()) {
        // Each is shorter than the whole, which fits.
        out.extend_from_slice(&(data.len() as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(data);
    }
    Ok(out)
}

/// A document in the making.
#[derive(Default)]
struct Writer {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Writer {
    fn document(mut self, scene: &Scene) -> Result<(Value, Vec<u8>), String> {
        let mut samplers: Vec<[Wrap; 2]> = Vec::new();
        let mut images = Vec::new();
        let mut textures = Vec::new();
        for image in &scene.images {
            let sampler = samplers.iter().position(|s| *s == image.wrap).unwrap_or_else(|| {
                samplers.push(image.wrap);
                samplers.len() - 1
            });
            let view = self.view(&png(image)?, None);
            textures.push(json!({ "source": images.len(), "sampler": sampler }));
            images.push(json!({ "bufferView": view, "mimeType": "image/png" }));
        }
        let (surfaces, of_mesh) = surfaces(scene);
        let materials: Vec<Value> = surfaces.iter().map(material).collect();
        // glTF knows no mesh without triangles.
        let drawn = |mesh: &Mesh| !mesh.indices.is_empty();
        let meshes: Vec<Value> = scene
            .meshes
            .iter()
            .zip(of_mesh)
            .filter(|(mesh, _)| drawn(mesh))
            .map(|(mesh, (material, scale))| self.mesh(mesh, material, scale))
            .collect();

        let mut nodes: Vec<Value> = Vec::new();
        let written: Vec<usize> = scene
            .meshes
            .iter()
            .scan(0, |next, mesh| Some(std::mem::replace(next, *next + usize::from(drawn(mesh)))))
            .collect();
        for instance in scene.instances.iter().filter(|i| drawn(&scene.meshes[i.mesh])) {
            nodes.push(object(json!({
                "name": scene.meshes[instance.mesh].name,
                "mesh": written[instance.mesh],
                "matrix": matrix(instance.world_from_object),
            })));
        }
        for (k, camera) in scene.cameras.iter().enumerate() {
            nodes.push(camera_node(camera, k));
        }
        for (k, light) in scene.lights.iter().enumerate() {
            nodes.push(light_node(light, k));
        }

        let transmits = scene.materials.iter().any(|m| m.transmission > 0.0);
        let absorbs = scene.materials.iter().any(|m| m.volume.is_some());
        let glows = scene.materials.iter().any(|m| m.emissive.max_element() > 1.0);
        let used: Vec<&str> = [
            (!scene.lights.is_empty(), "KHR_lights_punctual"),
            (transmits, "KHR_materials_transmission"),
            (absorbs, "KHR_materials_volume"),
            (glows, "KHR_materials_emissive_strength"),
        ]
        .into_iter()
        .filter_map(|(used, name)| used.then_some(name))
        .collect();
        let all_nodes: Vec<usize> = (0..nodes.len()).collect();
        let length = self.bin.len();
        let document = object(json!({
            "asset": { "version": "2.0", "generator": concat!("antumbra ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": used,
            "extensions": object(json!({
                "KHR_lights_punctual": object(json!({
                    "lights": scene.lights.iter().map(light).collect::<Vec<_>>(),
                })),
            })),
            "scene": 0,
            "scenes": [object(json!({ "name": scene.name, "nodes": all_nodes }))],
            "nodes": nodes,
            "meshes": meshes,
            "materials": materials,
            "textures": textures,
            "samplers": samplers.iter().map(sampler).collect::<Vec<_>>(),
            "images": images,
            "cameras": scene.cameras.iter().map(camera).collect::<Vec<_>>(),
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": if length > 0 { vec![json!({ "byteLength": length })] } else { Vec::new() },
        }));
        Ok((document, self.bin))
    }

    /// `material` is the index in the file; vertex colours are divided by `color_scale`.
    fn mesh(&mut self, mesh: &Mesh, material: usize, color_scale: f32) -> Value {
        let mut attributes = Map::new();
        let bounds = crate::Aabb::of(mesh.positions.iter().copied());
        let positions = self.accessor(bytemuck::cast_slice(&mesh.positions), "VEC3", mesh.positions.len());
        if !bounds.is_empty() {
            self.accessors[positions]["min"] = json!(bounds.min.to_array());
            self.accessors[positions]["max"] = json!(bounds.max.to_array());
        }
        attributes.insert("POSITION".into(), positions.into());
        if !mesh.normals.is_empty() {
            let normals = self.accessor(bytemuck::cast_slice(&mesh.normals), "VEC3", mesh.normals.len());
            attributes.insert("NORMAL".into(), normals.into());
        }
        if !mesh.uvs.is_empty() {
            let uvs = self.accessor(bytemuck::cast_slice(&mesh.uvs), "VEC2", mesh.uvs.len());
            attributes.insert("TEXCOORD_0".into(), uvs.into());
        }
        if !mesh.colors.is_empty() {
            // Not cast: a Vec4 may be aligned to 16 bytes, which bytemuck need not accept of a list of them.
            let scaled = |c: &Vec4| (c.truncate() / color_scale).extend(c.w).clamp(Vec4::ZERO, Vec4::ONE).to_array();
            let colors: Vec<[f32; 4]> = mesh.colors.iter().map(scaled).collect();
            let colors = self.accessor(bytemuck::cast_slice(&colors), "VEC4", colors.len());
            attributes.insert("COLOR_0".into(), colors.into());
        }
        let view = self.view(bytemuck::cast_slice(&mesh.indices), Some(gl::ELEMENT_ARRAY_BUFFER));
        self.accessors.push(json!({
            "bufferView": view,
            "componentType": gl::UNSIGNED_INT,
            "type": "SCALAR",
            "count": mesh.indices.len(),
        }));
        let indices = self.accessors.len() - 1;
        object(json!({
            "name": mesh.name,
            "primitives": [{ "attributes": attributes, "indices": indices, "material": material }],
        }))
    }

    /// Floats for vertices.
    fn accessor(&mut self, bytes: &[u8], kind: &str, count: usize) -> usize {
        let view = self.view(bytes, Some(gl::ARRAY_BUFFER));
        self.accessors.push(json!({
            "bufferView": view,
            "componentType": gl::FLOAT,
            "type": kind,
            "count": count,
        }));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bin.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }
}

/// The materials to write, and for each mesh which of them it has and by what its vertex colours are divided.
///
/// glTF wants colours and factors in [0, 1]. Where vertex colours exceed 1 their largest goes into a material of its
/// own, whose factor has room for it. It counts the thickness of a volume in the mesh's space, where it may differ from mesh
/// to mesh: the scale of a mesh's first instance says how.
fn surfaces(scene: &Scene) -> (Vec<Material>, Vec<(usize, f32)>) {
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

/// Without members that say nothing: glTF allows no empty list and needs no empty name.
fn object(mut value: Value) -> Value {
    if let Some(map) = value.as_object_mut() {
        map.retain(|_, v| match v {
            Value::Array(list) => !list.is_empty(),
            Value::Object(map) => !map.is_empty(),
            Value::String(text) => !text.is_empty(),
            Value::Null => false,
            _ => true,
        });
    }
    value
}

fn png(image: &Image) -> Result<Vec<u8>, String> {
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
    .map_err(|e| format!("a picture of {} x {} texels: {e}", image.width, image.height))?;
    Ok(out.into_inner())
}

fn sampler(wrap: &[Wrap; 2]) -> Value {
    let [s, t] = wrap.map(|wrap| match wrap {
        Wrap::Repeat => gl::REPEAT,
        Wrap::Mirror => gl::MIRRORED_REPEAT,
        Wrap::Clamp => gl::CLAMP_TO_EDGE,
    });
    json!({ "magFilter": gl::LINEAR, "minFilter": gl::LINEAR_MIPMAP_LINEAR, "wrapS": s, "wrapT": t })
}

fn material(material: &Material) -> Value {
    let mut pbr = json!({
        "baseColorFactor": material.base_color.clamp(Vec4::ZERO, Vec4::ONE).to_array(),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    // One texture was written for each picture, in order.
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
    // The factor may not exceed 1; a strength carries the rest.
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

/// `null` for the identity, which is the default.
fn matrix(m: Mat4) -> Value {
    if m == Mat4::IDENTITY { Value::Null } else { json!(m.to_cols_array()) }
}

/// The rotation of a node that looks along `forward` with its −z.
fn looking(forward: Vec3, up: Vec3) -> [f32; 4] {
    let right = forward.cross(up).normalize();
    Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward)).normalize().to_array()
}

fn camera(camera: &Camera) -> Value {
    json!({
        "type": "perspective",
        "perspective": { "yfov": camera.fov_y_rad, "znear": camera.near_m, "zfar": camera.far_m },
        "extras": { "target_distance": camera.eye.distance(camera.target) },
    })
}

fn camera_node(camera: &Camera, index: usize) -> Value {
    let forward = (camera.target - camera.eye).normalize();
    json!({
        "camera": index,
        "translation": camera.eye.to_array(),
        "rotation": looking(forward, camera.up),
    })
}

fn light(light: &Light) -> Value {
    let mut extras = Map::new();
    let mut extra = |key: &str, value: Value| extras.insert(key.into(), value);
    extra("intensity", light.intensity.into());
    if let Some(given) = light.candela_or_lux {
        extra(light.shape.photometric_unit(), given.into());
    }
    let node_from_world = Quat::from_array(looking(light.axis, light.up)).inverse();
    let (kind, shape) = match &light.shape {
        LightShape::Rectangle { size_m } => {
            extra("size", json!(size_m.to_array()));
            ("spot", "rectangle")
        }
        LightShape::Disk { radius_m } => {
            extra("radius", json!(radius_m));
            ("spot", "disk")
        }
        LightShape::Sphere { radius_m } => {
            extra("radius", json!(radius_m));
            ("point", "sphere")
        }
        LightShape::Ellipsoid { radii_m } => {
            extra("radii", json!(radii_m.to_array()));
            ("point", "ellipsoid")
        }
        LightShape::Sun { angular_diameter_rad } => {
            extra("angular_diameter", json!(angular_diameter_rad.to_degrees()));
            ("directional", "sun")
        }
        LightShape::Points { positions_m } => {
            let local = |p: &Vec3| (node_from_world * (*p - light.center)).to_array();
            extra("positions", positions_m.iter().map(|p| json!(local(p))).collect());
            ("point", "points")
        }
    };
    // A cone is a spot's alone, whatever the shape.
    let kind = if light.cone.is_some() { "spot" } else { kind };
    extra("shape", shape.into());
    if let Some(fov_rad) = light.fov_rad {
        extra("fov", fov_rad.to_degrees().into());
    }
    if let Some(emission) = &light.emission {
        let tint = emission.tint.as_ref().map(|tint| tint.iter().map(|c| c.to_array()).collect::<Vec<_>>());
        let EmissionTexture { width, height, luminance, .. } = emission;
        extra("emission", object(json!({ "width": width, "height": height, "luminance": luminance, "tint": tint })));
    }
    let spot = if kind == "spot" {
        let (inner, outer) = light.cone.map_or((0.0, FRAC_PI_2), |cone| (cone.inner_rad, cone.outer_rad));
        json!({ "innerConeAngle": inner, "outerConeAngle": outer })
    } else {
        Value::Null
    };
    object(json!({
        "name": light.name,
        "type": kind,
        "color": light.color.to_array(),
        // What other programs read.
        "intensity": light.candela_or_lux.unwrap_or(1.0) * light.intensity,
        "spot": spot,
        "extras": extras,
    }))
}

fn light_node(light: &Light, index: usize) -> Value {
    json!({
        "name": light.name,
        "translation": light.center.to_array(),
        "rotation": looking(light.axis, light.up),
        "extensions": { "KHR_lights_punctual": { "light": index } },
    })
}

#[cfg(test)]
mod tests {
    use antumbra_light::Cone;
    use glam::Vec2;

    use super::*;
    use crate::{Instance, LoadOptions, builtin, load_bytes};

    fn back(scene: &Scene) -> Scene {
        let bytes = export_glb(scene).unwrap();
        let (pose, limits) = (crate::gltf::Pose::At(0.0), crate::gltf::Limits::GENEROUS);
        crate::gltf::load_bytes(&bytes, &scene.name, pose, limits).unwrap().scene
    }

    fn same_light(a: &Light, b: &Light) {
        assert!(a.axis.abs_diff_eq(b.axis, 1e-5) && a.center == b.center, "{a:?} {b:?}");
        assert!(a.frame().right.abs_diff_eq(b.frame().right, 1e-4));
        match (a.fov_rad, b.fov_rad) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-5),
            (a, b) => assert_eq!(a, b),
        }
        assert_eq!(a.cone, b.cone);
        assert_eq!((a.color, a.intensity, &a.emission, &a.name), (b.color, b.intensity, &b.emission, &b.name));
        assert_eq!(a.candela_or_lux, b.candela_or_lux);
        match (&a.shape, &b.shape) {
            (LightShape::Sun { angular_diameter_rad: a }, LightShape::Sun { angular_diameter_rad: b }) => {
                assert!((a - b).abs() < 1e-6);
            }
            (LightShape::Points { positions_m: a }, LightShape::Points { positions_m: b }) => {
                assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff_eq(*b, 1e-4)), "{a:?} {b:?}");
            }
            (a, b) => assert_eq!(a, b),
        }
    }

    #[test]
    fn built_ins_survive_the_round_trip() {
        for info in builtin::NAMES {
            let scene = builtin::build(info.name).unwrap();
            let back = back(&scene);
            assert!(back.warnings.is_empty(), "{}: {:?}", info.name, back.warnings);
            assert_eq!(back.triangle_count(), scene.triangle_count(), "{}", info.name);
            let limit = 1e-5 * scene.bounds().diagonal();
            for (a, b) in scene.world_triangles().zip(back.world_triangles()) {
                assert!((0..3).all(|k| a.positions[k].abs_diff_eq(b.positions[k], limit)), "{}", info.name);
            }
            for (a, b) in scene.instances.iter().zip(&back.instances) {
                let (a, b) = (&scene.meshes[a.mesh], &back.meshes[b.mesh]);
                assert_eq!(a.closed, b.closed, "{}: {}", info.name, a.name);
                // By corner: vertices that no triangle uses are not loaded.
                let corners = a.indices.iter().map(|i| *i as usize).zip(b.indices.iter().map(|i| *i as usize));
                let (m, n) = (&scene.materials[a.material], &back.materials[b.material]);
                assert_eq!((&m.name, m.alpha, m.occluder()), (&n.name, n.alpha, n.occluder()));
                assert_eq!(m.roughness, n.roughness);
                // What exceeds 1 as a product cannot be said in glTF.
                let product = |m: &Material, c: &Vec4| (m.base_color * *c).min(Vec4::ONE);
                assert_eq!(a.colors.is_empty(), b.colors.is_empty());
                for (i, k) in corners {
                    assert!(a.normals[i].abs_diff_eq(b.normals[k], 1e-5), "{}", a.name);
                    if !a.colors.is_empty() {
                        assert!(product(m, &a.colors[i]).abs_diff_eq(product(n, &b.colors[k]), 1e-5), "{}", a.name);
                    }
                }
                let picture = |s: &Scene, m: &Material| m.base_color_image.map(|i| s.images[i].rgba8.clone());
                assert!(picture(&scene, m) == picture(&back, n), "{}", m.name);
            }
            assert_eq!(scene.lights.len(), back.lights.len());
            scene.lights.iter().zip(&back.lights).for_each(|(a, b)| same_light(a, b));
            for (a, b) in scene.cameras.iter().zip(&back.cameras) {
                let limit = 1e-5 * a.eye.distance(a.target);
                assert!(a.eye == b.eye && a.target.abs_diff_eq(b.target, limit), "{a:?} {b:?}");
                assert_eq!((a.fov_y_rad, a.near_m, a.far_m), (b.fov_y_rad, b.near_m, b.far_m));
            }
        }
    }

    #[test]
    fn every_light_shape_and_material_survives() {
        let mut scene = Scene { name: "all".into(), ..Scene::default() };
        let shapes = [
            LightShape::Rectangle { size_m: Vec2::new(1.5, 0.25) },
            LightShape::Disk { radius_m: 0.125 },
            LightShape::Sphere { radius_m: 0.3 },
            LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.2, 0.1) },
            LightShape::Sun { angular_diameter_rad: 0.03 },
            LightShape::Points { positions_m: vec![Vec3::new(1.0, 2.0, 3.0), Vec3::Y] },
        ];
        for (k, shape) in shapes.into_iter().enumerate() {
            let mut light = Light::new(shape, Vec3::new(1.0, 5.0, k as f32), Vec3::ZERO);
            light.name = format!("{k}");
            light.up = Vec3::new(0.3, 0.1, 1.0);
            light.intensity = 0.5 + k as f32;
            light.candela_or_lux = (k % 2 == 0).then_some(40.0 * (1.0 + k as f32));
            light.fov_rad = (k % 2 == 0).then_some(0.7);
            light.cone = (k % 3 == 0).then_some(Cone { inner_rad: 0.2, outer_rad: 0.6 });
            scene.lights.push(light);
        }
        scene.lights[0].emission =
            Some(EmissionTexture::from_rgb(2, 1, &[Vec3::splat(0.5), Vec3::new(3.0, 0.25, 1.0)]));
        let glow = Vec3::new(4.0, 2.0, 0.0);
        scene.materials = vec![
            Material {
                name: "m".into(),
                transmission: 0.5,
                transmission_image: Some(0),
                emissive: glow,
                metallic: 0.5,
                metallic_roughness_image: Some(0),
                volume: Some(Volume {
                    thickness_m: 0.25,
                    thickness_image: Some(0),
                    attenuation_color: Vec3::new(1.0, 0.5, 0.25),
                    attenuation_distance_m: 2.0,
                }),
                ..Material::default()
            },
            Material {
                name: "n".into(),
                alpha: AlphaMode::Mask { cutoff: 0.75 },
                base_color_image: Some(0),
                double_sided: true,
                ..Material::default()
            },
        ];
        let wrap = [Wrap::Mirror, Wrap::Clamp];
        scene.images = vec![Image { width: 2, height: 1, rgba8: vec![[1, 2, 3, 4], [5, 6, 7, 0]], wrap }];
        let mesh = Mesh {
            name: "t".into(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            colors: vec![Vec4::new(0.5, 0.25, 1.0, 0.125); 3],
            indices: vec![0, 1, 2],
            material: 1,
            closed: false,
        };
        let plain = Mesh { name: "p".into(), material: 0, colors: Vec::new(), ..mesh.clone() };
        let empty = Mesh { indices: Vec::new(), ..mesh.clone() };
        scene.meshes = vec![empty, mesh, plain];
        let place = |mesh, x| Instance { mesh, world_from_object: Mat4::from_translation(Vec3::X * x) };
        scene.instances = vec![place(0, 1.0), place(1, 2.0), place(2, 0.0)];
        scene.instances[2].world_from_object *= Mat4::from_scale(Vec3::splat(0.5));

        let back = back(&scene);
        assert_eq!(back.warnings, Vec::<String>::new());
        assert_eq!(back.instances.len(), 2, "the empty one is gone");
        scene.lights.iter().zip(&back.lights).for_each(|(a, b)| same_light(a, b));
        let (a, b) = (&scene.meshes[1], &back.meshes[0]);
        assert_eq!((&a.uvs, &a.colors, &a.positions), (&b.uvs, &b.colors, &b.positions));
        assert_eq!(back.images[0].rgba8, scene.images[0].rgba8);
        assert_eq!(back.images[0].wrap, wrap);
        let material = |k: usize| &back.materials[back.meshes[k].material];
        assert_eq!((material(0).alpha, material(0).double_sided), (AlphaMode::Mask { cutoff: 0.75 }, true));
        let (m, n) = (&scene.materials[0], material(1));
        assert_eq!((m.transmission, m.metallic, m.emissive), (n.transmission, n.metallic, n.emissive));
        assert_eq!((&m.volume, m.roughness), (&n.volume, n.roughness));
        let images = [n.transmission_image, n.metallic_roughness_image];
        assert!(
            images.iter().all(|image| image.is_some_and(|image| back.images[image].rgba8 == scene.images[0].rgba8))
        );
    }

    #[test]
    fn the_export_is_valid_for_another_reader() {
        let scene = builtin::build("window").unwrap();
        let bytes = export_glb(&scene).unwrap();
        // The crate's own reader validates the whole document, which this crate's loader does not ask it to.
        let parsed = gltf::Gltf::from_slice(&bytes).unwrap();
        assert_eq!(parsed.meshes().len(), scene.meshes.len());
        assert_eq!(load_bytes(&bytes, "w", &LoadOptions::default()).unwrap().triangle_count(), scene.triangle_count());
    }
}
