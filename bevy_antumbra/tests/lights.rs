//! Lights, cameras and casters that are added, changed and removed while the app runs.

mod common;

use antumbra_scene::Setup;
use bevy::camera::{RenderTarget, Viewport};
use bevy::light::{DirectionalLightShadowMap, SunDisk};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::renderer::RenderDevice;
use bevy_antumbra::{
    AntumbraPlugin, BevyMaps, Counts, NoSoftShadows, ShadowCounts, ShadowDenoise, ShadowQuality, ShadowTechnique,
    SoftShadows,
};
use common::{Headless, Picture, difference, set_shadows, spawn_light, spawn_scene};

const LIGHTS: &str = include_str!("data/lights.toml");

fn overlap(headless: &mut Headless) -> (Setup, Vec<Entity>) {
    let scene = antumbra_scene::builtin::build("overlap").expect("a built-in scene");
    let setup = Setup::from_toml(LIGHTS, std::path::Path::new("lights.toml")).expect("a setup");
    let meshes = spawn_scene(&mut headless.app, &scene);
    (setup, meshes)
}

/// Light is additive: the image of all lights is the sum of the images of each, with and without shadows.
#[test]
fn all_lights_together_are_the_sum_of_each() {
    let mut headless = Headless::new(UVec2::splat(128), SoftShadows::default());
    let (setup, _) = overlap(&mut headless);
    let camera = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((camera, Msaa::Off));
    let lights: Vec<Entity> = setup.lights.iter().map(|light| spawn_light(&mut headless.app, light)).collect();
    let together = headless.picture(6);
    let shown = |headless: &mut Headless, shown: Entity| {
        for light in &lights {
            let visibility = if *light == shown { Visibility::Visible } else { Visibility::Hidden };
            headless.app.world_mut().entity_mut(*light).insert(visibility);
        }
        headless.picture(5)
    };
    let mut sum = together.clone();
    sum.pixels.fill([0.0; 3]);
    for light in &lights {
        let alone = shown(&mut headless, *light);
        for (sum, alone) in sum.pixels.iter_mut().flatten().zip(alone.pixels.iter().flatten()) {
            *sum += alone;
        }
    }
    let most = together.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    together.save("all_lights", 1.0 / most);
    let difference = difference(&together, &sum);
    assert!(difference < 0.01, "they differ by {difference}");
}

#[test]
fn a_light_that_moves_and_grows_is_as_one_that_was_so() {
    let mut headless = Headless::new(UVec2::splat(128), SoftShadows::by(ShadowTechnique::SampleBased));
    let (setup, _) = overlap(&mut headless);
    let camera = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((camera, Msaa::Off));
    let spot = setup.lights.iter().find(|light| light.name == "spot").expect("a spot").clone();
    let mut moved = spot.clone();
    moved.center += glam::Vec3::new(1.5, -1.0, 0.5);
    moved.axis = (glam::Vec3::new(0.5, 0.4, 0.2) - moved.center).normalize();
    moved.shape = antumbra::light::LightShape::Disk { radius_m: 0.5 };

    let first = spawn_light(&mut headless.app, &moved);
    let expected = headless.picture(5);
    headless.app.world_mut().despawn(first);
    let second = spawn_light(&mut headless.app, &spot);
    let before = headless.picture(5);
    assert!(difference(&before, &expected) > 0.1, "the light was to move");
    let transform = common::light_transform(&moved);
    let mut light = headless.app.world_mut().entity_mut(second);
    light.insert(transform);
    light.get_mut::<SpotLight>().expect("a spot").radius = 0.5;
    let after = headless.picture(5);
    assert!(difference(&after, &expected) < 1e-3, "they differ by {}", difference(&after, &expected));
}

#[test]
fn two_cameras_have_masks_of_their_own() {
    let mut headless = Headless::new(UVec2::new(256, 128), SoftShadows::default());
    let (setup, _) = overlap(&mut headless);
    let half = |x: u32| Viewport { physical_position: UVec2::new(x, 0), physical_size: UVec2::splat(128), ..default() };
    let alone: Vec<Picture> = [0, 128]
        .map(|x| {
            let bundle = headless.camera(&setup.camera);
            let camera = headless.app.world_mut().spawn((bundle, Msaa::Off)).id();
            let part = Camera { viewport: Some(half(x)), ..default() };
            headless.app.world_mut().entity_mut(camera).insert((part, of_technique(x)));
            let light = spawn_light(&mut headless.app, &setup.lights[0]);
            let picture = headless.picture(6);
            headless.app.world_mut().despawn(camera);
            headless.app.world_mut().despawn(light);
            picture
        })
        .into();
    for (order, x) in [(0, 0), (1, 128)] {
        let bundle = headless.camera(&setup.camera);
        let camera = headless.app.world_mut().spawn((bundle, Msaa::Off)).id();
        let clear_color = if order == 0 { ClearColorConfig::Default } else { ClearColorConfig::None };
        let part = Camera { viewport: Some(half(x)), order, clear_color, ..default() };
        headless.app.world_mut().entity_mut(camera).insert((part, of_technique(x)));
    }
    spawn_light(&mut headless.app, &setup.lights[0]);
    let both = headless.picture(6);
    let most = both.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    both.save("two_cameras", 1.0 / most);
    let sides = |picture: &Picture, side: usize| Picture {
        size_px: UVec2::splat(128),
        pixels: picture.pixels.chunks(256).flat_map(|row| row[128 * side..][..128].to_vec()).collect(),
    };
    for (side, alone) in alone.iter().enumerate() {
        let difference = difference(&sides(alone, side), &sides(&both, side));
        assert!(difference < 1e-3, "camera {side} differs by {difference} from itself alone");
    }
    assert!(difference(&sides(&both, 0), &sides(&both, 1)) > 0.05, "each camera has its own technique");
}

/// Returns hard shadows for the left camera and soft shadows for the right one.
fn of_technique(x: u32) -> SoftShadows {
    SoftShadows::by(if x == 0 { ShadowTechnique::Hard } else { ShadowTechnique::Pcss })
}

fn counts(headless: &Headless) -> Counts {
    headless.app.world().resource::<ShadowCounts>().get()
}

#[test]
fn frames_that_only_move_make_no_object() {
    let mut headless = Headless::new(UVec2::splat(96), SoftShadows::default());
    let (setup, meshes) = overlap(&mut headless);
    let camera = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((camera, Msaa::Off));
    let lights: Vec<Entity> = setup.lights.iter().map(|light| spawn_light(&mut headless.app, light)).collect();
    let shake = |headless: &mut Headless, frame: u32| {
        let mut transforms = headless.app.world_mut().query::<&mut Transform>();
        for entity in meshes[1..].iter().chain(&lights) {
            if let Ok(mut transform) = transforms.get_mut(headless.app.world_mut(), *entity) {
                transform.translation.x += 0.01 * (frame as f32).sin();
            }
        }
        headless.run(1);
    };
    (0..12).for_each(|frame| shake(&mut headless, frame));
    let before = counts(&headless);
    assert_eq!((before.lights, before.casters), (4, meshes.len()));
    (12..40).for_each(|frame| shake(&mut headless, frame));
    let after = counts(&headless);
    assert_eq!(after.objects_created, before.objects_created, "objects were made while all only moved");
    assert_eq!(after.memory_bytes, before.memory_bytes);
}

/// Test scene: a spot and a sun with Bevy's own shadows, beside a rectangle and a point with the plugin's.
struct Beside {
    headless: Headless,
    /// Bevy's lights: a spot and a sun.
    left_alone: [Entity; 2],
    /// The plugin's lights: a rectangle and a point.
    ours: [Entity; 2],
}

impl Beside {
    fn new(samples: Msaa, map_size: usize) -> Self {
        let mut headless = Headless::new(UVec2::splat(128), SoftShadows::default());
        let (setup, _) = overlap(&mut headless);
        headless.app.insert_resource(DirectionalLightShadowMap { size: map_size });
        let camera = headless.camera(&setup.camera);
        headless.app.world_mut().spawn((camera, samples));
        let named = |name: &str| setup.lights.iter().find(|light| light.name == name).expect("a light of this name");
        let left_alone = ["spot", "sun"].map(|name| spawn_light(&mut headless.app, named(name)));
        let ours = ["rectangle", "point"].map(|name| spawn_light(&mut headless.app, named(name)));
        // About as bright on the ground as the others.
        if let Some(mut spot) = headless.app.world_mut().get_mut::<SpotLight>(left_alone[0]) {
            spot.intensity = 2e7;
        }
        if let Some(mut sun) = headless.app.world_mut().get_mut::<DirectionalLight>(left_alone[1]) {
            sun.illuminance = 2e4;
        }
        Self { headless, left_alone, ours }
    }

    fn leave_alone(&mut self) {
        for light in self.left_alone {
            self.headless.app.world_mut().entity_mut(light).insert(NoSoftShadows);
        }
    }

    fn show(&mut self, lights: [Entity; 2], are_shown: bool) {
        let visibility = if are_shown { Visibility::Visible } else { Visibility::Hidden };
        for light in lights {
            self.headless.app.world_mut().entity_mut(light).insert(visibility);
        }
    }

    /// Checks that light is additive: the image of all lights is the sum of Bevy's lights alone and the plugin's alone.
    fn judge(&mut self, name: &str) -> [Picture; 3] {
        let both = self.headless.picture(8);
        let most = both.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
        both.save(name, 1.0 / most);
        self.show(self.left_alone, false);
        let of_ours = self.headless.picture(6);
        self.show(self.left_alone, true);
        self.show(self.ours, false);
        let of_bevy = self.headless.picture(6);
        self.show(self.ours, true);
        let mut sum = of_ours.clone();
        for (sum, of_bevy) in sum.pixels.iter_mut().flatten().zip(of_bevy.pixels.iter().flatten()) {
            *sum += of_bevy;
        }
        let difference = difference(&both, &sum);
        assert!(difference < 0.01, "{name}: both together differ from each alone by {difference}");
        of_bevy.save(&format!("{name}_bevys"), 1.0 / most);
        of_ours.save(&format!("{name}_ours"), 1.0 / most);
        [both, of_ours, of_bevy]
    }
}

#[test]
fn lights_that_are_left_alone_keep_bevys_own_shadows() {
    // Maps larger than the view, and smaller ones, with which masks are cut into tiles.
    for (name, samples, map_size) in [
        ("beside_large_maps", Msaa::Off, 512),
        ("beside_small_maps", Msaa::Off, 64),
        ("beside_maps_at_four_samples", Msaa::Sample4, 64),
    ] {
        let mut beside = Beside::new(samples, map_size);
        // At first all lights are the plugin's, so that Bevy's maps appear while the app runs.
        let all_ours = beside.headless.picture(6);
        beside.leave_alone();
        let [both, of_ours, of_bevy] = beside.judge(name);
        let others = difference(&both, &all_ours);
        println!("{name}: the plugin's shadows of all four differ by {others:.3}");
        assert!(others > 0.05, "Bevy's shadows of a spot are others than ours");
        for (light, picture) in [(beside.left_alone[0], &of_bevy), (beside.ours[0], &of_ours)] {
            set_shadows(&mut beside.headless.app, light, false);
            let without = beside.headless.picture(6);
            set_shadows(&mut beside.headless.app, light, true);
            assert!(difference(&both, &without) > 0.05, "{name}: {light} casts nothing");
            assert!(difference(picture, &without) > 0.05);
        }
    }
}

/// Surfaces with a mask are unaffected by Bevy's maps of spots, points and suns.
#[test]
fn maps_beside_masks_change_no_opaque_surface() {
    let mut headless = Headless::new(UVec2::splat(128), SoftShadows::default());
    let (setup, _) = overlap(&mut headless);
    let camera = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((camera, Msaa::Off));
    for of in &setup.lights {
        let light = spawn_light(&mut headless.app, of);
        let mut by = |maps| {
            headless.app.world_mut().entity_mut(light).insert(SoftShadows::default().beside(maps));
            headless.picture(6)
        };
        let (alone, beside) = (by(BevyMaps::Never), by(BevyMaps::Always));
        let apart = difference(&alone, &beside);
        assert!(apart < 1e-3, "{}: they differ by {apart}", of.name);
        // The mask's shadows exist and differ from Bevy's.
        headless.app.world_mut().entity_mut(light).insert(NoSoftShadows);
        let of_bevy = headless.picture(6);
        assert!(difference(&alone, &of_bevy) > 0.05, "{}: Bevy's shadows are the same", of.name);
        headless.app.world_mut().despawn(light);
    }
}

#[test]
fn denoised_masks_have_less_noise_and_the_papers_quality_is_another() {
    let mut headless = Headless::new(UVec2::splat(128), SoftShadows::default());
    let (setup, _) = overlap(&mut headless);
    let camera = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((camera, Msaa::Off));
    let light = spawn_light(&mut headless.app, &setup.lights[0]);
    let mut by = |settings: SoftShadows| {
        headless.app.world_mut().entity_mut(light).insert(settings);
        headless.picture(24)
    };
    let fast = SoftShadows::by(ShadowTechnique::Pcss).at(ShadowQuality::Fast);
    let smooth = by(SoftShadows::by(ShadowTechnique::Pcss).at(ShadowQuality::Best));
    let noisy = by(fast.clone());
    let denoised = by(fast.clone().denoised(ShadowDenoise::default()));
    let paper = by(SoftShadows::by(ShadowTechnique::Pcss).at(ShadowQuality::Paper));
    let (before, after) = (rmse(&noisy, &smooth), rmse(&denoised, &smooth));
    println!(
        "beside the best quality: {before:.4} as it comes, {after:.4} denoised, {:.4} the paper's",
        rmse(&paper, &smooth)
    );
    assert!(after < 0.9 * before, "{after:.4} denoised, {before:.4} as it comes");
    assert!(rmse(&by(fast), &noisy) < 1e-4, "denoising can be turned off again");
    assert!(rmse(&paper, &smooth) > 1e-3, "the paper's algorithm is another one than the best");
}

/// Returns the root mean square difference of two images, relative to the brightest value of the first.
fn rmse(a: &Picture, b: &Picture) -> f32 {
    let most = a.pixels.iter().flatten().fold(0.0f32, |most, v| most.max(*v));
    let values = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    let sum: f32 = values.map(|(a, b)| ((a - b) / most).powi(2)).sum();
    (sum / (3 * a.pixels.len()) as f32).sqrt()
}

/// Deterministic random number generator, so that failures are reproducible.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % n
    }
    fn unit(&mut self) -> f32 {
        self.below(1 << 20) as f32 / (1 << 20) as f32
    }
}

/// Adds and removes lights, cameras and meshes at random: no panic and no validation error (which ends the app). When all are
/// removed, little memory is held: the maps' first pages. Without the plugin the same sequence runs on Bevy alone.
fn come_and_go(frames: u32, has_plugin: bool) {
    let mut headless = Headless::bare(UVec2::splat(48));
    if has_plugin {
        let settings = SoftShadows::default().at(ShadowQuality::Fast);
        headless.app.add_plugins(AntumbraPlugin { settings });
    }
    headless.finish();
    let (setup, _) = overlap(&mut headless);
    let mut random = Random(7);
    let target = headless.camera(&setup.camera);
    headless.app.world_mut().spawn((target, Msaa::Off));
    let world = headless.app.world_mut();
    let shapes: Vec<Handle<Mesh>> = {
        let mut meshes = world.resource_mut::<Assets<Mesh>>();
        vec![meshes.add(Cuboid::from_length(0.3)), meshes.add(Sphere::new(0.2)), meshes.add(Torus::new(0.1, 0.2))]
    };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::default());
    let mut there: Vec<Entity> = Vec::new();
    let mut most = 0;
    // Forty reports in all.
    let mut held = Vec::new();
    for frame in 0..frames {
        let place = Vec3::new(4.0 * random.unit() - 2.0, 0.5 + 3.0 * random.unit(), 4.0 * random.unit() - 2.0);
        let kind = random.below(8);
        if kind < 3 && there.len() < 24 {
            let transform = Transform::from_translation(place).looking_at(Vec3::ZERO, Vec3::X);
            let technique = ShadowTechnique::ALL[random.below(ShadowTechnique::ALL.len() as u64) as usize];
            let camera = headless.camera(&setup.camera);
            let world = headless.app.world_mut();
            let entity = match random.below(7) {
                0 => world.spawn((RectLight::default(), transform)).id(),
                1 => world.spawn((PointLight { shadow_maps_enabled: true, radius: 0.1, ..default() }, transform)).id(),
                2 => world.spawn((SpotLight { shadow_maps_enabled: true, radius: 0.1, ..default() }, transform)).id(),
                3 => {
                    let sun = DirectionalLight { shadow_maps_enabled: true, ..default() };
                    world.spawn((sun, SunDisk::MARS, transform)).id()
                }
                4 => {
                    // Same sample count as the other cameras: Bevy shares one depth texture among cameras of one target.
                    let viewport = Viewport { physical_size: UVec2::new(32, 24), ..default() };
                    let order = 1 + there.len() as isize;
                    let camera = world.spawn((camera, Msaa::Off)).id();
                    let part =
                        Camera { order, viewport: Some(viewport), clear_color: ClearColorConfig::None, ..default() };
                    world.entity_mut(camera).insert(part).id()
                }
                _ => {
                    let mesh = Mesh3d(shapes[random.below(3) as usize].clone());
                    world.spawn((mesh, MeshMaterial3d(material.clone()), transform)).id()
                }
            };
            if random.below(3) == 0 {
                world.entity_mut(entity).insert(SoftShadows::by(technique).at(ShadowQuality::Fast));
            }
            there.push(entity);
        } else if kind < 6 && !there.is_empty() {
            let entity = there.swap_remove(random.below(there.len() as u64) as usize);
            headless.app.world_mut().despawn(entity);
        } else if !there.is_empty() {
            let is_left_alone = random.below(2) == 0;
            let entity = there[random.below(there.len() as u64) as usize];
            let mut entity = headless.app.world_mut().entity_mut(entity);
            if is_left_alone {
                entity.insert(NoSoftShadows);
            } else {
                entity.remove::<NoSoftShadows>();
            }
        }
        headless.run(1);
        if has_plugin {
            most = most.max(counts(&headless).memory_bytes);
        }
        if (frame + 1) % (frames / 40).max(1) == 0 {
            held.push(Held::now(&headless));
            println!("frame {}: {:.0?}, {} things", frame + 1, held[held.len() - 1], there.len());
        }
    }
    if !has_plugin {
        return;
    }
    for entity in there {
        headless.app.world_mut().despawn(entity);
    }
    // One more light triggers the removal of unused resources.
    let light = spawn_light(&mut headless.app, &setup.lights[0]);
    headless.run(12);
    set_shadows(&mut headless.app, light, false);
    headless.run(12);
    let rest = counts(&headless);
    assert_eq!(rest.lights, 0);
    println!("at most {} KiB, at the end {} KiB", most / 1024, rest.memory_bytes / 1024);
    assert!(most > 1 << 20, "there were lights with maps");
    assert!(rest.memory_bytes < most / 8, "{} KiB are held when all is gone", rest.memory_bytes / 1024);
    // All techniques occur in the first half. From then on the peak GPU memory of lights and casters must not grow.
    let max_mib = |held: &[Held]| held.iter().filter_map(|held| held.gpu_mib).reduce(f64::max);
    let (first, second) = held.split_at(held.len() / 2);
    if frames >= 1000
        && let (Some(first), Some(second)) = (max_mib(first), max_mib(second))
    {
        assert!(second < 1.25 * first + 64.0, "the GPU's memory grew from {first:.0} to {second:.0} MiB at most");
    }
}

/// Memory in use, MiB, where it can be determined.
#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "printed")]
struct Held {
    /// Memory of the device, of all users.
    gpu_mib: Option<f64>,
    /// Memory of the process. On a software adapter this includes all compiled programs, which it keeps.
    process_mib: Option<f64>,
}

impl Held {
    fn now(headless: &Headless) -> Self {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let device = headless.app.sub_app(RenderApp).world().resource::<RenderDevice>();
        let report = device.wgpu_device().generate_allocator_report();
        let pages = std::fs::read_to_string("/proc/self/statm").ok();
        let pages: Option<u64> = pages.and_then(|pages| pages.split_whitespace().nth(1)?.parse().ok());
        Self {
            gpu_mib: report.map(|report| mib(report.total_allocated_bytes)),
            process_mib: pages.map(|pages| mib(4096 * pages)),
        }
    }
}

#[test]
fn lights_and_casters_added_and_removed_at_random() {
    come_and_go(150, true);
}

#[test]
#[ignore = "takes many minutes"]
fn lights_and_casters_added_and_removed_for_long() {
    come_and_go(2000, true);
}

/// Measures how much of the process's growth is due to Bevy and the driver.
#[test]
#[ignore = "takes many minutes; to compare with"]
fn lights_and_casters_added_and_removed_without_the_plugin() {
    come_and_go(2000, false);
}

/// Cameras with a target that the plugin does not know must not fail.
#[test]
fn a_camera_of_no_size() {
    let mut headless = Headless::new(UVec2::splat(32), SoftShadows::default());
    let (setup, _) = overlap(&mut headless);
    spawn_light(&mut headless.app, &setup.lights[0]);
    let none = RenderTarget::None { size: UVec2::ZERO };
    headless.app.world_mut().spawn((Camera3d::default(), none));
    headless.run(6);
}
