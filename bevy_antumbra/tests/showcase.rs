//! The showcase without a window: renders the README's image.

mod common;
#[path = "../examples/showcase/scene.rs"]
#[allow(dead_code)]
mod scene;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy_antumbra::{ShadowTechnique, SoftShadows};
use common::Headless;

#[test]
fn the_showcase_has_shadows_of_four_lights() {
    let mut headless = Headless::new(UVec2::new(640, 360), SoftShadows::by(ShadowTechnique::MultiLayer));
    headless.app.add_systems(Startup, scene::spawn);
    let camera = antumbra_scene::Camera {
        eye: glam::Vec3::ZERO,
        target: -glam::Vec3::Z,
        up: glam::Vec3::Y,
        fov_y_rad: 0.8,
        near_m: 0.1,
        far_m: 100.0,
        shadow_distance: None,
    };
    let camera = headless.camera(&camera);
    let camera = headless.app.world_mut().spawn(camera).id();
    let place = (scene::camera(), Msaa::Sample4, Tonemapping::AcesFitted);
    headless.app.world_mut().entity_mut(camera).insert(place);
    let picture = headless.picture(8);
    let counts = headless.app.world().resource::<bevy_antumbra::ShadowCounts>().get();
    assert_eq!((counts.lights, counts.casters), (4, 24));
    picture.save("showcase", 1.0);
}
