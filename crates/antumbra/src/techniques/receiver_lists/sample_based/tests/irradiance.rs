//! Tests of equation 1 against Lambert's formula, and against the bits in double precision.

use antumbra_light::{EmissionTexture, Light, LightShape, SampleSet};
use glam::{DVec3, Vec2, Vec3};

use super::super::{SampleBased, SampleBasedParams, SampleWeights};
use crate::contract::{Mask, MaskChannels};
use crate::gpu::{Gpu, Recorder};
use crate::shadow::{Casters, Frame, Shadow};
use crate::testing::{Case, Mesh, SIZE, gpu, lambert_irradiance, read_layer, read_storage};

/// Returns a case's mask in three channels, its bits and their points' order.
fn masks(gpu: &Gpu, case: &Case, params: SampleBasedParams) -> ([Vec<f32>; 3], Vec<u32>, Vec<u32>) {
    let mask = Mask::with_channels(gpu.device(), SIZE, MaskChannels::Three);
    let mut shadow = Shadow::<SampleBased>::with_params(gpu, params).expect("a device with WebGPU's limits");
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    case.with_frame(Casters::Meshes(&casters), |frame| {
        let work = shadow.prepare(&Frame { mask: &mask, ..*frame }).expect("a good frame");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        work.record(&mut Recorder::new(&mut encoder, None));
        gpu.queue.submit([encoder.finish()]);
    });
    let layers = [0, 1, 2].map(|layer| bytemuck::pod_collect_to_vec(&read_layer(gpu, mask.texture(), layer)));
    let bits = shadow.technique().bits().map(|bits| read_storage(gpu, bits)).unwrap_or_default();
    (layers, bits, shadow.technique().bit_order().to_vec())
}

fn params() -> SampleBasedParams {
    let (sample_set, weights) = (SampleSet::Sobol, SampleWeights::Irradiance);
    SampleBasedParams { samples: 1024, sample_set, weights, ..SampleBasedParams::default() }
}

/// Under the half-plane's edge, the visible part of a square light is a rectangle, and a different one for each of its two
/// colours. The fractions differ from visibility by tenths: the edge leaves the light's near side, or its far one.
#[test]
fn half_planes_leave_lambert_s_part_of_each_color() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::splat(4.0) });
    case.light.emission = Some(EmissionTexture::from_rgb(2, 1, &[Vec3::X, 0.5 * Vec3::Z]));
    let red_is_right = case.light.frame().right.x < 0.0;
    let ([red, green, blue], ..) = masks(gpu, &case, params());
    let apart = SampleBasedParams { weights: SampleWeights::Emission, ..params() };
    let ([visible, ..], ..) = masks(gpu, &case, apart);
    let pixels = case.ground_pixels(|p| p.x.abs() < 2.0 && p.z.abs() < 1.2);
    assert!(pixels.len() > 500);
    let (mut sum, mut sum_apart, mut largest) = (0.0f64, 0.0f64, 0.0f64);
    for (i, p) in &pixels {
        let first_seen = f64::from(-p.x) * (1.0 - 0.375) / 0.375;
        // Irradiance of a half of the light, from x0 to x1.
        let of = |[x0, x1]: [f64; 2], from: f64| lambert_irradiance(p.as_dvec3(), 4.0, [x0.max(from), x1], [-2.0, 2.0]);
        let [left, right] = [[-2.0, 0.0], [0.0, 2.0]];
        let parts = [left, right].map(|half| of(half, first_seen) / of(half, -2.0));
        let [left_mask, right_mask] = if red_is_right { [&blue, &red] } else { [&red, &blue] };
        for (mask, part) in [left_mask, right_mask].into_iter().zip(parts) {
            let error = (f64::from(mask[*i]) - part).abs();
            (sum, largest) = (sum + error * error, largest.max(error));
        }
        sum_apart += (f64::from(visible[*i]) - parts[1]).powi(2);
        // Green has no emission and takes the fraction of the luminance, which is between the two.
        let (low, high) = (red[*i].min(blue[*i]), red[*i].max(blue[*i]));
        assert!(green[*i] >= low - 1e-5 && green[*i] <= high + 1e-5, "{p}: {} of {low} to {high}", green[*i]);
    }
    let rmse = |sum: f64, count: usize| (sum / count as f64).sqrt();
    let (ours, apart) = (rmse(sum, 2 * pixels.len()), rmse(sum_apart, pixels.len()));
    println!("rmse {ours:.5}, largest {largest:.4}; visibility alone {apart:.4}");
    assert!(ours < 0.004 && largest < 0.03 && apart > 0.05);
}

/// The mask is the sum of equation 1 over the bits, for every shape of light.
#[test]
fn every_shape_has_the_sum_over_its_bits() {
    let Some(gpu) = gpu() else { return };
    let ring = |i: u16| Vec3::new(f32::from(i).cos(), 4.0, f32::from(i).sin());
    let shapes = [
        LightShape::Rectangle { size_m: Vec2::new(3.0, 1.5) },
        LightShape::Disk { radius_m: 1.2 },
        LightShape::Sphere { radius_m: 1.2 },
        LightShape::Ellipsoid { radii_m: Vec3::new(1.4, 0.6, 1.0) },
        LightShape::Sun { angular_diameter_rad: 0.5 },
        LightShape::Points { positions_m: (0..48).map(ring).collect() },
    ];
    let params = SampleBasedParams { samples: 96, sample_set: SampleSet::R2, keep_bits: true, ..params() };
    for shape in shapes {
        let mut case = Case::half_plane(gpu, shape);
        if matches!(case.light.shape, LightShape::Rectangle { .. }) {
            let rgb = [Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.1, 0.9, 0.4), Vec3::ZERO, Vec3::new(0.3, 0.3, 2.0)];
            case.light.emission = Some(EmissionTexture::from_rgb(2, 2, &rgb));
        }
        let (masks, bits, order) = masks(gpu, &case, params);
        let pixels = case.ground_pixels(|p| p.x.abs() < 2.0 && p.z.abs() < 1.2);
        let unit_points = params.sample_set.points(params.samples, params.seed);
        let words = order.len().div_ceil(32);
        let is_open = |pixel: usize, slot: usize| bits[pixel * words + slot / 32] >> (slot % 32) & 1 == 1;
        let mut partly = 0;
        for (pixel, p) in &pixels {
            let given: Vec<DVec3> = order.iter().map(|i| given(&case.light, &unit_points, *i, *p)).collect();
            let all: DVec3 = given.iter().sum();
            let open = |(slot, _): &(usize, &DVec3)| is_open(*pixel, *slot);
            let seen: DVec3 = given.iter().enumerate().filter(open).map(|(_, given)| *given).sum();
            let cpu_reference = seen / all;
            let ours = DVec3::from([0, 1, 2].map(|k| f64::from(masks[k][*pixel])));
            assert!(
                ours.abs_diff_eq(cpu_reference, 2e-4),
                "{:?} at {p}: {ours}, CPU reference {cpu_reference}",
                case.light.shape
            );
            partly += usize::from(cpu_reference.x > 0.05 && cpu_reference.x < 0.95);
        }
        assert!(partly > 100, "{:?}: {partly} pixels in penumbra", case.light.shape);
    }
}

/// Returns the irradiance that a light point gives the ground at `p` by equation 1, up to constants.
fn given(light: &Light, unit_points: &[Vec3], index: u32, p: Vec3) -> DVec3 {
    let frame = light.frame();
    let (to, leaving) = if let LightShape::Points { positions_m } = &light.shape {
        ((positions_m[index as usize] - p).as_dvec3(), None)
    } else {
        let to = light.point(&frame, unit_points[index as usize], p).vector_from(p).as_dvec3();
        let facing = match light.shape {
            LightShape::Ellipsoid { .. } => None,
            LightShape::Sphere { .. } => Some((light.center - p).normalize().as_dvec3()),
            _ => Some(-frame.axis.as_dvec3()),
        };
        (to, facing)
    };
    let towards = to.normalize();
    let cosines = towards.y.max(0.0) * leaving.map_or(1.0, |normal: DVec3| normal.dot(towards).max(0.0));
    let emission = light.emission.as_ref().map_or(Vec3::ONE, |e| e.color_at(unit_points[index as usize].truncate()));
    emission.as_dvec3() * cosines / to.length_squared()
}
