//! Casters with unknown or large bounds: geometry outside a light's depth range does not affect masks.

use antumbra::TechniqueKind;
use antumbra::light::{Aabb, Light, LightShape};
use antumbra_host_tests::device::Device;
use antumbra_host_tests::host::{HostCasters, in_buffer, kind_of, mask_of, matrix_buffer};
use antumbra_host_tests::raster::Picture;
use antumbra_host_tests::rays::{Rays, Truth, rmse};
use antumbra_host_tests::scene::{Camera, Scene, base_light, base_light_of};
use glam::{Mat4, Vec3};

/// Light samples of the reference.
const POINTS: u32 = 256;

/// Maximum change of a mask's error due to bounds. Without bounds of receivers, texels are larger, and a lamp's view is split into rings
/// that known bounds would show to be empty (the error of `pcss` under the lamp is .0083 in one view, .0119 in several).
const MAX_MORE: f64 = 0.004;

/// The base scene with every object's matrix in a buffer, with the same bounds for all.
fn gpu_driven(device: &Device, scene: &Scene, bounds: Option<Aabb>) -> HostCasters {
    let matrices: Vec<Mat4> = scene.objects.iter().map(|object| object.world_from_object).collect();
    let buffer = matrix_buffer(device, &matrices);
    HostCasters::with(device, scene, |i, _| Some(in_buffer(&buffer, i as u64, 1, bounds)))
}

fn cube(half_m: f32) -> Option<Aabb> {
    Some(Aabb { min: Vec3::splat(-half_m), max: Vec3::splat(half_m) })
}

struct Base {
    device: &'static Device,
    scene: Scene,
    picture: Picture,
    lights: [(Light, Truth); 2],
}

impl Base {
    /// Draws the base scene for its own lamp and for a sun.
    fn new(ground_half_m: f32) -> Option<Self> {
        let device = Device::shared()?;
        let camera = Camera::base();
        let scene = Scene::base(ground_half_m);
        let rays = Rays::new(&scene);
        let lights = [base_light(), base_light_of(LightShape::Sun { angular_diameter_rad: 0.03 })];
        let lights = lights.map(|light| {
            let truth = rays.visibility(&camera, &light, POINTS);
            (light, truth)
        });
        Some(Self { device, picture: Picture::draw(device, &scene, &camera), scene, lights })
    }

    /// Error of a mask with default parameters; `bounds` are the receivers' bounds, if the host knows them.
    fn error(&self, kind: TechniqueKind, casters: &HostCasters, of_light: usize, bounds: Option<Aabb>) -> f64 {
        rmse(&self.mask(kind, casters, of_light, bounds), &self.lights[of_light].1)
    }

    fn mask(&self, kind: TechniqueKind, casters: &HostCasters, of_light: usize, bounds: Option<Aabb>) -> Vec<f32> {
        let mut shadow = kind.create(&self.device.gpu).expect("any device");
        let receivers = self.picture.receivers().with_bounds(bounds);
        mask_of(self.device, &mut shadow, &self.lights[of_light].0, casters.all(), receivers)
    }
}

/// Techniques that use the depths of maps in different ways.
const TECHNIQUES: [&str; 4] = ["pcss", "multi_layer", "essm", "sample_based"];

#[test]
fn bounds_of_instances_may_reach_far_or_be_unknown() {
    masks_are_as_good_with(&[cube(1e4), None]);
}

#[test]
#[ignore = "long"]
fn bounds_of_instances_may_reach_any_distance() {
    masks_are_as_good_with(&[cube(1e3), cube(1e6), Some(Aabb::EVERYTHING)]);
}

fn masks_are_as_good_with(bounds: &[Option<Aabb>]) {
    let Some(base) = Base::new(10.0) else { return };
    // The baseline uses buffers, too, because the library cannot know whether matrices in buffers mirror objects.
    let known = gpu_driven(base.device, &base.scene, Some(base.scene.bounds()));
    let far: Vec<_> = bounds.iter().map(|bounds| gpu_driven(base.device, &base.scene, *bounds)).collect();
    for name in TECHNIQUES {
        for (of_light, light) in ["lamp", "sun"].into_iter().enumerate() {
            for receivers in [Some(base.scene.bounds()), None] {
                let of_known = base.error(kind_of(name), &known, of_light, receivers);
                let errors: Vec<_> =
                    far.iter().map(|casters| base.error(kind_of(name), casters, of_light, receivers)).collect();
                println!("{name}, {light}, receivers {}: {of_known:.4} {errors:.4?}", receivers.is_some());
                for (error, bounds) in errors.iter().zip(bounds) {
                    assert!(
                        *error < of_known + MAX_MORE,
                        "{name}, {light}: {error} of {bounds:?}, {of_known} of known"
                    );
                }
            }
        }
    }
}

/// A ground that extends to the horizon, with bounds of that size.
#[test]
fn a_ground_may_reach_to_the_horizon() {
    let Some(near) = Base::new(10.0) else { return };
    let Some(far) = Base::new(1e4) else { return };
    let casters = [&near, &far].map(|base| HostCasters::new(base.device, &base.scene));
    for name in TECHNIQUES {
        let errors = [(&near, &casters[0]), (&far, &casters[1])]
            .map(|(base, casters)| base.error(kind_of(name), casters, 0, None));
        println!("{name}: {errors:.4?}");
        assert!(errors[1] < errors[0] + 0.02, "{name}: {errors:?}");
    }
}
