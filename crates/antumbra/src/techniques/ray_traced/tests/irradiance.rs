//! Tests of irradiance masks against Lambert's formula, and against equation 1 of `sample_based`.

use antumbra_light::{EmissionTexture, LightShape};
use glam::{Vec2, Vec3};

use crate::TechniqueKind;
use crate::testing::{Case, gpu, half_plane_ratio_errors, is_software};

/// The result is the same in one pass and in many, which accumulate weighted means.
#[test]
fn the_ratio_is_lambert_s_in_one_pass_and_in_many() {
    let Some(gpu) = gpu() else { return };
    for (samples, most) in [("16", 0.02), ("1024", 0.002)] {
        let [ours, apart] = half_plane_ratio_errors(gpu, TechniqueKind::RayTraced, &[("samples", samples)]);
        println!("{samples} rays: {ours:.5}; visibility alone {apart:.4}");
        assert!(ours < most && apart > 0.03, "{samples} rays: {ours}; visibility {apart}");
    }
}

/// Rays and bits compute the same sum over the same points.
#[test]
fn every_shape_has_the_ratio_of_its_bits() {
    let Some(gpu) = gpu() else { return };
    let ring = |i: u16| Vec3::new(f32::from(i).cos(), 4.0, f32::from(i).sin());
    let rectangle = LightShape::Rectangle { size_m: Vec2::new(3.0, 1.5) };
    let shapes = [
        (rectangle.clone(), false),
        (rectangle, true),
        (LightShape::Disk { radius_m: 1.2 }, false),
        (LightShape::Sphere { radius_m: 1.2 }, false),
        (LightShape::Ellipsoid { radii_m: Vec3::new(1.4, 0.6, 1.0) }, false),
        (LightShape::Sun { angular_diameter_rad: 0.5 }, false),
        (LightShape::Points { positions_m: (0..48).map(ring).collect() }, false),
    ];
    let settings =
        [("samples", "96"), ("sample_set", "r2"), ("seed", "1"), ("rotate", "false"), ("weights", "irradiance")];
    let by_area = [&settings[..4], &[("weights", "emission")]].concat();
    for (shape, has_picture) in shapes {
        let mut case = Case::half_plane(gpu, shape);
        if has_picture {
            let grey = [1.0, 0.2, 0.1, 2.0].map(Vec3::splat);
            case.light.emission = Some(EmissionTexture::from_rgb(2, 2, &grey));
        }
        let [rays, bits] =
            [TechniqueKind::RayTraced, TechniqueKind::SampleBased].map(|kind| case.run(gpu, kind, &settings));
        let visible = case.run(gpu, TechniqueKind::RayTraced, &by_area);
        let pixels = case.ground_pixels(|p| p.x.abs() < 2.0 && p.z.abs() < 1.2);
        let apart = |a: &[f32], b: &[f32]| pixels.iter().map(|(i, _)| (a[*i] - b[*i]).abs()).fold(0.0, f32::max);
        let partly = pixels.iter().filter(|(i, _)| rays[*i] > 0.05 && rays[*i] < 0.95).count();
        let shape = &case.light.shape;
        println!("{shape:?}: {} apart, from visibility {}", apart(&rays, &bits), apart(&rays, &visible));
        assert!(partly > 100, "{shape:?}: {partly} pixels in penumbra");
        // On a GPU, a point on an edge may be visible to one and hidden to the other.
        let most = if is_software(gpu) { 1e-5 } else { 0.03 };
        assert!(apart(&rays, &bits) < most, "{shape:?}: {}", apart(&rays, &bits));
        assert!(apart(&rays, &visible) > 1e-3, "{shape:?}");
    }
}
