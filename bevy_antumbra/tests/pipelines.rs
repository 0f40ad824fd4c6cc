//! Render paths of Bevy: each test renders an image with the shadow.

mod common;

use bevy::anti_alias::taa::TemporalAntiAliasing;
use bevy::camera::{Hdr, Viewport};
use bevy::core_pipeline::prepass::DeferredPrepass;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::pbr::{
    DefaultOpaqueRendererMethod, DistanceFog, ExtendedMaterial, FogFalloff, MaterialExtension,
    ScreenSpaceAmbientOcclusion,
};
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::shader::ShaderRef;
use bevy_antumbra::SoftShadows;
use common::{Headless, Picture, set_shadows};

const SIZE_PX: UVec2 = UVec2::splat(128);

/// Spawns a slab above the ground, under a rectangle light, seen from above and the side. Returns the light.
fn slab_over_ground(headless: &mut Headless) -> Entity {
    let world = headless.app.world_mut();
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let ground = meshes.add(Plane3d::default().mesh().size(8.0, 8.0));
    let slab = meshes.add(Cuboid::new(1.2, 0.1, 1.2));
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial {
        perceptual_roughness: 1.0,
        reflectance: 0.0,
        ..default()
    });
    world.spawn((Mesh3d(ground), MeshMaterial3d(material.clone())));
    world.spawn((Mesh3d(slab), MeshMaterial3d(material), Transform::from_xyz(0.0, 1.0, 0.0)));
    let light = RectLight { width: 0.5, height: 0.5, intensity: 4e5, range: 30.0, ..default() };
    world.spawn((light, Transform::from_xyz(1.5, 4.0, 0.5).looking_at(Vec3::ZERO, Vec3::X))).id()
}

fn camera() -> antumbra_scene::Camera {
    antumbra_scene::Camera {
        eye: glam::Vec3::new(0.0, 4.5, 4.5),
        target: glam::Vec3::ZERO,
        up: glam::Vec3::Y,
        fov_y_rad: 0.8,
        near_m: 0.1,
        far_m: 100.0,
        shadow_distance: None,
    }
}

/// Renders with and without shadows, by a camera with additional components, and checks that the shadow is dark.
fn has_shadow(name: &str, more: impl Bundle) {
    let mut headless = Headless::new(SIZE_PX, SoftShadows::default());
    let light = slab_over_ground(&mut headless);
    let bundle = headless.camera(&camera());
    let camera = headless.app.world_mut().spawn(bundle).id();
    headless.app.world_mut().entity_mut(camera).insert(more);
    judge(name, &mut headless, light);
}

fn judge(name: &str, headless: &mut Headless, light: Entity) {
    let shadowed = headless.picture(8);
    set_shadows(&mut headless.app, light, false);
    let lit = headless.picture(8);
    let most = lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    shadowed.save(name, 1.0 / most);
    let [dark, light] = shares(&shadowed, &lit);
    println!("{name}: dark {dark:.3}, light {light:.3}");
    assert!((0.02..0.2).contains(&dark), "{name}: {dark:.3} of the picture is in shadow");
    assert!(light > 0.5, "{name}: {light:.3} of the picture is in the light");
}

/// Returns the fractions of pixels that lose more than half of their light to the shadow, and almost nothing.
fn shares(shadowed: &Picture, lit: &Picture) -> [f32; 2] {
    let ratios: Vec<f32> = shadowed.over(lit).into_iter().flatten().map(|v| v[1]).collect();
    let share = |is: fn(f32) -> bool| ratios.iter().filter(|v| is(**v)).count() as f32 / ratios.len() as f32;
    [share(|v| v < 0.5), share(|v| v > 0.93)]
}

#[test]
fn forward() {
    has_shadow("forward", Msaa::Off);
}

#[test]
fn four_samples_a_pixel() {
    has_shadow("msaa", Msaa::Sample4);
}

#[test]
fn deferred() {
    let mut headless = Headless::new(SIZE_PX, SoftShadows::default());
    headless.app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    let light = slab_over_ground(&mut headless);
    let bundle = headless.camera(&camera());
    headless.app.world_mut().spawn((bundle, DeferredPrepass, Msaa::Off));
    judge("deferred", &mut headless, light);
}

#[test]
fn temporal_antialiasing() {
    has_shadow("taa", (TemporalAntiAliasing::default(), Msaa::Off));
}

#[test]
fn ambient_occlusion() {
    has_shadow("ssao", (ScreenSpaceAmbientOcclusion::default(), Msaa::Off));
}

#[test]
fn fog() {
    let fog = DistanceFog {
        color: Color::linear_rgb(0.02, 0.02, 0.02),
        falloff: FogFalloff::Linear { start: 5.0, end: 40.0 },
        ..default()
    };
    has_shadow("fog", (fog, Msaa::Off));
}

#[test]
fn bloom() {
    has_shadow("bloom", (Bloom::NATURAL, Msaa::Off));
}

#[test]
fn eight_bits() {
    let mut headless = Headless::new(SIZE_PX, SoftShadows::default());
    let light = slab_over_ground(&mut headless);
    let bundle = headless.camera(&camera());
    let camera = headless.app.world_mut().spawn((bundle, Msaa::Off)).id();
    headless.app.world_mut().entity_mut(camera).remove::<Hdr>().insert(Tonemapping::Reinhard);
    judge("eight_bits", &mut headless, light);
}

#[test]
fn a_viewport() {
    let part = Viewport { physical_position: UVec2::new(40, 24), physical_size: UVec2::new(80, 96), ..default() };
    let camera = Camera { viewport: Some(part), ..default() };
    has_shadow("viewport", (camera, Msaa::Off));
}

#[test]
fn an_orthographic_camera() {
    let projection = OrthographicProjection {
        scaling_mode: bevy::camera::ScalingMode::FixedVertical { viewport_height: 5.0 },
        ..OrthographicProjection::default_3d()
    };
    has_shadow("orthographic", (Projection::Orthographic(projection), Msaa::Off));
}

/// Extension that adds nothing, so that the material differs from the standard one.
#[derive(Asset, AsBindGroup, Clone, Debug, Default, TypePath)]
struct Plain {}

impl MaterialExtension for Plain {}

/// Material with its own shader, which calls Bevy's lighting.
#[derive(Asset, AsBindGroup, Clone, TypePath)]
struct Own {
    #[texture(0)]
    #[sampler(1)]
    texture: Handle<Image>,
}

impl Material for Own {
    fn fragment_shader() -> ShaderRef {
        "own_material.wesl".into()
    }
}

/// Checks shadows with another material on all meshes.
fn has_shadow_on<M: Material>(name: &str, material: impl FnOnce(&mut World) -> M)
where
    M::Data: PartialEq + Eq + std::hash::Hash + Clone,
{
    let mut headless = Headless::reading(SIZE_PX, std::path::Path::new("tests/data"));
    headless.app.add_plugins((bevy_antumbra::AntumbraPlugin::default(), MaterialPlugin::<M>::default()));
    headless.finish();
    let light = slab_over_ground(&mut headless);
    let world = headless.app.world_mut();
    let material = material(world);
    let material = world.resource_mut::<Assets<M>>().add(material);
    let mut meshes = world.query_filtered::<Entity, With<Mesh3d>>();
    let meshes: Vec<Entity> = meshes.iter(world).collect();
    for mesh in meshes {
        let mut mesh = world.entity_mut(mesh);
        mesh.remove::<MeshMaterial3d<StandardMaterial>>().insert(MeshMaterial3d(material.clone()));
    }
    let bundle = headless.camera(&camera());
    headless.app.world_mut().spawn((bundle, Msaa::Off));
    // Shaders from files are loaded some frames later.
    for _ in 0..20 {
        headless.run(1);
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    judge(name, &mut headless, light);
}

#[test]
fn an_extended_material() {
    has_shadow_on("extended_material", |_| {
        let base = StandardMaterial { perceptual_roughness: 1.0, reflectance: 0.0, ..default() };
        ExtendedMaterial::<StandardMaterial, Plain> { base, extension: Plain {} }
    });
}

#[test]
fn a_material_with_a_shader_of_its_own() {
    has_shadow_on("own_material", |world| Own { texture: world.resource_mut::<Assets<Image>>().add(Image::default()) });
}

/// If Bevy's shader differs from the expected one, nothing is patched, and Bevy's own shadows stay on.
#[test]
fn another_bevy_keeps_its_own_shadows() {
    let mut headless = Headless::bare(SIZE_PX);
    headless.app.add_plugins(bevy_antumbra::AntumbraPlugin::default());
    // Runs after the shader is loaded, and before the plugin sees it in the next frame.
    headless.app.add_systems(Update, |mut shaders: ResMut<Assets<Shader>>, mut is_done: Local<bool>| {
        let is_lighting = |shader: &Shader| shader.path.ends_with("pbr_functions.wesl");
        let Some(id) = shaders.iter().find(|(_, shader)| is_lighting(shader)).map(|(id, _)| id) else { return };
        if std::mem::replace(&mut *is_done, true) {
            return;
        }
        if let Some(mut shader) = shaders.get_mut(id)
            && let bevy::shader::Source::Wesl(text) = &mut shader.source
        {
            *text = text
                .replacen("direct_light += light_contrib * shadow;", "direct_light += shadow * light_contrib;", 1)
                .into();
        }
    });
    headless.finish();
    slab_over_ground(&mut headless);
    let point = PointLight { shadow_maps_enabled: true, intensity: 1e6, ..default() };
    let light = headless.app.world_mut().spawn((point, Transform::from_xyz(0.5, 4.0, 0.5))).id();
    let bundle = headless.camera(&camera());
    headless.app.world_mut().spawn((bundle, Msaa::Off));
    headless.run(2);
    assert_eq!(headless.app.world().get_resource(), Some(&bevy_antumbra::Patch::Refused));
    let world = headless.app.world_mut();
    let mut rectangles = world.query_filtered::<Entity, With<RectLight>>();
    let rectangles: Vec<Entity> = rectangles.iter(world).collect();
    rectangles.into_iter().for_each(|light| {
        world.despawn(light);
    });
    judge("refused", &mut headless, light);
}
