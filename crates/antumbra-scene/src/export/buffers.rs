//! Buffers of a document: vertices, indices and images as views and accessors.

use glam::Vec4;
use serde_json::{Map, Value, json};

use super::{gl, object};
use crate::Mesh;

/// Builder of a document's binary chunk, buffer views and accessors.
#[derive(Default)]
pub(super) struct Writer {
    pub(super) bin: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Writer {
    /// Writes a mesh. `material` is the index in the file; vertex colours are divided by `color_scale`.
    pub(super) fn mesh(&mut self, mesh: &Mesh, material: usize, color_scale: f32) -> Value {
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
            // Copied rather than cast: a Vec4 may be aligned to 16 bytes, and bytemuck may then refuse the cast.
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

    /// Adds an accessor of float vertex attributes; returns its index.
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

    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
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
