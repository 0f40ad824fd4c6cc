//! Shadow of a spot light in Bevy's image.

mod common;

use antumbra::light::{Cone, Light, LightShape};
use bevy::prelude::*;
use bevy_antumbra::{Patch, SoftShadows};
use common::{Headless, light_transform, spawn_scene};

#[test]
fn a_spot_light_casts_a_shadow() {
    let scene = antumbra_scene::builtin::build("overlap").expect("a built-in scene");
    let camera = scene.cameras[0];
    let mut headless = Headless::new(UVec2::splat(256), SoftShadows::default());
    spawn_scene(&mut headless.app, &scene);
    let cone = Cone { inner_rad: 0.55, outer_rad: 0.6 };
    let shape = LightShape::Disk { radius_m: 0.3 };
    let light = Light {
        cone: Some(cone),
        ..Light::new(shape, glam::Vec3::new(-2.2, 7.0, -1.8), glam::Vec3::new(0.5, 0.4, 0.2))
    };
    let camera = headless.camera(&camera);
    let world = headless.app.world_mut();
    world.spawn(camera);
    let spot = SpotLight {
        intensity: 4e6,
        radius: 0.3,
        inner_angle: cone.inner_rad,
        outer_angle: cone.outer_rad,
        shadow_maps_enabled: true,
        range: 30.0,
        ..default()
    };
    let light = world.spawn((spot, light_transform(&light))).id();
    let shadowed = headless.picture(6);
    assert_eq!(headless.app.world().get_resource::<Patch>(), Some(&Patch::Applied));
    if let Some(mut spot) = headless.app.world_mut().get_mut::<SpotLight>(light) {
        spot.shadow_maps_enabled = false;
    }
    let lit = headless.picture(4);
    let most = lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    shadowed.save("spot_shadowed", 1.0 / most);
    lit.save("spot_lit", 1.0 / most);
    let visibility: Vec<f32> = shadowed.over(&lit).into_iter().flatten().map(|v| v[0]).collect();
    let share = |is: fn(&f32) -> bool| visibility.iter().filter(|v| is(v)).count() as f32 / visibility.len() as f32;
    let (umbra, penumbra, in_light) =
        (share(|v| *v < 0.01), share(|v| (0.01..0.99).contains(v)), share(|v| *v >= 0.99));
    println!("most {most}, umbra {umbra:.3}, penumbra {penumbra:.3}, lit {in_light:.3}");
    assert!(umbra > 0.02 && penumbra > 0.02 && in_light > 0.2);
}
