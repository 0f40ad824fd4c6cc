//! Tests of taps against the light's shapes, and of lights on a receiver's horizon against closed forms.

use std::f32::consts::PI;

use antumbra_light::{Light, LightShape, SampleSet};
use glam::{Vec2, Vec3};

use super::taps::Taps;
use crate::TechniqueKind;
use crate::shadow::Casters;
use crate::testing::{Case, gpu, half_plane_ratio_errors, rmse, test_ground};

/// Height of the light's centre above the ground, and half the light's size.
const HEIGHT_M: f32 = 0.1;
const HALF_M: f32 = 0.5;

/// Lights beside the ground that face along it, with the fraction of each above the ground.
fn lights_on_the_horizon() -> Vec<(LightShape, f32)> {
    let h: f32 = HEIGHT_M / HALF_M;
    let disc = ((-h).acos() + h * (1.0 - h * h).sqrt()) / PI;
    let [above, below] = [0.2, -0.2].map(|y| Vec3::new(-6.0, y, 0.0));
    vec![
        (LightShape::Rectangle { size_m: Vec2::splat(2.0 * HALF_M) }, 0.5 * (1.0 + h)),
        (LightShape::Disk { radius_m: HALF_M }, disc),
        (LightShape::Sphere { radius_m: HALF_M }, disc),
        (LightShape::Ellipsoid { radii_m: Vec3::splat(HALF_M) }, 0.25 * (1.0 + h).powi(2) * (2.0 - h)),
        (LightShape::Sun { angular_diameter_rad: 0.1 }, 0.5),
        (LightShape::Points { positions_m: vec![above, below] }, 0.5),
    ]
}

fn on_the_horizon(shape: LightShape) -> Light {
    let place = Vec3::new(-6.0, HEIGHT_M, 0.0);
    Light::new(shape, place, place + Vec3::X)
}

#[test]
fn places_lie_in_the_light_s_shape() {
    for (shape, _) in lights_on_the_horizon() {
        let light = on_the_horizon(shape);
        let taps = Taps { light: &light, set: SampleSet::R2, seed: 3, run: 0 };
        let places = taps.of_filter(256);
        assert_eq!(places.len(), 256);
        let radius = places.iter().map(|q| q.truncate().length()).fold(0.0, f32::max);
        match &light.shape {
            LightShape::Rectangle { .. } => assert!(places.iter().all(|q| q.cmpge(glam::Vec4::ZERO).all())),
            LightShape::Points { positions_m } => {
                let frame = light.frame();
                for (i, q) in places.iter().enumerate() {
                    let p = frame.center + frame.right * q.x + frame.up * q.y + frame.axis * q.z;
                    assert!(p.distance(positions_m[i / 128]) < 1e-4, "tap {i} at {p}");
                }
            }
            _ => assert!((0.9..=1.0 + 1e-6).contains(&radius), "{:?}: radius {radius}", light.shape),
        }
        assert_eq!(taps.are_progressive(), !matches!(light.shape, LightShape::Points { .. }));
        // Scales are spread evenly over their range.
        let scales: Vec<f32> = taps.of_search(256).iter().map(|tap| tap.w).collect();
        let mean = scales.iter().sum::<f32>() / 256.0;
        assert!((mean - 0.5).abs() < 0.01 && scales.iter().all(|s| (0.0..1.0).contains(s)), "mean scale {mean}");
    }
}

#[test]
fn what_the_horizon_leaves_of_a_light_is_its_closed_form() {
    let Some(gpu) = gpu() else { return };
    for (shape, share) in lights_on_the_horizon() {
        let mut case = Case::half_plane(gpu, shape.clone());
        case.light = on_the_horizon(shape);
        // Techniques with one lookup for the whole light treat a list of points as its centre, or count it.
        let is_list = matches!(case.light.shape, LightShape::Points { .. });
        let others = [TechniqueKind::PcssAnisotropic, TechniqueKind::Essm, TechniqueKind::MultiLayer];
        for kind in [TechniqueKind::Pcss].iter().chain(others.iter().filter(|_| !is_list)) {
            let mask = case.run_with(gpu, *kind, &[], Casters::Meshes(&[])).expect("nothing to cast");
            let error = rmse(&case.ground_pixels(test_ground), &mask, |_| share);
            println!("{kind}, {:?}: share {share}, rmse {error}", case.light.shape);
            assert!(error < 0.01, "{kind}, {:?}: rmse {error} about {share}", case.light.shape);
        }
    }
}

#[test]
fn rays_through_the_map_have_lambert_s_part_of_the_irradiance() {
    let Some(gpu) = gpu() else { return };
    let settings = [("map_size", "1024"), ("samples", "1024"), ("smooth", "false")];
    let [ours, apart] = half_plane_ratio_errors(gpu, TechniqueKind::Smrt, &settings);
    println!("{ours:.5}; visibility alone {apart:.4}");
    assert!(ours < 0.002 && apart > 0.03, "{ours}; visibility {apart}");
}
