//! Cost of shadows, compared with Bevy's own. Run it with `cargo test --release --test cost -- --ignored --nocapture`.

mod common;

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::Setup;
use bevy::light::{DirectionalLightShadowMap, PointLightShadowMap, ShadowFilteringMethod};
use bevy::prelude::*;
use bevy_antumbra::{AntumbraPlugin, ShadowCounts, ShadowQuality, ShadowTechnique, SoftShadows};
use common::{Headless, set_shadows, spawn_light, spawn_scene};

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

/// Processor time of the render world's own work for shadows: 500 moving casters under eight moving lights.
#[test]
#[ignore = "a measurement"]
fn processor_time_of_500_casters_under_8_lights() {
    let mut headless = Headless::new(UVec2::splat(64), SoftShadows::default().at(ShadowQuality::Fast));
    let setup =
        Setup::from_toml(include_str!("data/lights.toml"), std::path::Path::new("lights.toml")).expect("a setup");
    let camera = headless.camera(&setup.camera);
    let world = headless.app.world_mut();
    world.spawn((camera, Msaa::Off));
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::default());
    let ground = world.resource_mut::<Assets<Mesh>>().add(Plane3d::default().mesh().size(20.0, 20.0));
    world.spawn((Mesh3d(ground), MeshMaterial3d(material.clone())));
    let mut moving = Vec::new();
    for i in 0..500 {
        // Each caster has its own mesh.
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(0.1 + 0.0002 * i as f32));
        let at =
            Transform::from_xyz(0.4 * (i % 25) as f32 - 5.0, 0.5 + 0.1 * (i % 7) as f32, 0.4 * (i / 25) as f32 - 4.0);
        moving.push(world.spawn((Mesh3d(mesh), MeshMaterial3d(material.clone()), at)).id());
    }
    for light in setup.lights.iter().chain(&setup.lights) {
        moving.push(spawn_light(&mut headless.app, light));
    }
    let mut times = Vec::new();
    let mut made = 0;
    for frame in 0..30 {
        let mut transforms = headless.app.world_mut().query::<&mut Transform>();
        for entity in &moving {
            if let Ok(mut transform) = transforms.get_mut(headless.app.world_mut(), *entity) {
                transform.translation.y += 0.01 * (frame as f32).sin();
            }
        }
        headless.run(1);
        let counts = headless.app.world().resource::<ShadowCounts>().get();
        if frame == 14 {
            made = counts.objects_created;
        }
        if frame > 14 {
            times.push(counts.processor_time);
            assert_eq!((counts.lights, counts.casters, counts.objects_created), (8, 501, made));
        }
    }
    println!(
        "500 casters, 8 lights: {:.2?} of the processor a frame (median of {})",
        median(times.clone()),
        times.len()
    );
}

/// Error and time of Bevy's own shadows, with the filter and map size that it documents as its best, and of the plugin's.
#[test]
#[ignore = "a measurement"]
fn error_and_time_beside_bevys_own() {
    let scene = antumbra_scene::builtin::build("overlap").expect("a built-in scene");
    let setup =
        Setup::from_toml(include_str!("data/lights.toml"), std::path::Path::new("lights.toml")).expect("a setup");
    let size_px = UVec2::splat(256);
    let tracer = Tracer::new(&scene).expect("a scene that can be traced");
    let receivers = tracer.primary(&setup.camera, glam::UVec2::new(size_px.x, size_px.y));
    let by_bevy = [ShadowFilteringMethod::Hardware2x2, ShadowFilteringMethod::Gaussian];
    let by_plugin = [
        SoftShadows::default().at(ShadowQuality::Fast),
        SoftShadows::default(),
        SoftShadows::by(ShadowTechnique::MultiLayer),
        SoftShadows::by(ShadowTechnique::SampleBased),
    ];
    for light in setup.lights.iter().filter(|light| light.name != "rectangle") {
        let (options, cancel) = (VisibilityOptions::default(), AtomicBool::new(false));
        let truth =
            tracer.visibility(&receivers, light, &options, &|_| {}, &cancel).expect("a light that can be traced");
        let measure = |name: String, headless: &mut Headless, entity: Entity| {
            let shadowed = headless.picture(8);
            let times = (0..15).map(|_| {
                let began = Instant::now();
                headless.run(1);
                headless.wait();
                began.elapsed()
            });
            let time = median(times.collect());
            set_shadows(&mut headless.app, entity, false);
            let lit = headless.picture(4);
            let (mut sum, mut judged) = (0.0, 0);
            for (i, (had, truth_here)) in shadowed.over(&lit).into_iter().zip(&truth.values).enumerate() {
                let Some(had) = had.filter(|_| truth.faces_light_center[i]) else { continue };
                sum += f64::from(had[0] - truth_here[0]).powi(2);
                judged += 1;
            }
            println!("{} {name}: rmse {:.4}, {time:.1?} a frame", light.name, (sum / judged as f64).sqrt());
        };
        // Bevy's own soft shadows are an optional feature of Bevy.
        let softness: &[bool] = if cfg!(feature = "bevy_pcss") { &[false, true] } else { &[false] };
        for (method, is_soft) in by_bevy.into_iter().flat_map(|method| softness.iter().map(move |soft| (method, *soft)))
        {
            let mut headless = Headless::bare(size_px);
            headless.finish();
            headless.app.insert_resource(DirectionalLightShadowMap { size: 4096 });
            headless.app.insert_resource(PointLightShadowMap { size: 2048 });
            spawn_scene(&mut headless.app, &scene);
            let camera = headless.camera(&setup.camera);
            headless.app.world_mut().spawn((camera, Msaa::Off, method));
            let entity = spawn_light(&mut headless.app, light);
            if is_soft {
                be_soft(&mut headless.app, entity, light);
            }
            let soft = if is_soft { ", soft" } else { "" };
            measure(format!("Bevy {method:?}{soft}"), &mut headless, entity);
        }
        for settings in &by_plugin {
            let mut headless = Headless::bare(size_px);
            headless.app.add_plugins(AntumbraPlugin { settings: settings.clone() });
            headless.finish();
            spawn_scene(&mut headless.app, &scene);
            let camera = headless.camera(&setup.camera);
            headless.app.world_mut().spawn((camera, Msaa::Off));
            let entity = spawn_light(&mut headless.app, light);
            measure(format!("{:?} {:?}", settings.technique, settings.quality), &mut headless, entity);
        }
    }
}

/// Enables Bevy's own percentage-closer soft shadows.
#[cfg(feature = "bevy_pcss")]
fn be_soft(app: &mut App, entity: Entity, light: &antumbra::light::Light) {
    let mut entity = app.world_mut().entity_mut(entity);
    if let Some(mut of) = entity.get_mut::<PointLight>() {
        of.soft_shadows_enabled = true;
    } else if let Some(mut of) = entity.get_mut::<SpotLight>() {
        of.soft_shadows_enabled = true;
    } else if let Some(mut of) = entity.get_mut::<DirectionalLight>() {
        // In Bevy's own unit; its example starts with ten.
        of.soft_shadow_size = Some(10.0 * light.bounding_radius() / 0.0175);
    }
}

#[cfg(not(feature = "bevy_pcss"))]
fn be_soft(_: &mut App, _: Entity, _: &antumbra::light::Light) {}
