use antumbra_scene::{Image, Instance, Mesh, Wrap};
use glam::{Vec2, Vec4};

use super::*;
use crate::test_support::{gpu_or_skip, quad};

fn scene(mesh: Mesh, material: Material) -> Scene {
    let instance = Instance { mesh: 0, world_from_object: Mat4::from_translation(Vec3::Y) };
    Scene { meshes: vec![mesh], materials: vec![material], instances: vec![instance], ..Scene::default() }
}

fn masked(cutoff: f32) -> Material {
    Material { alpha: AlphaMode::Mask { cutoff }, ..Material::default() }
}

#[test]
fn casters_follow_the_occluder() {
    let Some(gpu) = gpu_or_skip() else { return };
    let caster_count = |mesh: &Mesh, material: Material| {
        let scene = GpuScene::upload(gpu, &scene(mesh.clone(), material));
        let kinds = scene.casters().iter().map(|caster| format!("{:?}", caster.opacity)).collect::<String>();
        (scene.casters().len(), kinds)
    };
    let plain = quad(1.0);
    assert_eq!(caster_count(&plain, Material::default()), (1, "Opaque".into()));
    assert_eq!(caster_count(&plain, masked(0.5)), (1, "Opaque".into()));
    let faint = Material { base_color: Vec4::new(1.0, 1.0, 1.0, 0.4), ..masked(0.5) };
    assert_eq!(caster_count(&plain, faint).0, 0);
    let faded = Mesh { colors: [0.0, 0.0, 1.0, 1.0].map(|a| Vec4::new(1.0, 1.0, 1.0, a)).to_vec(), ..plain.clone() };
    assert!(caster_count(&faded, masked(0.5)).1.starts_with("Masked"));
}

#[test]
fn translucent_surfaces_are_as_their_material_says() {
    let Some(gpu) = gpu_or_skip() else { return };
    let of = |mesh: Mesh, material: Material, images: Vec<Image>| {
        let scene = Scene { images, ..scene(mesh, material) };
        let uploaded = GpuScene::upload(gpu, &scene);
        let opacity = uploaded.casters()[0].opacity;
        let (is_textured, channels) = match opacity {
            Opacity::Translucent { texture, .. } => (texture.is_some(), if opacity.tints() { 3 } else { 1 }),
            _ => (false, 1),
        };
        let kind = match opacity {
            Opacity::Opaque => None,
            Opacity::Translucent { coverage, transmitted, .. } => Some((coverage, transmitted)),
            Opacity::Masked { .. } => panic!("masked"),
        };
        (kind, is_textured, channels, uploaded.has_translucent_surfaces())
    };
    let blend = |alpha| Material {
        alpha: AlphaMode::Blend,
        base_color: Vec4::new(1.0, 0.5, 0.0, alpha),
        ..Material::default()
    };
    let plain = || quad(1.0);
    assert_eq!(of(plain(), blend(1.0), Vec::new()), (None, false, 1, false));
    let half = SurfaceCoverage::Alpha(0.5);
    assert_eq!(of(plain(), blend(0.5), Vec::new()), (Some((half, Vec3::ZERO)), false, 1, true));
    // Alpha that varies from vertex to vertex is kept.
    let faded = Mesh { colors: [0.0, 0.0, 1.0, 1.0].map(|a| Vec4::new(1.0, 1.0, 1.0, a)).to_vec(), ..plain() };
    assert_eq!(of(faded, blend(0.5), Vec::new()), (Some((half, Vec3::ZERO)), true, 1, true));
    let glass = Material { transmission: 0.5, ..blend(0.5) };
    assert_eq!(of(plain(), glass.clone(), Vec::new()), (Some((half, Vec3::new(0.5, 0.25, 0.0))), false, 3, true));
    let whole = Material { alpha: AlphaMode::Opaque, metallic: 0.5, ..glass.clone() };
    let transmitted = Vec3::new(0.25, 0.125, 0.0);
    assert_eq!(of(plain(), whole.clone(), Vec::new()), (Some((SurfaceCoverage::Whole, transmitted)), false, 3, true));
    assert_eq!(of(plain(), Material { metallic: 1.0, ..whole }, Vec::new()), (None, false, 1, false));
    let masked = Material { alpha: AlphaMode::Mask { cutoff: 0.25 }, ..glass };
    let cutoff = SurfaceCoverage::Cutoff { alpha_factor: 0.5, cutoff: 0.25 };
    assert_eq!(of(plain(), masked.clone(), Vec::new()), (Some((cutoff, Vec3::new(0.5, 0.25, 0.0))), false, 3, true));
    // A material with an image of its own has a texture; a mesh without coordinates has none.
    let image = Image { width: 1, height: 1, rgba8: vec![[128; 4]], wrap: [Wrap::Clamp; 2] };
    let textured = Material { transmission_image: Some(0), ..masked };
    let mapped = Mesh { uvs: vec![Vec2::ZERO; 4], ..plain() };
    assert!(of(mapped, textured.clone(), vec![image.clone()]).1);
    let unmapped = Mesh { uvs: Vec::new(), ..plain() };
    assert!(!of(unmapped, textured, vec![image]).1);
}

#[test]
fn empty_scenes_have_no_casters() {
    let Some(gpu) = gpu_or_skip() else { return };
    let empty = GpuScene::upload(gpu, &scene(Mesh::default(), Material::default()));
    assert!(empty.casters().is_empty() && empty.bounds.is_empty());
    assert!(GpuScene::upload(gpu, &Scene::default()).casters().is_empty());
}

#[test]
fn bounds_are_the_instances() {
    let Some(gpu) = gpu_or_skip() else { return };
    let mut scene = scene(Mesh { closed: true, ..quad(1.0) }, Material::default());
    let mirror = Mat4::from_scale_rotation_translation(Vec3::new(-1.0, 1.0, 1.0), Default::default(), Vec3::X * 5.0);
    scene.instances.push(Instance { mesh: 0, world_from_object: mirror });
    let uploaded = GpuScene::upload(gpu, &scene);
    assert_eq!(uploaded.bounds, scene.bounds());
    let closed: Vec<_> = uploaded.casters().iter().map(|caster| caster.closed).collect();
    assert_eq!(closed, [true, false], "mirrored instances wind the other way");
}

#[test]
fn what_is_moved_takes_its_bounds_along_and_comes_back() {
    let Some(gpu) = gpu_or_skip() else { return };
    let mut scene = scene(quad(1.0), Material::default());
    scene.instances.push(Instance { mesh: 0, world_from_object: Mat4::from_translation(Vec3::X * 5.0) });
    let mut uploaded = GpuScene::upload(gpu, &scene);
    let at_rest = uploaded.bounds;
    uploaded.offset_instances(gpu, &[1], Vec3::X * 2.0);
    scene.instances[1].world_from_object = Mat4::from_translation(Vec3::X * 7.0);
    assert_eq!(uploaded.bounds, scene.bounds());
    assert_eq!(uploaded.casters()[0].bounds, scene.bounds());
    uploaded.offset_instances(gpu, &[1], Vec3::ZERO);
    assert_eq!(uploaded.bounds, at_rest);
}
