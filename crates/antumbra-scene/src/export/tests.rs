//! Round trips through the export and the loader.

use antumbra_light::{Cone, EmissionTexture, Light, LightShape};
use glam::{Vec2, Vec3, Vec4};

use super::*;
use crate::{AlphaMode, Image, Instance, LoadOptions, Material, Volume, builtin, load_bytes};

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
            // Compared per triangle corner: vertices that no triangle uses are not loaded.
            let corners = a.indices.iter().map(|i| *i as usize).zip(b.indices.iter().map(|i| *i as usize));
            let (m, n) = (&scene.materials[a.material], &back.materials[b.material]);
            assert_eq!((&m.name, m.alpha, m.occluder()), (&n.name, n.alpha, n.occluder()));
            assert_eq!(m.roughness, n.roughness);
            // glTF cannot represent products above 1.
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
    scene.lights[0].emission = Some(EmissionTexture::from_rgb(2, 1, &[Vec3::splat(0.5), Vec3::new(3.0, 0.25, 1.0)]));
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
    assert!(images.iter().all(|image| image.is_some_and(|image| back.images[image].rgba8 == scene.images[0].rgba8)));
}

#[test]
fn the_export_is_valid_for_another_reader() {
    let scene = builtin::build("window").unwrap();
    let bytes = export_glb(&scene).unwrap();
    // The reader of the `gltf` crate validates the whole document; this crate's loader skips that validation.
    let parsed = gltf::Gltf::from_slice(&bytes).unwrap();
    assert_eq!(parsed.meshes().len(), scene.meshes.len());
    assert_eq!(load_bytes(&bytes, "w", &LoadOptions::default()).unwrap().triangle_count(), scene.triangle_count());
}
