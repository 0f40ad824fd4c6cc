//! Features of the format, each tested with a small generated file.

use glam::{Mat4, Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::unsound;
use crate::gltf::{Limits, Loaded, Pose, load_bytes};
use crate::{AlphaMode, Scene};
use antumbra_light::LightShape;

const FLOAT: u32 = 5126;

/// Builder of a document with its binary data.
pub(super) struct Doc {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Doc {
    /// Creates a scene of the given nodes.
    pub(super) fn new(nodes: Value) -> Self {
        let count = nodes.as_array().unwrap().len();
        let children: Vec<u64> = nodes
            .as_array()
            .unwrap()
            .iter()
            .filter_map(|n| n.get("children").and_then(Value::as_array))
            .flatten()
            .filter_map(Value::as_u64)
            .collect();
        let roots: Vec<u64> = (0..count as u64).filter(|i| !children.contains(i)).collect();
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": roots }], "nodes": nodes,
            "accessors": [], "bufferViews": [], "buffers": [{ "byteLength": 0 }],
        });
        Self { json, bin: Vec::new() }
    }

    pub(super) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub(super) fn view(&mut self, bytes: &[u8], extra: Value) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        merge(&mut view, extra);
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    pub(super) fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize, extra: Value) -> usize {
        let view = self.view(bytes, json!({}));
        let mut accessor = json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        merge(&mut accessor, extra);
        self.push("accessors", accessor)
    }

    pub(super) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4), ("MAT4", 16)];
        let width = width.iter().find(|(k, _)| *k == kind).unwrap().1;
        self.accessor(bytemuck::cast_slice(values), FLOAT, kind, values.len() / width, json!({}))
    }

    /// Adds the unit right triangle in the xy plane, facing +z, as mesh 0.
    pub(super) fn triangle(&mut self, extra: Value) {
        let positions = self.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let mut primitive = json!({ "attributes": { "POSITION": positions } });
        merge(&mut primitive, extra);
        self.json["meshes"] = json!([{ "primitives": [primitive] }]);
    }

    pub(super) fn load_at(&self, time_s: f32) -> Result<Scene, String> {
        self.load_animated_at(time_s).map(|loaded| loaded.scene)
    }

    fn load_animated_at(&self, time_s: f32) -> Result<Loaded, String> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = self.bin.len().into();
        let bytes = crate::export::container(&json, self.bin.clone()).unwrap();
        let loaded = load_bytes(&bytes, "test", Pose::At(time_s), Limits::TIGHT).map_err(|e| e.to_string())?;
        assert_eq!(unsound(&loaded.scene), None);
        Ok(loaded)
    }

    pub(super) fn load(&self) -> Scene {
        self.load_at(0.0).unwrap()
    }
}

fn merge(into: &mut Value, extra: Value) {
    for (key, value) in extra.as_object().unwrap() {
        match (into.get_mut(key), value) {
            (Some(old @ Value::Object(_)), Value::Object(_)) => merge(old, value.clone()),
            _ => into[key] = value.clone(),
        }
    }
}

fn corners(scene: &Scene) -> Vec<Vec3> {
    scene.world_triangles().flat_map(|t| t.positions).collect()
}

/// Unit normal that follows from the winding.
fn facing(t: &[Vec3]) -> Vec3 {
    (t[1] - t[0]).cross(t[2] - t[0]).normalize()
}

#[test]
fn strips_and_fans_wind_as_the_specification_says() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0f32];
    for (mode, order) in [(5, [0u8, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let mut doc = Doc::new(json!([{ "mesh": 0 }]));
        let positions = doc.floats("VEC3", &square);
        let indices = doc.accessor(&order, 5121, "SCALAR", 4, json!({}));
        doc.json["meshes"] =
            json!([{ "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices, "mode": mode }] }]);
        let scene = doc.load();
        assert_eq!(scene.triangle_count(), 2);
        for t in corners(&scene).chunks(3) {
            assert!(facing(t).abs_diff_eq(Vec3::Z, 1e-6));
        }
    }
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.triangle(json!({ "mode": 1 }));
    let scene = doc.load();
    assert_eq!(scene.triangle_count(), 0);
    assert!(scene.warnings[0].contains("points and lines"), "{:?}", scene.warnings);
}

#[test]
fn missing_normals_are_flat() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.triangle(json!({}));
    assert_eq!(doc.load().meshes[0].normals, vec![Vec3::Z; 3]);
}

#[test]
fn mirrors_keep_the_front_and_sheets_are_baked() {
    let mut doc = Doc::new(json!([
        { "mesh": 0, "scale": [-1, 1, 1] },
        { "mesh": 0, "scale": [1, 1, 0] },
        { "mesh": 0, "scale": [0, 0, 0] },
        { "mesh": 0, "scale": [2, -3, -1] },
    ]));
    doc.triangle(json!({}));
    let scene = doc.load();
    let corners = corners(&scene);
    assert_eq!(corners.len(), 9);
    assert!(facing(&corners[0..3]).abs_diff_eq(Vec3::Z, 1e-6), "a mirror in x leaves the front in front");
    assert!(facing(&corners[3..6]).z.abs() > 0.999);
    assert!(facing(&corners[6..9]).abs_diff_eq(Vec3::NEG_Z, 1e-6), "two mirrors turn it round");
    assert_eq!(corners[0..3].iter().map(|p| p.x).fold(0.0, f32::min), -1.0);
    assert_eq!(scene.meshes.len(), 3);
    assert!(scene.warnings.iter().any(|w| w.contains("ignored")));
}

#[test]
fn quantised_and_sparse_attributes_are_decoded() {
    let mut doc = Doc::new(json!([{ "mesh": 0, "scale": [2, 2, 2] }]));
    doc.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    doc.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    // The stride is four bytes.
    let bytes = [0i8, 0, 0, 0, 127, 0, 0, 0, 0, 127, -128, 0].map(|v| v as u8);
    let view = doc.view(&bytes, json!({ "byteStride": 4 }));
    let replaced = doc.view(&[2], json!({}));
    let value = doc.view(&[0, 127, 0], json!({}));
    let positions = doc.push(
        "accessors",
        json!({
            "bufferView": view, "componentType": 5120, "normalized": true, "type": "VEC3", "count": 3,
            "sparse": {
                "count": 1,
                "indices": { "bufferView": replaced, "componentType": 5121 },
                "values": { "bufferView": value },
            },
        }),
    );
    doc.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": positions } }] }]);
    assert_eq!(corners(&doc.load()), [Vec3::ZERO, 2.0 * Vec3::X, 2.0 * Vec3::Y]);
    doc.json["accessors"][positions]["sparse"] = Value::Null;
    assert_eq!(corners(&doc.load())[2], Vec3::new(0.0, 2.0, -2.0), "-128 means -1");
    doc.json["extensionsUsed"] = json!([]);
    doc.json["extensionsRequired"] = json!([]);
    assert!(doc.load_at(0.0).unwrap_err().contains("KHR_mesh_quantization"));
}

#[cfg(feature = "meshopt")]
#[test]
fn compressed_views_are_decoded() {
    let vertices: Vec<[f32; 3]> = (0..40).map(|k| [k as f32, (k * k) as f32, 0.5]).collect();
    let indices: Vec<u32> = (0..38).flat_map(|k| [k, k + 1, k + 2]).collect();
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    doc.json["buffers"] = json!([
        { "byteLength": 0 },
        { "byteLength": 1000, "extensions": { "EXT_meshopt_compression": { "fallback": true } } },
    ]);
    let mut compressed = |encoded: &[u8], stride: usize, count: usize, mode: &str| {
        doc.bin.resize(doc.bin.len().next_multiple_of(4), 0);
        let offset = doc.bin.len();
        doc.bin.extend_from_slice(encoded);
        doc.push(
            "bufferViews",
            json!({
                "buffer": 1, "byteLength": stride * count,
                "extensions": { "EXT_meshopt_compression": {
                    "buffer": 0, "byteOffset": offset, "byteLength": encoded.len(),
                    "byteStride": stride, "count": count, "mode": mode,
                } },
            }),
        )
    };
    let p = compressed(&meshopt::encode_vertex_buffer(&vertices).unwrap(), 12, 40, "ATTRIBUTES");
    let i = compressed(&meshopt::encode_index_buffer(&indices, 40).unwrap(), 4, indices.len(), "TRIANGLES");
    let s = compressed(&meshopt::encode_index_sequence(&indices, 40).unwrap(), 2, indices.len(), "INDICES");
    doc.push("accessors", json!({ "bufferView": p, "componentType": FLOAT, "type": "VEC3", "count": 40 }));
    doc.push("accessors", json!({ "bufferView": i, "componentType": 5125, "type": "SCALAR", "count": 114 }));
    doc.push("accessors", json!({ "bufferView": s, "componentType": 5123, "type": "SCALAR", "count": 114 }));
    for index_accessor in [1, 2] {
        doc.json["meshes"] =
            json!([{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": index_accessor }] }]);
        let scene = doc.load();
        assert_eq!(scene.triangle_count(), 38);
        let key = |p: &Vec3| p.x as u32;
        assert_eq!(corners(&scene).iter().map(key).sum::<u32>(), indices.iter().sum::<u32>());
        assert!(corners(&scene).iter().all(|p| p.y == p.x * p.x && p.z == 0.5));
    }
    doc.json["bufferViews"][p]["extensions"]["EXT_meshopt_compression"]["count"] = 1u64.wrapping_shl(40).into();
    assert!(doc.load_at(0.0).is_err());
}

#[cfg(feature = "meshopt")]
#[test]
fn filters_of_compressed_views_are_undone() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.json["extensionsUsed"] = json!(["KHR_mesh_quantization", "EXT_meshopt_compression"]);
    let corners = [[0.5f32, 0.25, 0.0], [1.5, 0.0, -0.75], [0.0, 1.0, 3.0]];
    let exponential = meshopt::encode_filter_exp(&corners, 15, meshopt::EncodeExpMode::Separate);
    let normals = [Vec3::X, Vec3::new(0.0, -0.6, 0.8), Vec3::NEG_Z];
    let octahedral: Vec<[i16; 4]> = meshopt::encode_filter_oct(&normals.map(|n| n.extend(0.0).to_array()), 16);
    let mut compressed = |encoded: &[u8], stride: usize, filter: &str| {
        doc.bin.resize(doc.bin.len().next_multiple_of(4), 0);
        let offset = doc.bin.len();
        doc.bin.extend_from_slice(encoded);
        doc.push(
            "bufferViews",
            json!({
                "buffer": 0, "byteLength": stride * 3, "byteStride": stride,
                "extensions": { "EXT_meshopt_compression": {
                    "buffer": 0, "byteOffset": offset, "byteLength": encoded.len(),
                    "byteStride": stride, "count": 3, "mode": "ATTRIBUTES", "filter": filter,
                } },
            }),
        )
    };
    let p = compressed(&meshopt::encode_vertex_buffer(&exponential).unwrap(), 12, "EXPONENTIAL");
    let n = compressed(&meshopt::encode_vertex_buffer(&octahedral).unwrap(), 8, "OCTAHEDRAL");
    doc.push("accessors", json!({ "bufferView": p, "componentType": FLOAT, "type": "VEC3", "count": 3 }));
    let normal = json!({ "bufferView": n, "componentType": 5122, "normalized": true, "type": "VEC3", "count": 3 });
    doc.push("accessors", normal);
    doc.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 } }] }]);
    let scene = doc.load();
    for (k, normal) in normals.iter().enumerate() {
        assert!(scene.meshes[0].positions[k].abs_diff_eq(Vec3::from_array(corners[k]), 1e-3));
        assert!(scene.meshes[0].normals[k].abs_diff_eq(*normal, 1e-3), "{}", scene.meshes[0].normals[k]);
    }
}

#[cfg(not(feature = "meshopt"))]
#[test]
fn compressed_views_are_refused_without_the_decoder() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    doc.bin.resize(16, 0);
    let view = doc.push(
        "bufferViews",
        json!({
            "buffer": 0, "byteLength": 36,
            "extensions": { "EXT_meshopt_compression": {
                "buffer": 0, "byteOffset": 0, "byteLength": 16, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES",
            } },
        }),
    );
    doc.push("accessors", json!({ "bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": 3 }));
    doc.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    let why = doc.load_at(0.0).unwrap_err();
    assert!(why.contains("cannot decode") && !why.contains('\n'), "{why}");
}

#[test]
fn instancing_multiplies_a_mesh() {
    let mut doc = Doc::new(json!([{ "mesh": 0, "translation": [0, 0, 5] }]));
    doc.triangle(json!({}));
    let translation = doc.floats("VEC3", &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let rotation = doc.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    doc.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": {
        "attributes": { "TRANSLATION": translation, "ROTATION": rotation } } });
    let scene = doc.load();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    assert!(corners(&scene)[4].abs_diff_eq(Vec3::new(2.0, 1.0, 5.0), 1e-6));
}

#[test]
fn texture_transforms_are_baked() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    let uv = doc.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    doc.triangle(json!({ "attributes": { "TEXCOORD_1": uv }, "material": 0 }));
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(2, 3).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = doc.view(png.get_ref(), json!({}));
    doc.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    doc.json["samplers"] = json!([{ "wrapS": 33071 }]);
    doc.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    doc.json["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": {
            "offset": [0.5, 0.25], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 1,
        } } } },
        "alphaMode": "MASK", "alphaCutoff": 0.25,
    }]);
    let scene = doc.load();
    // Translation · rotation · scale; a quarter turn takes u to −v and v to u.
    let want = [Vec2::new(0.5, 0.25), Vec2::new(0.5, -1.75), Vec2::new(3.5, 0.25)];
    for (got, want) in scene.meshes[0].uvs.iter().zip(want) {
        assert!(got.abs_diff_eq(want, 1e-6), "{got} {want}");
    }
    let image = &scene.images[0];
    assert_eq!((image.width, image.height, image.wrap), (2, 3, [crate::Wrap::Clamp, crate::Wrap::Repeat]));
    assert_eq!(scene.materials[0].alpha, AlphaMode::Mask { cutoff: 0.25 });
}

#[test]
fn materials_keep_what_shadows_need() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    let colors =
        doc.accessor(&[255, 0, 51, 0, 255, 255, 255, 255, 0, 0, 0, 0], 5121, "VEC3", 3, json!({"normalized": true}));
    doc.json["bufferViews"][0]["byteStride"] = 4.into();
    doc.triangle(json!({ "attributes": { "COLOR_0": colors }, "material": 0 }));
    doc.json["materials"] = json!([{
        "name": "glass", "doubleSided": true, "alphaMode": "BLEND", "emissiveFactor": [0.5, 0, 0],
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.25 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 0.75 },
            "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 },
            "KHR_materials_unlit": {},
        },
    }]);
    doc.json["extensionsRequired"] = json!(["KHR_materials_unlit"]);
    let scene = doc.load();
    let m = &scene.materials[0];
    assert_eq!((m.name.as_str(), m.alpha, m.double_sided), ("glass", AlphaMode::Blend, true));
    assert_eq!((m.base_color, m.transmission, m.metallic), (Vec4::new(0.1, 0.2, 0.3, 0.4), 0.75, 0.25));
    assert_eq!((m.emissive, m.roughness), (Vec3::new(2.0, 0.0, 0.0), 1.0));
    assert_eq!(scene.meshes[0].colors[0], Vec4::new(1.0, 0.0, 0.2, 1.0));
}

/// Document whose node an animation drives with `output` at times 1 and 3.
fn animated(path: &str, kind: &str, interpolation: &str, output: &[f32]) -> Doc {
    let mut doc = Doc::new(json!([{ "mesh": 0, "translation": [9, 9, 9] }]));
    doc.triangle(json!({}));
    let input = doc.floats("SCALAR", &[1.0, 3.0]);
    let output = doc.floats(kind, output);
    doc.json["animations"] = json!([{
        "samplers": [{ "input": input, "output": output, "interpolation": interpolation }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": path } }],
    }]);
    doc
}

#[test]
fn what_was_loaded_at_one_time_is_had_at_others() {
    let ends = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0];
    let doc = animated("translation", "VEC3", "LINEAR", &ends);
    let animations = doc.load_animated_at(3.0).unwrap().animations.unwrap();
    assert_eq!(animations.ends_s(), [1.0, 3.0]);
    for time_s in [0.0, 1.0, 1.5, 3.0, 9.0] {
        let (posed, loaded) = (animations.scene_at(time_s).unwrap(), doc.load_at(time_s).unwrap());
        assert_eq!(format!("{posed:?}"), format!("{loaded:?}"), "{time_s}");
    }
    let mut still = Doc::new(json!([{ "mesh": 0 }]));
    still.triangle(json!({}));
    assert!(still.load_animated_at(0.0).unwrap().animations.is_none());
}

#[test]
fn animations_interpolate_and_clamp() {
    let ends = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0];
    let x = |doc: &Doc, time_s: f32| doc.load_at(time_s).unwrap().instances[0].world_from_object.w_axis.x;
    let linear = animated("translation", "VEC3", "LINEAR", &ends);
    for (time_s, want) in [(0.0, 0.0), (1.0, 0.0), (1.5, 1.0), (3.0, 4.0), (1e9, 4.0), (f32::NAN, 0.0)] {
        assert_eq!(x(&linear, time_s), want, "{time_s}");
    }
    let told = |doc: &Doc, time_s: f32| doc.load_at(time_s).unwrap().warnings;
    assert_eq!(told(&linear, 9.0), ["--time 9: the animations run from 1 s to 3 s; 3 s is used"]);
    assert!(
        [0.0, 1.0, 2.5, 3.0].iter().all(|time_s| told(&linear, *time_s).is_empty()),
        "0 is where nothing is asked for"
    );
    let mut still = Doc::new(json!([{ "mesh": 0 }]));
    still.triangle(json!({}));
    assert_eq!(told(&still, 2.0), ["--time 2: nothing in the scene is animated, so the time is ignored"]);
    let step = animated("translation", "VEC3", "STEP", &ends);
    assert_eq!([x(&step, 2.9), x(&step, 3.0)], [0.0, 4.0]);
    // In-tangent, value, out-tangent of each key; x leaves with 1 m/s and arrives at rest. Hermite at the middle:
    // (v0 + v1)/2 + span/8 · (out0 − in1).
    let z = [0.0; 3];
    let cubic = [z, z, [1.0, 0.0, 0.0], z, [4.0, 0.0, 0.0], z].concat();
    assert!((x(&animated("translation", "VEC3", "CUBICSPLINE", &cubic), 2.0) - 2.25).abs() < 1e-6);

    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = animated("rotation", "VEC4", "LINEAR", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half]);
    let matrix = turn.load_at(2.0).unwrap().instances[0].world_from_object;
    let want = Mat4::from_rotation_translation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_4), Vec3::splat(9.0));
    assert!(matrix.abs_diff_eq(want, 1e-5), "the shorter way round: {matrix}");
}

#[test]
fn morph_weights_come_from_the_animation_the_node_or_the_mesh() {
    let mut doc = animated("weights", "SCALAR", "LINEAR", &[0.0, 0.0, 1.0, 0.5]);
    let up = doc.floats("VEC3", &[0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0]);
    let right = doc.floats("VEC3", &[2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    doc.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": up }, { "POSITION": right }]);
    doc.json["nodes"][0] = json!({ "mesh": 0 });
    assert_eq!(corners(&doc.load_at(3.0).unwrap())[0], Vec3::new(1.0, 0.0, 2.0));
    assert_eq!(corners(&doc.load_at(2.0).unwrap())[0], Vec3::new(0.5, 0.0, 1.0));
    doc.json["animations"] = json!([]);
    doc.json["meshes"][0]["weights"] = json!([1.0, 0.0]);
    assert_eq!(corners(&doc.load())[0], Vec3::new(0.0, 0.0, 2.0));
    doc.json["nodes"][0]["weights"] = json!([0.0, 0.25]);
    assert_eq!(corners(&doc.load())[0], Vec3::new(0.5, 0.0, 0.0));
}

#[test]
fn skins_follow_their_joints_and_not_their_node() {
    let mut doc = Doc::new(json!([
        { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
        { "translation": [0, 0, 1], "children": [2] },
        { "translation": [0, 2, 0] },
    ]));
    let joints = doc.accessor(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 7, 0], 5121, "VEC4", 3, json!({}));
    // The third vertex is influenced by both joints, and by one that does not exist.
    let weights = doc.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.0]);
    doc.triangle(json!({ "attributes": { "JOINTS_0": joints, "WEIGHTS_0": weights } }));
    let inverse = [Mat4::IDENTITY, Mat4::from_translation(Vec3::new(-1.0, 0.0, 0.0))];
    let inverse: Vec<f32> = inverse.iter().flat_map(|m| m.to_cols_array()).collect();
    let inverse = doc.floats("MAT4", &inverse);
    doc.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": inverse }]);
    let scene = doc.load();
    let want = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 2.0, 1.0), Vec3::new(-0.5, 2.0, 1.0)];
    assert_eq!(corners(&scene), want);
    assert!(scene.warnings[0].contains("joints that do not exist"));
}

#[test]
fn cameras_and_lights_get_the_formats_sizes() {
    let turned = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2).to_array();
    let lit = |light: usize| json!({ "KHR_lights_punctual": { "light": light } });
    let mut doc = Doc::new(json!([
        { "mesh": 0 },
        { "camera": 0, "translation": [0, 5, 0], "rotation": turned },
        { "extensions": lit(0), "translation": [0, 3, 0], "rotation": turned, "scale": [7, 7, 7] },
        { "extensions": lit(1), "translation": [0, 4, 0] },
        { "extensions": lit(2), "rotation": turned },
        { "extensions": lit(3), "extras": { "radius": 0.5 } },
        { "extensions": lit(4) },
        { "extensions": lit(5) },
    ]));
    doc.triangle(json!({}));
    doc.json["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.25 }, "extras": 3 }]);
    doc.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 50, "spot": { "outerConeAngle": 0.5 } },
        { "type": "point", "intensity": 100, "color": [1, 0.5, 0] },
        { "type": "directional", "intensity": 3 },
        { "type": "point", "intensity": 25 },
        { "type": "spot", "extras": { "size": [1, 2], "intensity": 5 } },
        { "type": "directional", "extras": { "angular_diameter": 2 }, "intensity": 6 },
    ] } });
    let scene = doc.load();
    let camera = scene.cameras[0];
    assert!(camera.target.abs_diff_eq(Vec3::new(0.0, 4.0, 0.0), 1e-5), "{camera:?}");
    assert!(camera.up.abs_diff_eq(Vec3::NEG_Z, 1e-6));
    assert_eq!((camera.fov_y_rad, camera.near_m, camera.far_m), (0.5, 0.25, 200.0));

    let l = &scene.lights;
    assert_eq!(l[0].shape, LightShape::Disk { radius_m: 0.05 });
    let cone = l[0].cone.expect("a spot's");
    assert_eq!((cone.outer_rad, l[0].fov_rad, l[0].intensity), (0.5, None, 1.0));
    let given: Vec<_> = l.iter().map(|light| light.candela_or_lux).collect();
    assert_eq!(given, [Some(50.0), Some(100.0), Some(3.0), Some(25.0), None, Some(6.0)], "candela, or a sun's lux");
    assert!(l[1].is_omnidirectional() && !l[0].is_omnidirectional());
    assert!(l[0].axis.abs_diff_eq(Vec3::NEG_Y, 1e-6));
    assert_eq!(l[1].shape, LightShape::Sphere { radius_m: 0.05 });
    assert_eq!((l[1].color, l[1].intensity), (Vec3::new(1.0, 0.5, 0.0), 1.0));
    assert!(l[1].axis.dot((scene.bounds().center() - l[1].center).normalize()) > 0.999, "aims at the scene");
    assert_eq!(l[2].shape, LightShape::Sun { angular_diameter_rad: 0.53f32.to_radians() });
    assert!(l[2].axis.abs_diff_eq(Vec3::NEG_Y, 1e-6));
    assert_eq!((l[3].shape.clone(), l[3].intensity), (LightShape::Sphere { radius_m: 0.5 }, 1.0));
    assert_eq!((l[4].shape.clone(), l[4].intensity), (LightShape::Rectangle { size_m: Vec2::new(1.0, 2.0) }, 5.0));
    assert_eq!(l[5].shape, LightShape::Sun { angular_diameter_rad: 2f32.to_radians() });
}

#[test]
fn a_cube_is_closed_and_its_half_is_not() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    let positions: Vec<f32> =
        crate::Aabb { min: Vec3::ZERO, max: Vec3::ONE }.corners().iter().flat_map(|p| p.to_array()).collect();
    let positions = doc.floats("VEC3", &positions);
    let faces: [u8; 36] =
        [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
    for (count, closed) in [(36, true), (33, false)] {
        let indices = doc.accessor(&faces[..count], 5121, "SCALAR", count, json!({}));
        doc.json["meshes"] =
            json!([{ "primitives": [{ "attributes": { "POSITION": positions }, "indices": indices }] }]);
        assert_eq!(doc.load().meshes[0].closed, closed);
    }
}
