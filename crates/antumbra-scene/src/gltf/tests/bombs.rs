//! Small files that request huge resources are refused or loaded at once, never slowly.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::features::Doc;

/// Time limit: a refusal reads a few megabytes at most, also on a busy machine.
const AT_ONCE: Duration = Duration::from_secs(5);

fn refused(doc: &Doc, want: &str) {
    let begin = Instant::now();
    let error = doc.load_at(0.0).unwrap_err();
    assert!(error.contains(want), "{error} lacks {want}");
    assert!(begin.elapsed() < AT_ONCE, "{want}: {:?}", begin.elapsed());
}

fn loads(doc: &Doc) {
    let begin = Instant::now();
    doc.load_at(0.0).unwrap();
    assert!(begin.elapsed() < AT_ONCE, "{:?}", begin.elapsed());
}

fn with_accessor(accessor: Value) -> Doc {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.triangle(json!({}));
    let huge = doc.push("accessors", accessor);
    doc.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = huge.into();
    doc
}

#[test]
fn accessors_without_data() {
    let of = |count: u64| with_accessor(json!({ "componentType": 5126, "type": "VEC3", "count": count }));
    refused(&of(1 << 40), "exceeds the limit");
    refused(&of(u64::MAX), "exceeds the limit");
    loads(&of(300));
}

#[test]
fn a_million_uses_of_one_accessor() {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    let many = doc.floats("VEC3", &[0.5; 30_000]);
    let primitive = json!({ "attributes": { "POSITION": many } });
    doc.json["meshes"] = json!([{ "primitives": vec![primitive; 5_000] }]);
    refused(&doc, "vertices");

    // Attributes that are read and discarded count too.
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.triangle(json!({}));
    let times: Vec<f32> = (0..10_000).map(|k| k as f32).collect();
    let input = doc.floats("SCALAR", &times);
    let output = doc.floats("VEC3", &[0.0; 30_000]);
    let sampler = json!({ "input": input, "output": output });
    let channel = |k: usize| json!({ "sampler": k, "target": { "node": 0, "path": "translation" } });
    let clip = json!({ "samplers": [sampler], "channels": [channel(0)] });
    doc.json["animations"] = json!(vec![clip; 20_000]);
    loads(&doc);
}

#[test]
fn copies_of_copies() {
    let mut doc = Doc::new(json!(vec![json!({ "mesh": 0 }); 2_000]));
    doc.triangle(json!({}));
    let translations = doc.push("accessors", json!({ "componentType": 5126, "type": "VEC3", "count": 60 }));
    for node in doc.json["nodes"].as_array_mut().unwrap() {
        node["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translations } } });
    }
    refused(&doc, "exceeds the limit");
}

#[test]
fn many_nodes_with_one_large_skin() {
    let mut nodes = vec![json!({ "mesh": 0, "skin": 0 }); 3_000];
    nodes.extend(vec![json!({}); 10_000]);
    let mut doc = Doc::new(json!(nodes));
    let joints = doc.accessor(&[0; 12], 5121, "VEC4", 3, json!({}));
    let weights = doc.floats("VEC4", &[1.0; 12]);
    doc.triangle(json!({ "attributes": { "JOINTS_0": joints, "WEIGHTS_0": weights } }));
    doc.json["skins"] = json!([{ "joints": (3_000..13_000).collect::<Vec<u32>>() }]);
    loads(&doc);
}

#[test]
fn compressed_views_that_unfold() {
    let mut doc = with_accessor(json!({ "bufferView": 1, "componentType": 5126, "type": "VEC3", "count": 3 }));
    let count = 1u64 << 33;
    doc.push(
        "bufferViews",
        json!({ "buffer": 0, "byteLength": 12 * count, "extensions": { "EXT_meshopt_compression": {
            "buffer": 0, "byteLength": 36, "byteStride": 12, "count": count, "mode": "ATTRIBUTES",
        } } }),
    );
    refused(&doc, "decoded buffer views");
}

#[test]
fn deep_and_wide_graphs() {
    let chain: Vec<Value> =
        (1..=100_000u32).map(|k| json!({ "children": [k] })).chain([json!({ "mesh": 0 })]).collect();
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    doc.json["nodes"] = json!(chain);
    doc.triangle(json!({}));
    loads(&doc);

    let lights = json!({ "KHR_lights_punctual": { "light": 0 } });
    let mut doc = Doc::new(json!(vec![json!({ "extensions": lights }); 2_000]));
    let long = vec![0.5; 10_000];
    let emission = json!({ "width": 100, "height": 100, "luminance": long });
    doc.json["extensions"] = json!({ "KHR_lights_punctual": {
        "lights": [{ "type": "spot", "extras": { "size": [1, 1], "emission": emission } }] } });
    loads(&doc);
}
