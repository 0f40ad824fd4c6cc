//! Tests with a plate above a floor, whose penumbra is known, and with built-in scenes that each show one property.

use antumbra_light::{Light, LightShape};
use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::{Camera, Instance, LoadOptions, Material, Scene, Setup, load};
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::*;
use crate::test_support::{camera_at, quad};
use crate::truth::trace_light;

fn facts_of(scene: &Scene, camera: &Camera, light: &Light, size_px: UVec2) -> SceneFacts {
    let tracer = Tracer::new(scene).unwrap();
    let receivers = tracer.primary(camera, size_px);
    let options = VisibilityOptions { samples: 256, ..VisibilityOptions::default() };
    let truth = trace_light(&tracer, &receivers, light, &options, None, &|_| {}).unwrap();
    SceneFacts::measure(scene, &tracer, &receivers, camera, light, &truth).unwrap()
}

fn builtin(name: &str) -> SceneFacts {
    let scene = load(&format!("builtin:{name}"), &LoadOptions::default()).unwrap();
    let setup = Setup::for_scene(&scene);
    facts_of(&scene, &setup.camera, &setup.lights[0], UVec2::new(96, 54))
}

/// Returns a floor of 8 m with square plates above it, given by half side and height.
fn plates(plates: &[(f32, f32)]) -> Scene {
    let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
    for (half_side_m, height_m) in [(4.0, 0.0)].iter().chain(plates) {
        let mesh = scene.meshes.len();
        scene.meshes.push(quad(*half_side_m));
        scene.instances.push(Instance { mesh, world_from_object: Mat4::from_translation(Vec3::Y * *height_m) });
    }
    scene
}

/// Returns a square light of .4 m at a height of 10 m.
fn lamp() -> Light {
    Light::new(LightShape::Rectangle { size_m: Vec2::splat(0.4) }, Vec3::new(0.0, 10.0, 0.0), Vec3::ZERO)
}

/// Returns a camera at the side that sees the floor under the plate.
fn camera() -> Camera {
    camera_at(Vec3::new(0.0, 3.0, 7.0))
}

#[test]
fn a_plate_s_penumbra_is_as_wide_as_geometry_says() {
    let size_px = UVec2::new(160, 90);
    let facts = facts_of(&plates(&[(1.0, 2.0)]), &camera(), &lamp(), size_px);
    let penumbra = facts.penumbra.expect("a plate casts a penumbra");
    assert_eq!((penumbra.one_depth, penumbra.two_depths), (1.0, 0.0));
    // .4 m · 2 / 8 = .1 m; a pixel is 2 tan(.4) / 90 of the distance, and the shadow's edges are 6.3 to 8.8 m away.
    let pixels = |distance_m: f64| 0.1 / (2.0 * 0.4_f64.tan() / 90.0 * distance_m);
    assert!(
        (pixels(8.8)..pixels(6.2)).contains(&penumbra.width_px.median),
        "{} to {}: {:?}",
        pixels(8.8),
        pixels(6.2),
        penumbra.width_px
    );
    assert_eq!((penumbra.thin, penumbra.masked, penumbra.tinted), (0.0, 0.0, 0.0));
    let p = facts.picture;
    assert!((p.lit + p.penumbra + p.umbra + p.not_judged + p.background - 1.0).abs() < 1e-12);
    assert!(p.umbra > 0.0 && p.penumbra > 0.0 && p.lit > p.penumbra && p.background > 0.0);
    // The light's diagonal is .57 m, ten metres from the middle.
    let diameter = facts.light_diameter_deg.unwrap().median;
    assert!((2.5..3.3).contains(&diameter), "{diameter}");
    assert!(facts.off_axis_deg.unwrap().p90 < 32.0 && facts.grazing == Some(0.0));
}

#[test]
fn a_second_plate_is_a_second_depth() {
    // On the floor, the first plate's penumbra extends from 1.2 m to 1.3 m off the axis, the second's from .98 m to 1.47 m. Of the
    // penumbra that the first leaves, from 1.2 m on, some has both: a ninth as seen by the camera.
    let facts = facts_of(&plates(&[(1.0, 2.0), (0.55, 5.5)]), &camera(), &lamp(), UVec2::new(160, 90));
    let penumbra = facts.penumbra.unwrap();
    assert!(penumbra.two_depths > 0.08 && penumbra.more_depths == 0.0, "{penumbra:?}");
}

#[test]
fn a_wire_is_thin_and_a_board_is_not() {
    let bare = facts_of(&plates(&[]), &camera(), &lamp(), UVec2::new(64, 36));
    assert!(bare.penumbra.is_none() && bare.lines().iter().any(|line| line == "penumbra: none"));
    // A texel of a map over the floor's 8 m is 6 mm at the wire, which is 4 mm wide.
    let mut scene = plates(&[(1.0, 2.0)]);
    scene.instances[1].world_from_object *= Mat4::from_scale(Vec3::new(2e-3, 1.0, 1.0));
    let thin = facts_of(&scene, &camera_at(Vec3::new(4.0, 3.0, 6.0)), &lamp(), UVec2::new(160, 90));
    assert!(thin.penumbra.is_some_and(|penumbra| penumbra.thin > 0.9), "{thin:?}");
}

#[test]
fn built_in_scenes_are_what_they_are_built_for() {
    let layered = |facts: &SceneFacts| facts.penumbra.map_or(0.0, |p| p.two_depths + p.more_depths);
    let (plank, tree, glass, fence) =
        (builtin("leaning-plank"), builtin("tree"), builtin("stained-glass"), builtin("fence-alpha"));
    let overlap = builtin("overlap");
    assert!(layered(&overlap) > 0.02, "boards above a table: {overlap:?}");
    assert!(layered(&plank) < 0.1, "one plank: {plank:?}");
    assert!(layered(&tree) > 0.3, "leaves over leaves: {tree:?}");
    assert!(glass.penumbra.unwrap().tinted > 0.3 && glass.tinted_triangles > 0.0, "{glass:?}");
    assert!(fence.penumbra.unwrap().masked > 0.5 && fence.masked_triangles > 0.0, "{fence:?}");
    assert!(plank.masked_triangles == 0.0 && plank.tinted_triangles == 0.0);
    for facts in [plank, tree, glass, fence] {
        let words = facts.lines().join("\n");
        assert!(!words.contains("NaN") && words.contains("penumbra: ") && words.contains("light: "), "{words}");
    }
}
