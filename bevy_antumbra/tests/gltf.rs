//! glTF files as Bevy loads them, against rays through the same files: an animated skeleton, and leaves with holes.
//!
//! The files are those of the laboratory's tests: `ANTUMBRA_SCENES`, or `shared/scenes` beside or inside the repository.

mod common;

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use antumbra::light::{Light, LightShape};
use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::{Camera, LoadOptions};
use bevy::animation::graph::AnimationGraphHandle;
use bevy::animation::{AnimationPlayer, graph::AnimationGraph};
use bevy::prelude::*;
use bevy_antumbra::{ShadowTechnique, SoftShadows};
use common::{Headless, set_shadows, spawn_light};

fn folder() -> Option<PathBuf> {
    let repository = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let candidates = [
        std::env::var_os("ANTUMBRA_SCENES").map(PathBuf::from),
        Some(repository.join("../shared/scenes")),
        Some(repository.join("shared/scenes")),
    ];
    let found = candidates.into_iter().flatten().find(|folder| folder.join("README.md").is_file());
    if found.is_none() {
        println!("skipped: set ANTUMBRA_SCENES to the folder of test scenes");
    }
    found
}

/// Renders a file at a time of its first animation, if it has some, under a rectangle; gives the error against rays.
fn error_of(file: &str, size_px: UVec2, camera: &Camera, light: &Light, time_s: Option<f32>) -> Option<f64> {
    let folder = folder()?;
    let mut headless = Headless::reading(size_px, &folder);
    headless.app.add_plugins(bevy_antumbra::AntumbraPlugin { settings: SoftShadows::by(ShadowTechnique::SampleBased) });
    register_types(&mut headless.app);
    headless.finish();
    let assets = headless.app.world().resource::<AssetServer>().clone();
    // Held from the start: what is asked for later loads the file once more, and the scene with it.
    let clip = time_s.map(|_| assets.load(GltfAssetLabel::Animation(0).from_asset(file.to_owned())));
    let scene = WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(file.to_owned())));
    let root = headless.app.world_mut().spawn(scene).id();
    let bundle = headless.camera(camera);
    headless.app.world_mut().spawn((bundle, Msaa::Off));
    let rectangle = spawn_light(&mut headless.app, light);
    wait_for(&mut headless, |world| world.query::<&Mesh3d>().iter(world).next().is_some());
    if let Some((time_s, clip)) = time_s.zip(clip) {
        let (graph, index) = AnimationGraph::from_clip(clip);
        let world = headless.app.world_mut();
        let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
        let mut players = world.query::<(Entity, &mut AnimationPlayer)>();
        let players: Vec<Entity> = players
            .iter_mut(world)
            .map(|(entity, mut player)| {
                player.play(index).seek_to(time_s).pause();
                entity
            })
            .collect();
        assert!(!players.is_empty(), "{file} has an animation");
        for player in players {
            world.entity_mut(player).insert(AnimationGraphHandle(graph.clone()));
        }
    }
    let shadowed = headless.picture(20);
    set_shadows(&mut headless.app, rectangle, false);
    let lit = headless.picture(5);
    let most = lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    let name = file.trim_end_matches(".glb");
    shadowed.save(name, 1.0 / most);
    headless.app.world_mut().despawn(root);

    let options = LoadOptions { time_s: time_s.unwrap_or_default() };
    let scene = antumbra_scene::load(&folder.join(file).to_string_lossy(), &options).expect("a scene");
    let tracer = Tracer::new(&scene).expect("a scene that can be traced");
    let receivers = tracer.primary(camera, glam::UVec2::new(size_px.x, size_px.y));
    let (options, cancel) = (VisibilityOptions::default(), AtomicBool::new(false));
    let truth = tracer.visibility(&receivers, light, &options, &|_| {}, &cancel).expect("a light that can be traced");
    let mut errors = lit.clone();
    errors.pixels.fill([0.0; 3]);
    let (mut sum, mut judged) = (0.0, 0);
    for (i, (had, truth_here)) in shadowed.over(&lit).into_iter().zip(&truth.values).enumerate() {
        let Some(had) = had.filter(|_| truth.faces_light_center[i]) else { continue };
        let difference = had[0] - truth_here[0];
        errors.pixels[i] = [difference.max(0.0), (-difference).max(0.0), 0.0];
        sum += f64::from(difference).powi(2);
        judged += 1;
    }
    errors.save(&format!("{name}_error"), 1.0);
    let rmse = (sum / judged as f64).sqrt();
    println!("{name}: rmse {rmse:.4} over {judged} pixels");
    assert!(judged > 1000, "{judged} pixels are too few to judge by");
    Some(rmse)
}

/// What scenes are spawned with: features of Bevy's that do this by themselves build for long.
fn register_types(app: &mut App) {
    app.register_type::<Transform>()
        .register_type::<GlobalTransform>()
        .register_type::<bevy::transform::components::TransformTreeChanged>()
        .register_type::<Visibility>()
        .register_type::<InheritedVisibility>()
        .register_type::<ViewVisibility>()
        .register_type::<bevy::camera::visibility::VisibilityClass>()
        .register_type::<bevy::camera::visibility::NoFrustumCulling>()
        .register_type::<bevy::camera::visibility::DynamicSkinnedMeshBounds>()
        .register_type::<bevy::camera::primitives::Aabb>()
        .register_type::<Name>()
        .register_type::<ChildOf>()
        .register_type::<Children>()
        .register_type::<Mesh3d>()
        .register_type::<MeshMaterial3d<StandardMaterial>>()
        .register_type::<bevy::mesh::skinning::SkinnedMesh>()
        .register_type::<bevy::mesh::morph::MorphWeights>()
        .register_type::<bevy::mesh::morph::MeshMorphWeights>()
        .register_type::<AnimationPlayer>()
        .register_type::<bevy::animation::AnimationTargetId>()
        .register_type::<bevy::animation::AnimatedBy>()
        .register_type::<bevy::gltf::GltfExtras>()
        .register_type::<bevy::gltf::GltfSceneName>()
        .register_type::<bevy::gltf::GltfSceneExtras>()
        .register_type::<bevy::gltf::GltfMeshName>()
        .register_type::<bevy::gltf::GltfMeshExtras>()
        .register_type::<bevy::gltf::GltfMaterialName>()
        .register_type::<bevy::gltf::GltfMaterialExtras>();
}

fn wait_for(headless: &mut Headless, is_there: impl Fn(&mut World) -> bool) {
    let began = std::time::Instant::now();
    while !is_there(headless.app.world_mut()) {
        assert!(began.elapsed().as_secs() < 60, "the file is never loaded");
        headless.run(1);
    }
    // Its pictures may be on their way still.
    for _ in 0..20 {
        std::thread::sleep(std::time::Duration::from_millis(20));
        headless.run(1);
    }
}

fn camera(eye: [f32; 3], target: [f32; 3]) -> Camera {
    let up = glam::Vec3::Y;
    Camera {
        eye: eye.into(),
        target: target.into(),
        up,
        fov_y_rad: 0.7,
        near_m: 0.05,
        far_m: 100.0,
        shadow_distance: None,
    }
}

fn rectangle(center: [f32; 3], target: [f32; 3]) -> Light {
    Light::new(LightShape::Rectangle { size_m: glam::Vec2::new(0.6, 0.3) }, center.into(), target.into())
}

#[test]
fn an_animated_skeleton_shades_itself_as_rays_say() {
    let camera = camera([0.6, 1.3, 2.6], [0.0, 0.75, 0.0]);
    let light = rectangle([1.2, 2.6, 1.4], [0.0, 0.8, 0.0]);
    let Some(rmse) = error_of("cesium-man.glb", UVec2::splat(256), &camera, &light, Some(0.7)) else { return };
    // The laboratory, which has exact normals, is at .001: what is left are silhouettes of small round limbs.
    assert!(rmse < 0.06, "rmse {rmse:.4}");
}

#[test]
fn leaves_with_holes_shade_each_other_as_rays_say() {
    let camera = camera([1.3, 1.3, 1.9], [0.45, 0.15, 0.4]);
    let light = rectangle([0.3, 2.4, 0.2], [0.4, 0.1, 0.4]);
    let Some(rmse) = error_of("fern.glb", UVec2::splat(128), &camera, &light, None) else { return };
    // Leaves are narrower than a pixel, where a normal from depth is seldom the leaf's: the laboratory, which has exact ones, is at
    // .003.
    assert!(rmse < 0.2, "rmse {rmse:.4}");
}
