//! Surfaces and their effect on light: transmission, volumes, WebP images, hidden nodes.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use super::features::Doc;
use crate::translucency::tests::passes;
use crate::{AlphaMode, Coverage, Occluder};

/// Lossless image of one row.
fn picture(format: image::ImageFormat, texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let rgba = image::RgbaImage::from_raw(texels.len() as u32, 1, texels.as_flattened().to_vec()).unwrap();
    rgba.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Triangle with one material, texture coordinates along u, and one texture for each image of one row.
fn textured(material: Value, pictures: &[&[[u8; 4]]]) -> Doc {
    let mut doc = Doc::new(json!([{ "mesh": 0 }]));
    let uv = doc.floats("VEC2", &[0.0, 0.5, 1.0, 0.5, 0.5, 0.5]);
    doc.triangle(json!({ "attributes": { "TEXCOORD_0": uv }, "material": 0 }));
    doc.json["materials"] = json!([material]);
    doc.json["images"] = json!([]);
    doc.json["textures"] = json!([]);
    for texels in pictures {
        let view = doc.view(&picture(image::ImageFormat::Png, texels), json!({}));
        let image = doc.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        doc.push("textures", json!({ "source": image }));
    }
    doc
}

fn close(a: Vec3, b: Vec3) {
    assert!(a.abs_diff_eq(b, 4e-3), "{a} {b}");
}

const WHITE: [u8; 4] = [255; 4];
const BLACK: [u8; 4] = [0, 0, 0, 255];

#[test]
fn blended_surfaces_cover_by_alpha_and_vertex_alpha() {
    let mut doc =
        textured(json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 0.5] } }), &[]);
    let colors = doc.floats("VEC4", &[1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(passes(&doc.load(), 0, 1), Vec3::splat(0.5));
    doc.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
    let scene = doc.load();
    assert_eq!((scene.occluders(), scene.meshes[0].colors[0].w), (vec![Occluder::Translucent], 0.5));
    assert_eq!(scene.translucency(&scene.meshes[0]).coverage, Coverage::Alpha);
}

#[test]
fn metals_transmit_nothing_and_metalness_is_1_where_none_is_given() {
    let glass = |pbr: Value| {
        let transmission = json!({ "KHR_materials_transmission": { "transmissionFactor": 1 } });
        textured(json!({ "pbrMetallicRoughness": pbr, "extensions": transmission }), &[]).load()
    };
    assert_eq!(glass(json!({})).occluders(), [Occluder::Opaque]);
    assert_eq!(glass(json!({ "metallicFactor": 1 })).occluders(), [Occluder::Opaque]);
    let half = glass(json!({ "metallicFactor": 0.5, "baseColorFactor": [1, 0.5, 0, 1] }));
    assert_eq!(passes(&half, 0, 1), Vec3::new(0.5, 0.25, 0.0));
}

#[test]
fn transmission_and_metalness_are_read_texel_by_texel() {
    let material = json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1, "transmissionTexture": { "index": 2 } } },
    });
    let colors = [[255, 0, 0, 255], WHITE, WHITE, WHITE];
    let metals = [BLACK, BLACK, [0, 0, 255, 255], BLACK];
    let transmissions = [WHITE, [128, 0, 0, 0], WHITE, BLACK];
    let doc = textured(material, &[&colors, &metals, &transmissions]);
    let scene = doc.load();
    assert_eq!(scene.warnings, Vec::<String>::new());
    close(passes(&scene, 0, 4), Vec3::X);
    close(passes(&scene, 1, 4), Vec3::splat(128.0 / 255.0));
    close(passes(&scene, 2, 4), Vec3::ZERO);
    close(passes(&scene, 3, 4), Vec3::ZERO);
    assert!(scene.tints(&scene.meshes[0]));
}

#[test]
fn a_transmission_texture_alone_brings_its_coordinates() {
    let transformed = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "offset": [0.25, 0] } } });
    let extension = json!({ "transmissionFactor": 1, "transmissionTexture": transformed });
    let material = json!({
        "pbrMetallicRoughness": { "metallicFactor": 0 }, "extensions": { "KHR_materials_transmission": extension },
    });
    let scene = textured(material, &[&[BLACK, WHITE]]).load();
    assert_eq!(scene.meshes[0].uvs[0], Vec2::new(0.25, 0.5));
    close(passes(&scene, 0, 2), Vec3::ZERO);
    close(passes(&scene, 1, 2), Vec3::ONE);
}

#[test]
fn pictures_that_lie_otherwise_count_by_their_means() {
    let extension = json!({ "transmissionFactor": 1, "transmissionTexture": { "index": 1, "texCoord": 1 } });
    let material = json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 },
        "extensions": { "KHR_materials_transmission": extension },
    });
    let scene = textured(material, &[&[WHITE], &[[51, 0, 0, 255], [153, 0, 0, 255]]]).load();
    close(passes(&scene, 0, 1), Vec3::splat(0.4));
    assert_eq!(
        scene.warnings,
        [
            "materials[0]: its transmission has different texture coordinates or a different sampler than its base colour; the mean is used"
        ]
    );
}

fn absorbing(volume: Value) -> Value {
    json!({
        "pbrMetallicRoughness": { "metallicFactor": 0 },
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_volume": volume },
    })
}

#[test]
fn volumes_absorb_over_their_thickness_in_the_world() {
    let volume = json!({ "thicknessFactor": 0.1, "attenuationDistance": 0.1, "attenuationColor": [1, 0.25, 0.0625] });
    let mut doc = textured(absorbing(volume), &[]);
    doc.json["extensionsRequired"] = json!(["KHR_materials_volume"]);
    close(passes(&doc.load(), 0, 1), Vec3::new(1.0, 0.25, 0.0625));
    // The node's scale applies to the thickness, and each scale gets its own copy.
    doc.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "scale": [2, 2, 2] }, { "mesh": 0, "scale": [2, 2, -2] }]);
    doc.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = doc.load();
    let thickness = |instance: usize| {
        let material = &scene.materials[scene.meshes[scene.instances[instance].mesh].material];
        material.volume.as_ref().unwrap().thickness_m
    };
    assert_eq!([0, 1, 2].map(thickness), [0.1, 0.2, 0.2]);
    assert_eq!(scene.materials.len(), 2);
}

#[test]
fn thickness_is_read_texel_by_texel() {
    let volume = json!({
        "thicknessFactor": 1, "thicknessTexture": { "index": 0 },
        "attenuationDistance": 1, "attenuationColor": [0.25, 1, 1],
    });
    let scene = textured(absorbing(volume), &[&[[9, 0, 9, 9], [9, 255, 9, 9]]]).load();
    close(passes(&scene, 0, 2), Vec3::ONE);
    close(passes(&scene, 1, 2), Vec3::new(0.25, 1.0, 1.0));
}

#[test]
fn volumes_that_absorb_nothing_are_none() {
    let volume = |volume: Value| textured(absorbing(volume), &[]).load();
    for nothing in [
        json!({}),
        json!({ "thicknessFactor": 1, "attenuationColor": [0, 0, 0] }),
        json!({ "attenuationDistance": 1, "attenuationColor": [0, 0, 0] }),
        json!({ "thicknessFactor": 1, "attenuationDistance": 1 }),
    ] {
        let scene = volume(nothing);
        assert!(scene.materials[0].volume.is_none() && scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
    let wrong = volume(json!({ "thicknessFactor": 1, "attenuationDistance": 0, "attenuationColor": [0, 0, 0] }));
    assert!(
        wrong.materials[0].volume.is_none() && wrong.warnings[0].contains("greater than 0"),
        "{:?}",
        wrong.warnings
    );
}

/// Alpha-tested triangle whose image is WebP, and PNG if `fallback` is given.
fn webp(webp: &[u8], fallback: Option<&[[u8; 4]]>) -> Doc {
    let mut doc = textured(
        json!({ "alphaMode": "MASK", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
        fallback.as_slice(),
    );
    let view = doc.view(webp, json!({}));
    let image = doc.push("images", json!({ "bufferView": view, "mimeType": "image/webp" }));
    if fallback.is_none() {
        doc.push("textures", json!({}));
    }
    doc.json["textures"][0]["extensions"] = json!({ "EXT_texture_webp": { "source": image } });
    doc.json["extensionsUsed"] = json!(["EXT_texture_webp"]);
    doc
}

#[test]
fn webp_pictures_come_before_their_fallbacks() {
    let texels = [[200, 100, 50, 255], [1, 2, 3, 0]];
    let bytes = picture(image::ImageFormat::WebP, &texels);
    for fallback in [None, Some(&[[7, 7, 7, 7]][..])] {
        let mut doc = webp(&bytes, fallback);
        for required in [false, true] {
            if required {
                doc.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
            }
            let scene = doc.load();
            let material = &scene.materials[0];
            assert_eq!(material.alpha, AlphaMode::Mask { cutoff: 0.5 });
            assert_eq!(scene.images[material.base_color_image.unwrap()].rgba8, texels);
            assert_eq!((scene.images.len(), scene.warnings.len()), (1, 0), "{:?}", scene.warnings);
        }
    }
}

#[test]
fn fallbacks_are_taken_where_webp_cannot_be_had() {
    let cut = &picture(image::ImageFormat::WebP, &[WHITE])[..20];
    let scene = webp(cut, Some(&[[7, 8, 9, 10]])).load();
    assert_eq!(scene.images[scene.materials[0].base_color_image.unwrap()].rgba8, [[7, 8, 9, 10]]);
    assert!(scene.warnings[0].ends_with("the texture's other image is used"), "{:?}", scene.warnings);
    let scene = webp(cut, None).load();
    assert!(scene.images.is_empty() && scene.warnings[0].ends_with("white is used instead"), "{:?}", scene.warnings);
    let mut missing = webp(cut, None);
    missing.json["textures"][0]["extensions"] = json!({ "EXT_texture_webp": { "source": 9 } });
    let why = missing.load_at(0.0).unwrap_err();
    assert!(why.contains("textures[0].EXT_texture_webp.source") && why.contains("images[9]"), "{why}");
}

#[test]
fn hidden_nodes_and_what_hangs_from_them_are_not_there_but_cameras_are() {
    let visible = |visible: bool| json!({ "KHR_node_visibility": { "visible": visible } });
    let lit = json!({ "KHR_lights_punctual": { "light": 0 } });
    let mut doc = Doc::new(json!([
        { "mesh": 0, "translation": [1, 0, 0], "extensions": visible(true) },
        { "mesh": 0, "translation": [2, 0, 0], "extensions": visible(false), "children": [2, 3, 4] },
        { "mesh": 0, "translation": [3, 0, 0], "extensions": visible(true) },
        { "extensions": lit },
        { "camera": 0 },
        { "mesh": 0, "translation": [6, 0, 0], "extensions": { "KHR_node_visibility": {} } },
        { "mesh": 0, "translation": [7, 0, 0], "extensions": { "KHR_node_visibility": { "visible": 0 } } },
    ]));
    doc.triangle(json!({}));
    doc.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.25 } }]);
    doc.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    for list in ["extensionsUsed", "extensionsRequired"] {
        doc.json[list] = json!(["KHR_node_visibility"]);
        let scene = doc.load();
        let places: Vec<f32> = scene.instances.iter().map(|i| i.world_from_object.w_axis.x).collect();
        assert_eq!((places, scene.lights.len(), scene.cameras.len()), (vec![1.0, 6.0, 7.0], 0, 1));
        assert_eq!(scene.warnings, ["nodes[6]: its `visible` is neither true nor false; true is used"]);
    }
}

#[test]
fn animation_pointers_are_said_to_be_unread() {
    let mut doc =
        Doc::new(json!([{ "mesh": 0, "extensions": { "KHR_node_visibility": { "visible": false } } }, { "mesh": 0 }]));
    doc.triangle(json!({}));
    let (times, values) = (doc.floats("SCALAR", &[0.0, 1.0]), doc.floats("SCALAR", &[0.0, 1.0]));
    let target = json!({ "path": "pointer", "extensions": {
        "KHR_animation_pointer": { "pointer": "/nodes/0/extensions/KHR_node_visibility/visible" } } });
    doc.json["animations"] = json!([{
        "samplers": [{ "input": times, "output": values }], "channels": [{ "sampler": 0, "target": target }],
    }]);
    doc.json["extensionsUsed"] = json!(["KHR_node_visibility", "KHR_animation_pointer"]);
    let scene = doc.load();
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(
        scene.warnings,
        ["KHR_animation_pointer is not supported; properties that it animates keep their values"]
    );
    doc.json["extensionsRequired"] = json!(["KHR_animation_pointer"]);
    let why = doc.load_at(0.0).unwrap_err();
    assert!(why.contains("requires \"KHR_animation_pointer\", which is not supported"), "{why}");
}
