//! Shadows in Bevy's image, compared with traced rays: visibility of each of Bevy's lights at each pixel.

mod common;

use std::sync::atomic::AtomicBool;

use antumbra_reference::{Tracer, VisibilityImage, VisibilityOptions};
use antumbra_scene::Setup;
use bevy::prelude::*;
use bevy_antumbra::{ShadowTechnique, SoftShadows};
use common::{Headless, Picture, set_shadows, spawn_light, spawn_scene};

const LIGHTS: &str = include_str!("data/lights.toml");
const SIZE_PX: UVec2 = UVec2::splat(256);
/// Maximum difference from the laboratory's error for the same technique, scene, light and size.
const NEAR: f64 = 0.005;

/// Renders a light without shadows and with each technique, switched at run time. Compares the ratios with traced rays, and the
/// errors with those of the laboratory; `lights.toml` contains its command.
fn holds(light: &str, of_laboratory: &[(ShadowTechnique, f64)]) {
    let scene = antumbra_scene::builtin::build("overlap").expect("a built-in scene");
    let setup = Setup::from_toml(LIGHTS, std::path::Path::new("lights.toml")).expect("a setup");
    let light = setup.lights.iter().find(|of| of.name == light).expect("a light of this name").clone();

    let tracer = Tracer::new(&scene).expect("a scene that can be traced");
    let receivers = tracer.primary(&setup.camera, glam::UVec2::new(SIZE_PX.x, SIZE_PX.y));
    let (options, cancel) = (VisibilityOptions::default(), AtomicBool::new(false));
    let truth = tracer.visibility(&receivers, &light, &options, &|_| {}, &cancel).expect("a light that can be traced");

    let mut headless = Headless::new(SIZE_PX, SoftShadows::default());
    spawn_scene(&mut headless.app, &scene);
    let camera = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((camera, Msaa::Off));
    let entity = spawn_light(&mut headless.app, &light);
    set_shadows(&mut headless.app, entity, false);
    let lit = headless.picture(6);
    set_shadows(&mut headless.app, entity, true);
    for (technique, of_laboratory) in of_laboratory {
        headless.app.world_mut().entity_mut(entity).insert(SoftShadows::by(*technique));
        let shadowed = headless.picture(5);
        let name = format!("{}_{}", light.name, technique.kind());
        let (rmse, judged) = error_of(&shadowed, &lit, &truth, &name);
        println!("{name}: rmse {rmse:.4} over {judged} pixels, the laboratory's {of_laboratory:.4}");
        assert!(judged > 10_000, "{judged} pixels are too few to judge by");
        assert!((rmse - of_laboratory).abs() < NEAR, "{name}: rmse {rmse:.4}, the laboratory's is {of_laboratory:.4}");
    }
}

/// Returns the root mean square error over the judged pixels, those that face the light and that it reaches, and their number.
fn error_of(shadowed: &Picture, lit: &Picture, truth: &VisibilityImage, name: &str) -> (f64, usize) {
    let most = lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    shadowed.save(name, 1.0 / most);
    let mut errors = Picture { size_px: SIZE_PX, pixels: vec![[0.0; 3]; lit.pixels.len()] };
    let (mut sum, mut judged) = (0.0, 0);
    for (i, (had, truth_here)) in shadowed.over(lit).into_iter().zip(&truth.values).enumerate() {
        let Some(had) = had.filter(|_| truth.faces_light_center[i]) else { continue };
        let difference = had[0] - truth_here[0];
        errors.pixels[i] = [difference.max(0.0), (-difference).max(0.0), 0.0];
        sum += f64::from(difference).powi(2);
        judged += 1;
    }
    errors.save(&format!("{name}_error"), 1.0);
    ((sum / judged as f64).sqrt(), judged)
}

use ShadowTechnique::{Essm, MultiLayer, Pcss, SampleBased};

#[test]
fn a_rectangle_is_as_in_the_laboratory() {
    holds("rectangle", &[(Pcss, 0.0614), (Essm, 0.0543), (MultiLayer, 0.0079), (SampleBased, 0.0038)]);
}

#[test]
fn a_spot_is_as_in_the_laboratory() {
    holds("spot", &[(Pcss, 0.0378), (Essm, 0.0375), (MultiLayer, 0.0133), (SampleBased, 0.0028)]);
}

#[test]
fn a_point_is_as_in_the_laboratory() {
    holds("point", &[(Pcss, 0.0094), (Essm, 0.0198), (MultiLayer, 0.0190), (SampleBased, 0.0009)]);
}

#[test]
fn a_sun_is_as_in_the_laboratory() {
    holds("sun", &[(Pcss, 0.0172), (Essm, 0.0182), (MultiLayer, 0.0163), (SampleBased, 0.0023)]);
}
