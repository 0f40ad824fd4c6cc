//! Tests of accumulation: its limit, and the changes that restart it.

use antumbra_light::{Aabb, Light, LightShape};
use glam::{Mat4, Vec3};

use crate::TechniqueKind;
use crate::casters::tests::{set_of, update};
use crate::casters::{CasterSet, Instances};
use crate::contract::{MeshCaster, Receivers};
use crate::gpu::Gpu;
use crate::shadow::AnyShadow;
use crate::shadow::{Casters, Frame};
use crate::testing::{Case, Mesh, RECTANGLE, gpu, half_plane_visibility, rmse, run, test_ground};

mod irradiance;
mod subset;

const SAMPLES: usize = 16;

fn sample_based(gpu: &Gpu, settings: &[(&str, &str)]) -> AnyShadow {
    let mut technique = TechniqueKind::SampleBased.create(gpu).expect("a device with WebGPU's limits");
    for (key, value) in [("samples", "16"), ("sample_set", "r2")].iter().chain(settings) {
        technique.set(key, value).expect("a parameter");
    }
    technique
}

/// Half-plane case whose casters have huge bounds, so that only their buffers' content shows where they are.
struct Still {
    case: Case,
}

impl Still {
    fn new(gpu: &Gpu, shape: LightShape) -> Self {
        Self { case: Case::half_plane(gpu, shape) }
    }

    fn frame(&self, gpu: &Gpu, technique: &mut AnyShadow) -> Vec<f32> {
        self.changed(gpu, technique, &self.case.light, Mat4::IDENTITY)
    }

    /// Returns a frame with another light and a rotated camera.
    fn changed(&self, gpu: &Gpu, technique: &mut AnyShadow, light: &Light, turn: Mat4) -> Vec<f32> {
        let bounds = Aabb { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) };
        let caster = |mesh| MeshCaster { bounds, ..Mesh::caster(mesh) };
        let casters: Vec<_> = self.case.meshes.iter().map(caster).collect();
        self.case.with_frame(Casters::Meshes(&casters), |frame| {
            let view_from_world = frame.receivers.view_from_world * turn;
            let receivers = Receivers { view_from_world, ..frame.receivers };
            run(gpu, technique, &Frame { light, receivers, ..*frame }).expect("a good frame")
        })
    }
}

/// Whether a mask is of one frame: multiples of 1/16 alone.
fn is_of_one_frame(mask: &[f32]) -> bool {
    mask.iter().all(|v| (v * SAMPLES as f32).fract() == 0.0)
}

#[test]
fn frames_of_a_still_scene_come_closer_to_the_truth() {
    let Some(gpu) = gpu() else { return };
    let still = Still::new(gpu, RECTANGLE);
    let pixels = still.case.ground_pixels(test_ground);
    let alone = still.frame(gpu, &mut sample_based(gpu, &[]));
    for settings in [&[("accumulate", "true")][..], &[("accumulate", "true"), ("rotate", "true")]] {
        let mut technique = sample_based(gpu, settings);
        let mut errors = Vec::new();
        for i in 0..16 {
            let mask = still.frame(gpu, &mut technique);
            if i == 0 && settings.len() == 1 {
                assert_eq!(mask, alone, "the first frame is the technique's own");
            }
            errors.push(rmse(&pixels, &mask, |p| half_plane_visibility(p.x, 1.0)));
        }
        println!("{settings:?}: {errors:.4?}");
        assert!(errors[15] < 0.25 * errors[0] && errors[3] < 0.6 * errors[0], "{settings:?}: {errors:?}");
    }
}

/// The change of the mean of n frames yields the last frame: multiples of 1/16, like any single frame.
#[test]
fn each_frame_counts_as_much_as_the_others() {
    let Some(gpu) = gpu() else { return };
    let still = Still::new(gpu, RECTANGLE);
    let mut technique = sample_based(gpu, &[("accumulate", "true")]);
    let mut before = still.frame(gpu, &mut technique);
    for n in 2..=5 {
        let mean = still.frame(gpu, &mut technique);
        let last: Vec<f32> =
            mean.iter().zip(&before).map(|(mean, before)| n as f32 * mean - (n - 1) as f32 * before).collect();
        assert!(mean != before, "frame {n} is as the ones before");
        let off = last.iter().map(|v| v * SAMPLES as f32).map(|v| (v - v.round()).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "frame {n} is off sixteenths by {off} of one");
        before = mean;
    }
}

#[test]
fn whatever_moves_begins_anew() {
    let Some(gpu) = gpu() else { return };
    let still = Still::new(gpu, RECTANGLE);
    let moved_light = Light { center: Vec3::new(0.1, 4.0, 0.0), ..still.case.light.clone() };
    let turned = Mat4::from_rotation_y(0.01);
    let push_occluder = |by: f32| {
        let pose = Mat4::from_translation(by * Vec3::X);
        gpu.queue().write_buffer(&still.case.meshes[1].instances, 0, bytemuck::bytes_of(&pose));
    };
    let mut technique = sample_based(gpu, &[("accumulate", "true")]);
    let settle = |technique: &mut AnyShadow| {
        let masks = [0; 3].map(|_| still.frame(gpu, technique));
        assert!(!is_of_one_frame(&masks[2]), "three frames have not been added up");
    };

    settle(&mut technique);
    let mask = still.changed(gpu, &mut technique, &moved_light, Mat4::IDENTITY);
    assert!(is_of_one_frame(&mask), "the light moved");
    settle(&mut technique);
    let mask = still.changed(gpu, &mut technique, &still.case.light, turned);
    assert!(is_of_one_frame(&mask), "the camera moved");
    settle(&mut technique);
    push_occluder(0.05);
    let mask = still.frame(gpu, &mut technique);
    assert!(is_of_one_frame(&mask), "a caster moved, and only its buffer tells");
    let pixels = still.case.ground_pixels(test_ground);
    let error = rmse(&pixels, &mask, |p| half_plane_visibility(p.x - 0.05 / (1.0 - 0.375), 1.0));
    assert!(error < 0.04, "rmse {error} to where the caster is now");
    settle(&mut technique);
    technique.set("seed", "2").expect("a parameter");
    assert!(is_of_one_frame(&still.frame(gpu, &mut technique)), "a setting changed");
}

/// The version of a caster set shows what moves, without reading its buffers.
#[test]
fn a_set_tells_what_moves() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let (mut set, casters) = set_of(gpu, &case);
    update(gpu, &mut set);
    let mut technique = sample_based(gpu, &[("accumulate", "true")]);
    let mut frame = |set: &CasterSet| {
        case.with_frame(Casters::Set { set, layers: u32::MAX }, |frame| {
            run(gpu, &mut technique, frame).expect("a good frame")
        })
    };
    let masks = [0; 3].map(|_| frame(&set));
    assert!(is_of_one_frame(&masks[0]) && !is_of_one_frame(&masks[2]), "three frames have not been added up");
    let pose = [Mat4::from_translation(0.05 * Vec3::X)];
    set.set_instances(casters[1], Instances::Matrices(&pose)).expect("the set's own");
    update(gpu, &mut set);
    let mask = frame(&set);
    assert!(is_of_one_frame(&mask), "a caster moved");
    let pixels = case.ground_pixels(test_ground);
    let error = rmse(&pixels, &mask, |p| half_plane_visibility(p.x - 0.05 / (1.0 - 0.375), 1.0));
    assert!(error < 0.04, "rmse {error} to where the caster is now");
    assert!(!is_of_one_frame(&frame(&set)), "and stands again");
}
