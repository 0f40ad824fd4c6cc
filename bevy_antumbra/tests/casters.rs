//! Casters and receivers by Bevy's components. Each test measures the shadowed fraction of the image.

mod common;

use std::path::Path;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::image::Image;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes, MorphWeights};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{Indices, MeshCompressionArgs, VertexAttributeValues};
use bevy::pbr::{ExtendedMaterial, MaterialExtension};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, Extent3d, TextureDimension, TextureFormat};
use bevy::shader::ShaderRef;
use bevy_antumbra::{
    AntumbraPlugin, BevyMaps, CasterMaterial, CasterMaterialPlugin, CasterSurface, ShadowTechnique, SoftShadows,
    SurfaceTexture,
};
use common::{Headless, Picture, difference, set_shadows};

const SIZE_PX: UVec2 = UVec2::splat(128);
/// Size of the slab, metres. It floats 1.5 m above the ground, outside the camera's view.
const SLAB_M: Vec3 = Vec3::new(1.2, 0.05, 1.2);
const SLAB_AT: Vec3 = Vec3::new(0.0, 1.5, 0.0);

/// Test scene: the ground seen from above, with the slab off screen, under a sun at the zenith.
struct Stage {
    headless: Headless,
    ground: Entity,
    light: Entity,
    /// Image without shadows.
    lit: Picture,
}

impl Stage {
    fn new() -> Self {
        Self::by(SoftShadows::default())
    }

    fn by(settings: SoftShadows) -> Self {
        Self::with(settings, |_| {})
    }

    /// Creates the scene with additions to the app, whose assets are in the tests' folder.
    fn with(settings: SoftShadows, more: impl FnOnce(&mut App)) -> Self {
        let mut headless = Headless::reading(SIZE_PX, Path::new("tests/data"));
        headless.app.add_plugins(AntumbraPlugin { settings });
        more(&mut headless.app);
        headless.finish();
        let camera = headless.camera(&antumbra_scene::Camera {
            eye: glam::Vec3::new(0.0, 1.3, 0.0),
            target: glam::Vec3::ZERO,
            up: -glam::Vec3::Z,
            // The view covers 2.4 m of the ground; the slab's shadow is half as wide.
            fov_y_rad: 2.0 * (1.2f32 / 1.3).atan(),
            near_m: 0.05,
            far_m: 10.0,
            shadow_distance: None,
        });
        let world = headless.app.world_mut();
        world.spawn((camera, Msaa::Off));
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Plane3d::default().mesh().size(6.0, 6.0));
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(white());
        let ground = world.spawn((Mesh3d(mesh), MeshMaterial3d(material))).id();
        let sun = DirectionalLight { illuminance: 1e4, shadow_maps_enabled: false, ..default() };
        let down = Transform::default().looking_to(Vec3::NEG_Y, Vec3::X);
        let light = world.spawn((sun, down)).id();
        let lit = headless.picture(4);
        set_shadows(&mut headless.app, light, true);
        Self { headless, ground, light, lit }
    }

    fn spawn_slab(&mut self, more: impl Bundle) -> Entity {
        self.spawn(Cuboid::from_size(SLAB_M).into(), white(), (Transform::from_translation(SLAB_AT), more))
    }

    fn spawn(&mut self, mesh: Mesh, material: StandardMaterial, more: impl Bundle) -> Entity {
        let world = self.headless.app.world_mut();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), more)).id()
    }

    fn world(&mut self) -> &mut World {
        self.headless.app.world_mut()
    }

    /// Returns the mean visibility of the image, for each colour.
    #[track_caller]
    fn mean(&mut self, name: &str) -> [f32; 3] {
        let picture = self.headless.picture(4);
        let visibility = picture.over(&self.lit);
        let all: Vec<[f32; 3]> = visibility.into_iter().flatten().collect();
        assert!(all.len() > 10_000, "{} pixels are lit", all.len());
        let most = self.lit.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
        picture.save(name, 1.0 / most);
        let mean = [0, 1, 2].map(|i| all.iter().map(|v| v[i]).sum::<f32>() / all.len() as f32);
        println!("{name}: {mean:.3?}");
        mean
    }

    /// Returns the fraction of the image in shadow.
    #[track_caller]
    fn shadow(&mut self, name: &str) -> f32 {
        1.0 - self.mean(name)[0]
    }
}

/// Fraction of the image that the whole slab shadows.
const WHOLE: f32 = 0.25;

#[track_caller]
fn is_near(had: f32, expected: f32) {
    assert!((had - expected).abs() < 0.012, "{had:.3} of the picture is in shadow, and not {expected:.3}");
}

fn white() -> StandardMaterial {
    StandardMaterial { perceptual_roughness: 1.0, reflectance: 0.0, ..default() }
}

#[test]
fn what_is_off_screen_casts_and_what_is_marked_or_hidden_does_not() {
    let mut stage = Stage::new();
    is_near(stage.shadow("nothing"), 0.0);
    let slab = stage.spawn_slab(());
    is_near(stage.shadow("off_screen"), WHOLE);
    stage.world().entity_mut(slab).insert(NotShadowCaster);
    is_near(stage.shadow("not_caster"), 0.0);
    stage.world().entity_mut(slab).remove::<NotShadowCaster>().insert(Visibility::Hidden);
    is_near(stage.shadow("hidden"), 0.0);
    stage.world().entity_mut(slab).insert(Visibility::Visible);
    is_near(stage.shadow("visible_again"), WHOLE);
    let ground = stage.ground;
    stage.world().entity_mut(ground).insert(NotShadowReceiver);
    is_near(stage.shadow("not_receiver"), 0.0);
    stage.world().entity_mut(ground).remove::<NotShadowReceiver>();
    is_near(stage.shadow("receiver_again"), WHOLE);
    stage.world().despawn(slab);
    is_near(stage.shadow("despawned"), 0.0);
}

#[test]
fn lights_see_casters_of_their_layers() {
    let mut stage = Stage::new();
    let slab = stage.spawn_slab(RenderLayers::layer(1));
    is_near(stage.shadow("other_layer"), 0.0);
    stage.world().entity_mut(slab).insert(RenderLayers::from_layers(&[0, 1]));
    is_near(stage.shadow("both_layers"), WHOLE);
}

#[test]
fn one_mesh_many_times_moved_and_turned() {
    let mut stage = Stage::new();
    let world = stage.world();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(0.6, 0.05, 0.6));
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(white());
    let at = |x: f32, z: f32| Transform::from_xyz(0.6 * x, 1.5, 0.6 * z);
    let tiles: Vec<Entity> = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
        .map(|(x, z)| world.spawn((Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), at(x, z))).id())
        .into();
    is_near(stage.shadow("four_tiles"), WHOLE);
    // One tile on another, one twice as large, one outside the image.
    stage.world().entity_mut(tiles[0]).insert(at(1.0, -1.0));
    is_near(stage.shadow("one_on_another"), 0.75 * WHOLE);
    stage.world().entity_mut(tiles[3]).insert(at(0.0, 1.0).with_scale(Vec3::new(2.0, 1.0, 1.0)));
    stage.world().entity_mut(tiles[2]).insert(at(8.0, 8.0));
    is_near(stage.shadow("stretched"), 0.75 * WHOLE);
}

#[test]
fn indices_of_16_and_32_bits_and_none_and_compressed_vertices() {
    let of_16: Mesh = Cuboid::from_size(SLAB_M).into();
    let mut of_32 = of_16.clone();
    of_32.insert_indices(Indices::U32(of_16.indices().expect("a cuboid has some").iter().map(|i| i as u32).collect()));
    let mut of_none = of_16.clone();
    of_none.duplicate_vertices();
    let mut narrow = of_16.clone();
    narrow.insert_indices(Indices::U16(of_16.indices().expect("some").iter().map(|i| i as u16).collect()));
    let compressed =
        of_16.clone().compressed_mesh(&MeshCompressionArgs::regular()).expect("a cuboid can be compressed");
    let mut stage = Stage::new();
    for (name, mesh) in [("bits_32", of_32), ("bits_16", narrow), ("no_indices", of_none), ("compressed", compressed)] {
        let slab = stage.spawn(mesh, white(), Transform::from_translation(SLAB_AT));
        is_near(stage.shadow(name), WHOLE);
        stage.world().despawn(slab);
    }
}

#[test]
fn a_mesh_that_changes() {
    let mut stage = Stage::new();
    let slab = stage.spawn_slab(());
    is_near(stage.shadow("unchanged"), WHOLE);
    let mesh = stage.world().get::<Mesh3d>(slab).expect("a mesh").0.clone();
    let half: Mesh = Cuboid::new(0.6, 0.05, 1.2).into();
    stage.world().resource_mut::<Assets<Mesh>>().insert(&mesh, half).expect("a mesh to change");
    is_near(stage.shadow("changed"), 0.5 * WHOLE);
    // More vertices than before.
    let round: Mesh = Cylinder::new(0.6, 0.05).into();
    stage.world().resource_mut::<Assets<Mesh>>().insert(&mesh, round).expect("a mesh to change");
    is_near(stage.shadow("changed_again"), 0.25 * std::f32::consts::PI * WHOLE);
}

/// Returns a texture of 4 × 4 squares, every second of which is transparent.
fn chequered() -> Image {
    let texel = |i: u32| [255, 255, 255, if (i % 64 / 16 + i / 64 / 16).is_multiple_of(2) { 255 } else { 0 }];
    let bytes = (0..64 * 64).flat_map(texel).collect();
    let size = Extent3d { width: 64, height: 64, depth_or_array_layers: 1 };
    Image::new(size, TextureDimension::D2, bytes, TextureFormat::Rgba8UnormSrgb, RenderAssetUsages::default())
}

#[test]
fn masked_blended_and_coloured_materials() {
    let mut stage = Stage::by(SoftShadows::by(ShadowTechnique::MultiLayer));
    let picture = stage.world().resource_mut::<Assets<Image>>().add(chequered());
    let card = || Mesh::from(Plane3d::default().mesh().size(1.2, 1.2));
    let at = Transform::from_translation(SLAB_AT);
    let masked = StandardMaterial { base_color_texture: Some(picture), alpha_mode: AlphaMode::Mask(0.5), ..white() };
    let slab = stage.spawn(card(), masked.clone(), at);
    is_near(stage.shadow("masked"), 0.5 * WHOLE);
    stage.world().despawn(slab);
    // One opaque square of the texture: compressed coordinates then have a box other than 0 to 1.
    let mut square = card();
    let Some(VertexAttributeValues::Float32x2(uvs)) = square.attribute_mut(Mesh::ATTRIBUTE_UV_0) else {
        panic!("a plane has texture coordinates");
    };
    uvs.iter_mut().for_each(|uv| *uv = uv.map(|v| 0.76 + 0.23 * v));
    let compressed = square.clone().compressed_mesh(&MeshCompressionArgs::regular()).expect("a plane");
    for (name, mesh) in [("opaque_square", square), ("compressed_square", compressed)] {
        let slab = stage.spawn(mesh, masked.clone(), at);
        is_near(stage.shadow(name), WHOLE);
        stage.world().despawn(slab);
    }
    // Alpha is coverage, whatever the colour.
    let blended = |specular_transmission| StandardMaterial {
        base_color: Color::linear_rgba(1.0, 0.0, 0.0, 0.9),
        alpha_mode: AlphaMode::Blend,
        specular_transmission,
        ..white()
    };
    let slab = stage.spawn(card(), blended(0.0), at);
    for v in stage.mean("blended") {
        is_near(1.0 - v, 0.9 * WHOLE);
    }
    stage.world().despawn(slab);
    // The glass covers nine tenths and transmits red.
    let glass = blended(1.0);
    let slab = stage.spawn(card(), glass, at);
    let [red, green, blue] = stage.mean("glass").map(|v| 1.0 - v);
    is_near(red, 0.0);
    is_near(green, 0.9 * WHOLE);
    is_near(blue, 0.9 * WHOLE);
    // A technique without colour counts it as opaque.
    let light = stage.light;
    stage.world().entity_mut(light).insert(SoftShadows::by(ShadowTechnique::Pcss));
    is_near(stage.shadow("glass_by_pcss"), WHOLE);
    stage.world().despawn(slab);
    let none = StandardMaterial { alpha_mode: AlphaMode::Add, ..white() };
    stage.spawn(card(), none, at);
    is_near(stage.shadow("added"), 0.0);
}

/// A mask holds the ground below a veil; the veil itself has the shadow of Bevy's map.
#[test]
fn transparent_surfaces_keep_bevys_shadows() {
    let mut stage = Stage::new();
    stage.spawn_slab(());
    let base_color = Color::linear_rgba(1.0, 1.0, 1.0, 0.5);
    let material = StandardMaterial { base_color, alpha_mode: AlphaMode::Blend, ..white() };
    let mesh = Plane3d::default().mesh().size(4.0, 4.0).into();
    let veil = stage.spawn(mesh, material, (Transform::from_xyz(0.0, 0.005, 0.0), NotShadowCaster));
    is_near(stage.shadow("veil"), WHOLE);
    stage.world().entity_mut(veil).insert(NotShadowReceiver);
    is_near(stage.shadow("veil_receives_none"), 0.5 * WHOLE);
    stage.world().entity_mut(veil).remove::<NotShadowReceiver>();
    let light = stage.light;
    stage.world().entity_mut(light).insert(SoftShadows::default().beside(BevyMaps::Never));
    is_near(stage.shadow("veil_without_map"), 0.5 * WHOLE);
    stage.world().entity_mut(light).insert(SoftShadows::default().beside(BevyMaps::Always));
    is_near(stage.shadow("veil_with_map"), WHOLE);
    // A surface with a mask must not get Bevy's shadow, too: under a wide sun the mask's edges are softer than the map's.
    stage.world().despawn(veil);
    stage.world().entity_mut(light).insert(bevy::light::SunDisk { angular_size: 0.3, intensity: 1.0 });
    let beside = stage.headless.picture(4);
    stage.world().entity_mut(light).insert(SoftShadows::default().beside(BevyMaps::Never));
    let alone = stage.headless.picture(4);
    let apart = difference(&beside, &alone);
    assert!(apart < 1e-3, "an opaque ground is otherwise by {apart} where Bevy draws its map too");
}

#[test]
fn a_skeleton_bends() {
    let mut mesh: Mesh = Cuboid::from_size(SLAB_M).into();
    // The right half depends on the second joint.
    let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("a cuboid has positions");
    };
    let joints: Vec<[u16; 4]> = positions.iter().map(|p| [u16::from(p[0] > 0.0), 0, 0, 0]).collect();
    let weights = vec![[1.0f32, 0.0, 0.0, 0.0]; positions.len()];
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints));
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
    let mut stage = Stage::new();
    let world = stage.world();
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let joints: Vec<Entity> = (0..2).map(|_| world.spawn(Transform::from_translation(SLAB_AT)).id()).collect();
    let skin = SkinnedMesh { inverse_bindposes, joints: joints.clone() };
    stage.spawn(mesh, white(), (skin, Transform::default()));
    is_near(stage.shadow("straight"), WHOLE);
    // From 1.2 m to 0.8 m wide.
    let moved = Transform::from_translation(SLAB_AT - Vec3::new(0.4, 0.0, 0.0));
    stage.world().entity_mut(joints[1]).insert(moved);
    is_near(stage.shadow("bent"), WHOLE * 0.8 / 1.2);
}

/// Adds two targets: one moves the right half to the left, from 1.2 m to 0.8 m wide; the other makes the mesh 2 m wide.
fn with_targets(mut mesh: Mesh) -> Mesh {
    let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("a cuboid has positions");
    };
    let narrow = |p: &[f32; 3]| Vec3::new(if p[0] > 0.0 { -0.4 } else { 0.0 }, 0.0, 0.0);
    let attributes = |position: Vec3| MorphAttributes::from([position, Vec3::ZERO, Vec3::ZERO]);
    let of_narrow = positions.iter().map(|p| attributes(narrow(p)));
    let of_wide = positions.iter().map(|p| attributes(Vec3::new(0.4 * p[0].signum(), 0.0, 0.0)));
    let targets = of_narrow.chain(of_wide).collect();
    mesh.set_morph_targets(targets);
    mesh
}

#[test]
fn morph_targets_move_what_casts() {
    let mut stage = Stage::new();
    let mesh = with_targets(Cuboid::from_size(SLAB_M).into());
    let weights = |weights: [f32; 2]| MeshMorphWeights::Value { weights: weights.into() };
    let at = Transform::from_translation(SLAB_AT);
    let slab = stage.spawn(mesh.clone(), white(), (at, weights([0.0; 2])));
    is_near(stage.shadow("not_morphed"), WHOLE);
    for (name, of, width_m) in [("narrow", [1.0, 0.0], 0.8), ("half", [0.5, 0.0], 1.0), ("wide", [0.0, 1.0], 2.0)] {
        stage.world().entity_mut(slab).insert(weights(of));
        is_near(stage.shadow(name), WHOLE * width_m / 1.2);
    }
    // Half as large by its transform, and morphed by another entity's weights.
    let shared = MorphWeights::new(vec![1.0, 0.0], None).expect("few weights");
    let shared = stage.world().spawn(shared).id();
    stage
        .world()
        .entity_mut(slab)
        .insert((MeshMorphWeights::Reference(shared), at.with_scale(Vec3::new(0.5, 1.0, 1.0))));
    is_near(stage.shadow("shared_weights"), WHOLE * 0.4 / 1.2);
    stage.world().despawn(slab);
    // A mesh that stays in the render world alone was measured when it was added.
    let mut far = mesh;
    far.asset_usage = RenderAssetUsages::RENDER_WORLD;
    stage.spawn(far, white(), (at, weights([0.0, 1.0])));
    is_near(stage.shadow("render_world_alone"), WHOLE * 2.0 / 1.2);
}

#[test]
fn morphed_and_then_bent() {
    let mut mesh = with_targets(Cuboid::from_size(SLAB_M).into());
    let count = mesh.count_vertices();
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(vec![[0; 4]; count]));
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0f32, 0.0, 0.0, 0.0]; count]);
    let mut stage = Stage::new();
    let world = stage.world();
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY]);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    // The joint scales z by a half; the morph makes the mesh narrow first.
    let double = Transform::from_translation(SLAB_AT).with_scale(Vec3::new(1.0, 1.0, 0.5));
    let joint = world.spawn(double).id();
    let skin = SkinnedMesh { inverse_bindposes, joints: vec![joint] };
    let weights = MeshMorphWeights::Value { weights: vec![1.0, 0.0] };
    stage.spawn(mesh, white(), (skin, weights, Transform::default()));
    is_near(stage.shadow("morphed_and_bent"), WHOLE * 0.8 / 1.2 * 0.5);
}

/// Material of the user's own, whose shader discards by its texture.
#[derive(Asset, AsBindGroup, Clone, TypePath)]
struct Holes {
    #[texture(0)]
    #[sampler(1)]
    texture: Handle<Image>,
}

impl Material for Holes {
    fn fragment_shader() -> ShaderRef {
        "own_material.wesl".into()
    }
}

impl CasterMaterial for Holes {
    fn caster_surface(&self) -> Option<CasterSurface> {
        let texture = SurfaceTexture::of(&self.texture);
        Some(CasterSurface::Masked { texture, alpha_factor: 1.0, cutoff: 0.5 })
    }
}

/// Extension that adds nothing.
#[derive(Asset, AsBindGroup, Clone, Debug, Default, TypePath)]
struct Plain {}

impl MaterialExtension for Plain {}

type Extended = ExtendedMaterial<StandardMaterial, Plain>;

#[test]
fn holes_of_users_own_and_extended_materials() {
    let mut stage = Stage::with(SoftShadows::default(), |app| {
        app.add_plugins((MaterialPlugin::<Holes>::default(), CasterMaterialPlugin::<Holes>::default()));
        app.add_plugins((MaterialPlugin::<Extended>::default(), CasterMaterialPlugin::<Extended>::default()));
    });
    let texture = stage.world().resource_mut::<Assets<Image>>().add(chequered());
    let own = stage.world().resource_mut::<Assets<Holes>>().add(Holes { texture: texture.clone() });
    let base = StandardMaterial { base_color_texture: Some(texture), alpha_mode: AlphaMode::Mask(0.5), ..white() };
    let extended = Extended { base, extension: Plain {} };
    let extended = stage.world().resource_mut::<Assets<Extended>>().add(extended);
    let card = Mesh::from(Plane3d::default().mesh().size(1.2, 1.2));
    let card = stage.world().resource_mut::<Assets<Mesh>>().add(card);
    let at = Transform::from_translation(SLAB_AT);
    let slab = stage.world().spawn((Mesh3d(card.clone()), MeshMaterial3d(own), at)).id();
    is_near(stage.shadow("own_material"), 0.5 * WHOLE);
    stage.world().despawn(slab);
    let slab = stage.world().spawn((Mesh3d(card), MeshMaterial3d(extended.clone()), at)).id();
    is_near(stage.shadow("extended_holes"), 0.5 * WHOLE);
    // Additive blending casts nothing.
    let mut materials = stage.world().resource_mut::<Assets<Extended>>();
    materials.get_mut(&extended).expect("a material").base.alpha_mode = AlphaMode::Add;
    is_near(stage.shadow("extended_adds"), 0.0);
    stage.world().despawn(slab);
}
