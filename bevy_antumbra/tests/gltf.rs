//! glTF files as Bevy loads them, compared with traced rays: an animated skeleton, and leaves with holes.
//!
//! The files are those of the laboratory's tests, in `ANTUMBRA_SCENES` or in `shared/scenes` beside or inside the repository.

mod common;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use antumbra::light::{Light, LightShape};
use antumbra_reference::{Tracer, VisibilityImage, VisibilityOptions};
use antumbra_scene::{Camera, LoadOptions};
use bevy::animation::graph::AnimationGraphHandle;
use bevy::animation::{AnimationPlayer, graph::AnimationGraph};
use bevy::light::{DirectionalLightShadowMap, ShadowFilteringMethod};
use bevy::prelude::*;
use bevy_antumbra::{AntumbraPlugin, ShadowTechnique, SoftShadows};
use common::{Headless, Picture, set_shadows, spawn_light};

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

/// File with camera and light.
struct Shot<'a> {
    file: &'a str,
    size_px: UVec2,
    camera: Camera,
    light: Light,
    /// Time in the first animation, seconds; `None` without animation.
    time_s: Option<f32>,
}

/// Source of the shadows.
#[derive(Clone, Debug)]
enum By {
    Bevy,
    Plugin(ShadowTechnique),
}

impl Shot<'_> {
    fn name(&self) -> &str {
        self.file.trim_end_matches(".glb")
    }

    /// Opens the file in an app, posed at the given time. Returns the app and its light.
    fn open(&self, folder: &Path, by: &By) -> (Headless, Entity) {
        let mut headless = Headless::reading(self.size_px, folder);
        if matches!(by, By::Plugin(_)) {
            headless.app.add_plugins(AntumbraPlugin::default());
        }
        register_types(&mut headless.app);
        headless.finish();
        headless.app.insert_resource(DirectionalLightShadowMap { size: 4096 });
        let assets = headless.app.world().resource::<AssetServer>().clone();
        // The handles are kept, because a later request would load the file and the scene again.
        let file = self.file.to_owned();
        let clip = self.time_s.map(|_| assets.load(GltfAssetLabel::Animation(0).from_asset(file.clone())));
        let scene = WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(file)));
        headless.app.world_mut().spawn(scene);
        let bundle = headless.camera(&self.camera);
        headless.app.world_mut().spawn((bundle, Msaa::Off, ShadowFilteringMethod::Gaussian));
        let light = spawn_light(&mut headless.app, &self.light);
        wait_for(&mut headless, |world| world.query::<&Mesh3d>().iter(world).next().is_some());
        if let Some((time_s, clip)) = self.time_s.zip(clip) {
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
            assert!(!players.is_empty(), "{} has an animation", self.file);
            for player in players {
                world.entity_mut(player).insert(AnimationGraphHandle(graph.clone()));
            }
        }
        (headless, light)
    }

    fn truth(&self, folder: &Path) -> VisibilityImage {
        let options = LoadOptions { time_s: self.time_s.unwrap_or_default() };
        let scene = antumbra_scene::load(&folder.join(self.file).to_string_lossy(), &options).expect("a scene");
        let tracer = Tracer::new(&scene).expect("a scene that can be traced");
        let receivers = tracer.primary(&self.camera, glam::UVec2::new(self.size_px.x, self.size_px.y));
        let (options, cancel) = (VisibilityOptions::default(), AtomicBool::new(false));
        tracer.visibility(&receivers, &self.light, &options, &|_| {}, &cancel).expect("a light that can be traced")
    }

    /// Returns the error against traced rays of each source of shadows. All techniques of the plugin share one app.
    fn errors(&self, folder: &Path, ways: &[By]) -> Vec<f64> {
        let truth = self.truth(folder);
        let mut open: Option<(Headless, Entity, Picture)> = None;
        let mut error_of = |by: &By| {
            if open.is_none() || matches!(by, By::Bevy) {
                // Only one app may exist at a time.
                drop(open.take());
                let (mut headless, light) = self.open(folder, by);
                set_shadows(&mut headless.app, light, false);
                let lit = headless.picture(20);
                set_shadows(&mut headless.app, light, true);
                open = Some((headless, light, lit));
            }
            let (headless, light, lit) = open.as_mut().expect("it is open");
            if let By::Plugin(technique) = by {
                headless.app.world_mut().entity_mut(*light).insert(SoftShadows::by(*technique));
            }
            let shadowed = headless.picture(8);
            let name = match by {
                By::Bevy => format!("{}_bevy", self.name()),
                By::Plugin(technique) => format!("{}_{}", self.name(), technique.kind()),
            };
            let error = error_against(&truth, &shadowed, lit, &name);
            if matches!(by, By::Bevy) {
                open = None;
            }
            error
        };
        let errors = ways.iter().map(&mut error_of).collect();
        let picture = Picture { size_px: self.size_px, pixels: truth.values };
        picture.save(&format!("{}_truth", self.name()), 1.0);
        errors
    }
}

/// Returns the root mean square error over the pixels that the light reaches without shadows.
fn error_against(truth: &VisibilityImage, shadowed: &Picture, lit: &Picture, name: &str) -> f64 {
    let most = lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    shadowed.save(name, 1.0 / most);
    let mut errors = lit.clone();
    errors.pixels.fill([0.0; 3]);
    let (mut sum, mut judged) = (0.0, 0);
    for (i, (had, truth_here)) in shadowed.over(lit).into_iter().zip(&truth.values).enumerate() {
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
    rmse
}

/// Registers the types that scenes need. Bevy features that do this by themselves take long to build.
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
        assert!(began.elapsed().as_secs() < 600, "the file is never loaded");
        headless.run(1);
    }
    // Textures may still be loading.
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

/// Returns a sun twice as wide as ours, so that a small image has penumbrae.
fn sun(towards: [f32; 3]) -> Light {
    let shape = LightShape::Sun { angular_diameter_rad: 0.018 };
    Light::new(shape, glam::Vec3::ZERO, glam::Vec3::from(towards))
}

fn cesium_man() -> (Camera, Option<f32>) {
    (camera([0.6, 1.3, 2.6], [0.0, 0.75, 0.0]), Some(0.7))
}

fn fern() -> (Camera, Option<f32>) {
    (camera([1.3, 1.3, 1.9], [0.45, 0.15, 0.4]), None)
}

#[test]
fn an_animated_skeleton_shades_itself_as_rays_say() {
    let Some(folder) = folder() else { return };
    let (camera, time_s) = cesium_man();
    let light = rectangle([1.2, 2.6, 1.4], [0.0, 0.8, 0.0]);
    let shot = Shot { file: "cesium-man.glb", size_px: UVec2::splat(256), camera, light, time_s };
    let rmse = shot.errors(&folder, &[By::Plugin(ShadowTechnique::SampleBased)])[0];
    // The laboratory, which has exact normals, reaches .001; the rest is due to silhouettes of small round limbs.
    assert!(rmse < 0.06, "rmse {rmse:.4}");
}

#[test]
fn leaves_with_holes_shade_each_other_as_rays_say() {
    let Some(folder) = folder() else { return };
    let (camera, time_s) = fern();
    let light = rectangle([0.3, 2.4, 0.2], [0.4, 0.1, 0.4]);
    let shot = Shot { file: "fern.glb", size_px: UVec2::splat(128), camera, light, time_s };
    let rmse = shot.errors(&folder, &[By::Plugin(ShadowTechnique::SampleBased)])[0];
    // Leaves are narrower than a pixel, where a normal from depth is seldom the leaf's. The laboratory, which has exact normals,
    // reaches .003.
    assert!(rmse < 0.2, "rmse {rmse:.4}");
}

/// Compares Bevy's own shadows, the plugin's and traced rays under the sun.
fn beside_bevys_own(file: &str, size_px: UVec2, (camera, time_s): (Camera, Option<f32>), towards: [f32; 3]) {
    let Some(folder) = folder() else { return };
    let shot = Shot { file, size_px, camera, light: sun(towards), time_s };
    let ways = [By::Bevy, By::Plugin(ShadowTechnique::Pcss), By::Plugin(ShadowTechnique::SampleBased)];
    let errors = shot.errors(&folder, &ways);
    let [bevy, pcss, sample_based] = errors[..] else { panic!("an error of each way") };
    // On leaves narrower than a pixel a blocker search is as inaccurate as Bevy's filter.
    assert!(pcss < 1.05 * bevy, "{file}: Pcss has {pcss:.4}, Bevy {bevy:.4}");
    assert!(sample_based < 0.8 * bevy, "{file}: SampleBased has {sample_based:.4}, Bevy {bevy:.4}");
}

#[test]
fn a_figure_beside_bevys_own() {
    beside_bevys_own("cesium-man.glb", UVec2::splat(192), cesium_man(), [-0.5, -1.0, -0.6]);
}

#[test]
fn leaves_beside_bevys_own() {
    beside_bevys_own("fern.glb", UVec2::splat(128), fern(), [-0.4, -1.0, 0.3]);
}

#[test]
fn a_hall_beside_bevys_own() {
    let hall = (camera([-8.5, 1.6, 0.6], [4.0, 3.0, -1.2]), None);
    beside_bevys_own("sponza.glb", UVec2::new(320, 180), hall, [0.25, -1.0, 0.2]);
}
