//! `ray_traced` against the ray tracer with the same light samples: on every built-in scene, and under lights of every kind.

use antumbra::TechniqueKind;
use antumbra_lab::device::LabDevice;
use antumbra_light::{Light, LightShape, SampleSet};
use antumbra_reference::VisibilityOptions;
use antumbra_scene::builtin::NAMES;
use glam::{UVec2, Vec2};

use crate::common::{Judged, lab};
use crate::lights::{Change, LIGHTS};
use crate::sample_based::Same;

/// Required RMSE against the ray tracer with 256 samples.
const BOUND: f64 = 0.003;

/// Bound for blades nearer to each other than the ray offset, because the tracer's offset differs. With the technique's
/// offset `sample_based` gives the same masks as `ray_traced` (`rays_find_what_bits_find`).
const WITHIN_OFFSETS: (&str, f64) = ("builtin:ring-in-grass", 0.006);

/// Image size: small, because 256 rays per pixel are slow on a software device.
const SIZE: UVec2 = UVec2::new(80, 45);

/// The same samples at every pixel of both.
const OPTIONS: VisibilityOptions =
    VisibilityOptions { samples: 256, set: SampleSet::Sobol, seed: 1, same_set_for_all_pixels: true };
const SETTINGS: [(&str, &str); 2] = [("samples", "256"), ("rotate", "false")];

/// RMSE without the worst thousandth of the pixels: where casters intersect (`ten-knots`), rounding of a receiver's
/// position decides on which side of a closed caster it is.
fn rmse(lab: &LabDevice, spec: &str, change: impl FnOnce(&mut Light)) -> f64 {
    let same = Same::of_size(lab, SIZE, spec, change);
    let errors = same.errors_to_either(&OPTIONS, &same.mask(lab, TechniqueKind::RayTraced, &SETTINGS));
    let all = root_mean_square(&errors);
    let most = root_mean_square(&errors[..errors.len() - errors.len() / 1000]);
    println!("{spec}: rmse {all:.5} over all, {most:.5} over 999 of 1000");
    most
}

fn root_mean_square(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

/// Sample bits of `sample_based` and rays are equivalent: they agree for any receiver position.
#[test]
fn rays_find_what_bits_find() {
    let Some(lab) = lab() else { return };
    let bits = [("samples", "256"), ("sample_set", "sobol"), ("seed", "1")];
    for spec in ["builtin:ten-knots", "builtin:ring-in-grass", "builtin:hall", "builtin:staircase"] {
        let same = Same::of_size(lab, SIZE, spec, |_| {});
        let by_rays = same.mask(lab, TechniqueKind::RayTraced, &SETTINGS);
        let by_bits = same.mask(lab, TechniqueKind::SampleBased, &bits);
        let squares: f64 = by_rays.iter().zip(&by_bits).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        let apart = (squares / by_rays.len() as f64).sqrt();
        println!("{spec}: {apart:.6} apart");
        assert!(apart < 3e-4, "{spec}: {apart}");
    }
}

/// Coloured masks; receivers come from the tracer's own camera rays.
#[test]
fn colours_are_as_the_ray_tracer_has_them() {
    let Some(lab) = lab() else { return };
    let judged = Judged::set_up(UVec2::new(96, 54), "builtin:stained-glass", &OPTIONS, |_| {});
    assert_eq!(judged.truth.visibility.channel_count(), 3);
    let mask = judged.run(lab, TechniqueKind::RayTraced, &SETTINGS);
    let rmse = judged.metrics(&mask).rmse.expect("judged pixels");
    println!("rmse {rmse:.5}");
    assert!(rmse < BOUND, "{rmse}");
}

/// Scenes with more than a hundred thousand triangles.
const LARGE: [&str; 5] = ["ten-knots", "ring-in-grass", "grove", "town", "street"];

#[test]
fn every_scene_is_as_the_ray_tracer_has_it() {
    hold_to_the_ray_tracer(|name| !LARGE.contains(&name));
}

#[test]
#[ignore = "long"]
fn large_scenes_are_as_the_ray_tracer_has_them() {
    hold_to_the_ray_tracer(|name| LARGE.contains(&name));
}

fn hold_to_the_ray_tracer(is_wanted: impl Fn(&str) -> bool) {
    let Some(lab) = lab() else { return };
    let mut far = Vec::new();
    for scene in NAMES.iter().filter(|scene| is_wanted(scene.name)) {
        let spec = format!("builtin:{}", scene.name);
        let error = rmse(lab, &spec, |_| {});
        let bound = if spec == WITHIN_OFFSETS.0 { WITHIN_OFFSETS.1 } else { BOUND };
        if error > bound {
            far.push((spec, error));
        }
    }
    assert!(far.is_empty(), "{far:?}");
}

#[test]
fn every_light_is_as_the_ray_tracer_has_it() {
    let Some(lab) = lab() else { return };
    let one_point: Change = ("one point", |light| light.shape = LightShape::Rectangle { size_m: Vec2::ZERO });
    let mut far = Vec::new();
    for spec in ["builtin:columns", "builtin:stained-glass", "builtin:tree-alpha"] {
        for (name, change) in LIGHTS.into_iter().chain([one_point]) {
            let error = rmse(lab, spec, change);
            println!("{name}: {error:.5}");
            if error > BOUND {
                far.push((spec, name, error));
            }
        }
    }
    assert!(far.is_empty(), "{far:?}");
}
