//! Export of scenes as glTF 2.0, binary or text.
//!
//! Properties of lights that glTF's extensions lack (shape, size, exposure) go into `extras`. The loader of this crate
//! reads them back; other programs ignore them.

mod buffers;
mod cameras_and_lights;
mod materials;

use std::io::Write;

use glam::Mat4;
use serde_json::{Value, json};

use crate::base64;
use crate::{Mesh, Scene, SceneError, Wrap};
use buffers::Writer;
use cameras_and_lights::{camera, camera_node, light, light_node};
use materials::{material, png, sampler, surfaces};

/// OpenGL constants that glTF 2.0 uses.
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

/// Writes a scene as `.glb`: meshes, instances as nodes, materials, images as embedded PNG, cameras, lights.
///
/// Loading the result gives the same triangles, materials, cameras and lights; numbers of cameras and lights are equal
/// within rounding.
///
/// # Errors
/// The scene exceeds the container's 4 GiB, or an image cannot be encoded.
pub fn export_glb(scene: &Scene) -> Result<Vec<u8>, SceneError> {
    let failed = |problem: String| SceneError::Export { scene: scene.name.clone(), problem };
    let (document, bin) = Writer::default().document(scene).map_err(failed)?;
    container(&document, bin).map_err(failed)
}

/// Writes a scene as `.gltf`: text, with the binary buffer embedded as a data URI.
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

/// Assembles a GLB file: header, JSON chunk, BIN chunk (glTF 2.0, section 4).
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

impl Writer {
    fn document(mut self, scene: &Scene) -> Result<(Value, Vec<u8>), String> {
        let Images { samplers, images, textures } = self.images(scene)?;
        let (surfaces, of_mesh) = surfaces(scene);
        let materials: Vec<Value> = surfaces.iter().map(material).collect();
        let meshes: Vec<Value> = scene
            .meshes
            .iter()
            .zip(of_mesh)
            .filter(|(mesh, _)| is_written(mesh))
            .map(|(mesh, (material, scale))| self.mesh(mesh, material, scale))
            .collect();
        let nodes = nodes(scene);
        let all_nodes: Vec<usize> = (0..nodes.len()).collect();
        let length = self.bin.len();
        let document = object(json!({
            "asset": { "version": "2.0", "generator": concat!("antumbra ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": extensions(scene),
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

    /// Writes the images as PNG, with a sampler for each way to wrap.
    fn images(&mut self, scene: &Scene) -> Result<Images, String> {
        let (mut samplers, mut images, mut textures) = (Vec::new(), Vec::new(), Vec::new());
        for image in &scene.images {
            let sampler = samplers.iter().position(|s| *s == image.wrap).unwrap_or_else(|| {
                samplers.push(image.wrap);
                samplers.len() - 1
            });
            let view = self.view(&png(image)?, None);
            textures.push(json!({ "source": images.len(), "sampler": sampler }));
            images.push(json!({ "bufferView": view, "mimeType": "image/png" }));
        }
        Ok(Images { samplers, images, textures })
    }
}

/// Images, and the textures that sample them.
struct Images {
    samplers: Vec<[Wrap; 2]>,
    images: Vec<Value>,
    textures: Vec<Value>,
}

/// Whether a mesh is part of the file: glTF does not allow meshes without triangles.
fn is_written(mesh: &Mesh) -> bool {
    !mesh.indices.is_empty()
}

/// Nodes of instances, cameras and lights.
fn nodes(scene: &Scene) -> Vec<Value> {
    let written: Vec<usize> = scene
        .meshes
        .iter()
        .scan(0, |next, mesh| Some(std::mem::replace(next, *next + usize::from(is_written(mesh)))))
        .collect();
    let mut nodes: Vec<Value> = Vec::new();
    for instance in scene.instances.iter().filter(|i| is_written(&scene.meshes[i.mesh])) {
        nodes.push(object(json!({
            "name": scene.meshes[instance.mesh].name,
            "mesh": written[instance.mesh],
            "matrix": matrix(instance.world_from_object),
        })));
    }
    nodes.extend(scene.cameras.iter().enumerate().map(|(k, camera)| camera_node(camera, k)));
    nodes.extend(scene.lights.iter().enumerate().map(|(k, light)| light_node(light, k)));
    nodes
}

/// Names of the extensions that the scene uses.
fn extensions(scene: &Scene) -> Vec<&'static str> {
    let transmits = scene.materials.iter().any(|m| m.transmission > 0.0);
    let absorbs = scene.materials.iter().any(|m| m.volume.is_some());
    let glows = scene.materials.iter().any(|m| m.emissive.max_element() > 1.0);
    [
        (!scene.lights.is_empty(), "KHR_lights_punctual"),
        (transmits, "KHR_materials_transmission"),
        (absorbs, "KHR_materials_volume"),
        (glows, "KHR_materials_emissive_strength"),
    ]
    .into_iter()
    .filter_map(|(used, name)| used.then_some(name))
    .collect()
}

/// Removes null and empty members: glTF allows no empty list and needs no empty name.
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

/// Node matrix; `null` for the identity, which is the default.
fn matrix(m: Mat4) -> Value {
    if m == Mat4::IDENTITY { Value::Null } else { json!(m.to_cols_array()) }
}

#[cfg(test)]
mod tests;
