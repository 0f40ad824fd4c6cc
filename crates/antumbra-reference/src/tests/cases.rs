//! Small inputs derived from public reports, each with the right result: a card 1 m up and a light above it.

use antumbra_scene::{AlphaMode, LoadOptions, Setup, load};
use glam::Vec3;

use super::*;

/// Visibility at a point of the floor.
fn at(folder: &std::path::Path, case: &str, setup: &str, point: Vec3) -> Vec3 {
    let scene = load(&folder.join(format!("{case}.glb")).display().to_string(), &LoadOptions::default()).unwrap();
    assert!(scene.warnings.is_empty(), "{case}: {:?}", scene.warnings);
    let light = &Setup::from_file(&folder.join(setup)).unwrap().lights[0];
    let points = [ReceiverPoint::new(point, Vec3::Y)];
    let tracer = Tracer::new(&scene).unwrap();
    let image = tracer.visibility_at(&points, light, &VisibilityOptions::default(), &|_| {}, &never()).unwrap();
    Vec3::from(image.values[0])
}

#[test]
fn cards_let_through_what_they_should() {
    let Some(folder) = antumbra_testing::cases_folder() else { return };
    let middle = Vec3::new(0.03, 0.0, 0.01);
    for (case, want, slack) in [
        ("blend_a1_1", Vec3::ZERO, 0.0),
        ("blend_0.5", Vec3::splat(0.5), 1e-5),
        ("node_visibility_used", Vec3::ONE, 0.0),
        ("node_visibility_required", Vec3::ONE, 0.0),
        ("transmission_metal_1.0", Vec3::ZERO, 0.0),
        ("transmissionTexture_at_0", Vec3::ZERO, 0.0),
        ("volume_red_10cm", Vec3::new(1.0, 0.1, 0.1), 1e-4),
        // The card lies within the hole of its image.
        ("webp_used_no_fallback", Vec3::ONE, 0.0),
        ("webp_required", Vec3::ONE, 0.0),
    ] {
        let v = at(&folder, case, "card.toml", middle);
        assert!(v.abs_diff_eq(want, slack), "{case}: {v} where {want} is right");
    }
}

#[test]
fn blended_cubes_cast_as_their_opaque_twins() {
    let Some(folder) = antumbra_testing::cases_folder() else { return };
    let blended = load(&folder.join("blend_cubes.glb").display().to_string(), &LoadOptions::default()).unwrap();
    let setup = Setup::from_file(&folder.join("blend_cubes.toml")).unwrap();
    let mut opaque = blended.clone();
    opaque
        .materials
        .iter_mut()
        .filter(|material| material.base_color.w == 1.0)
        .for_each(|m| m.alpha = AlphaMode::Opaque);
    let seen = |scene: &Scene| {
        let tracer = Tracer::new(scene).unwrap();
        let receivers = tracer.primary(&setup.camera, UVec2::new(64, 36));
        visibility(&tracer, &receivers, &setup.lights[0], &VisibilityOptions::default())
    };
    let [blended, opaque] = [blended, opaque].map(|scene| seen(&scene));
    assert_eq!((blended.channels, opaque.channels), (1, 1));
    assert!(blended.values == opaque.values);
    let behind = at(&folder, "blend_cubes", "blend_cubes.toml", Vec3::new(2.55, 0.0, -0.55));
    assert!(behind.abs_diff_eq(Vec3::splat(0.25), 1e-5), "two faces of the cube that covers half: {behind}");
}
