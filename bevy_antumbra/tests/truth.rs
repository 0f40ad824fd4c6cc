//! Shadows in Bevy's picture against rays: how much of each light is left at each pixel, for each of Bevy's lights.

mod common;

use std::sync::atomic::AtomicBool;

use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::Setup;
use bevy::prelude::*;
use bevy_antumbra::{ShadowTechnique, SoftShadows};
use common::{Headless, Picture, set_shadows, spawn_light, spawn_scene};

const LIGHTS: &str = include_str!("data/lights.toml");
const SIZE_PX: UVec2 = UVec2::splat(256);

/// The root of the mean square of the differences over the pixels that are judged: those that face the light and that it
/// lights at all.
struct Error {
    rmse: f64,
    judged: usize,
}

/// Renders a light with and without shadows, and holds the quotient against rays.
fn error_of(light: &str, technique: ShadowTechnique) -> Error {
    let scene = antumbra_scene::builtin::build("overlap").expect("a built-in scene");
    let setup = Setup::from_toml(LIGHTS, std::path::Path::new("lights.toml")).expect("a setup");
    let camera = setup.camera.clone();
    let light = setup.lights.iter().find(|of| of.name == light).expect("a light of this name").clone();

    let mut headless = Headless::new(SIZE_PX, SoftShadows::by(technique));
    spawn_scene(&mut headless.app, &scene);
    let bundle = headless.camera(&camera);
    headless.app.world_mut().spawn(bundle);
    let entity = spawn_light(&mut headless.app, &light);
    let shadowed = headless.picture(6);
    set_shadows(&mut headless.app, entity, false);
    let lit = headless.picture(4);
    let most = lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    let name = format!("{}_{}", light.name, technique.kind());
    shadowed.save(&name, 1.0 / most);
    let had = shadowed.over(&lit);

    let tracer = Tracer::new(&scene).expect("a scene that can be traced");
    let size_px = glam::UVec2::new(SIZE_PX.x, SIZE_PX.y);
    let receivers = tracer.primary(&camera, size_px);
    let (options, cancel) = (VisibilityOptions { samples: 256, ..VisibilityOptions::default() }, AtomicBool::new(false));
    let truth = tracer.visibility(&receivers, &light, &options, &|_| {}, &cancel).expect("a light that can be traced");

    let (mut sum, mut judged) = (0.0, 0);
    let mut errors = Picture { size_px: SIZE_PX, pixels: vec![[0.0; 3]; had.len()] };
    for (i, (had, truth_here)) in had.iter().zip(&truth.values).enumerate() {
        let Some(had) = had.filter(|_| truth.faces_light_center[i]) else { continue };
        let difference = had[0] - truth_here[0];
        errors.pixels[i] = [difference.max(0.0), (-difference).max(0.0), 0.0];
        sum += f64::from(difference).powi(2);
        judged += 1;
    }
    errors.save(&format!("{name}_error"), 1.0);
    let rmse = (sum / judged as f64).sqrt();
    println!("{name}: rmse {rmse:.4} over {judged} pixels");
    Error { rmse, judged }
}

/// The laboratory's error of the same scene, light, technique and size; see `lights.toml`.
#[track_caller]
fn holds(light: &str, technique: ShadowTechnique, of_laboratory: f64) {
    let Error { rmse, judged } = error_of(light, technique);
    assert!(judged > 10_000, "{judged} pixels are too few to judge by");
    assert!((rmse - of_laboratory).abs() < 0.005, "{light}: rmse {rmse:.4}, the laboratory's is {of_laboratory:.4}");
}

#[test]
fn a_rectangle_is_as_in_the_laboratory() {
    holds("rectangle", ShadowTechnique::Pcss, 0.0);
    holds("rectangle", ShadowTechnique::MultiLayer, 0.0);
}

#[test]
fn a_spot_is_as_in_the_laboratory() {
    holds("spot", ShadowTechnique::Pcss, 0.0);
}

#[test]
fn a_point_is_as_in_the_laboratory() {
    holds("point", ShadowTechnique::Pcss, 0.0);
}

#[test]
fn a_sun_is_as_in_the_laboratory() {
    holds("sun", ShadowTechnique::Pcss, 0.0);
}
