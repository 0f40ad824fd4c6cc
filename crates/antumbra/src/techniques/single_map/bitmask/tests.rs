//! Tests of the bits against tests of every point, and of occluders one behind another.

use antumbra_light::{Light, LightShape};
use glam::{Vec2, Vec3};

use super::{Bitmask, BitmaskParams, gpu_types};
use crate::TechniqueKind;
use crate::contract::Params;
use crate::gpu::{Gpu, Recorder, Stage};
use crate::shaders;
use crate::techniques::Technique;
use crate::testing::{Case, Mesh, RECTANGLE, SIZE, View, gpu, half_plane_visibility, read_texture, rmse, test_ground};

const KIND: TechniqueKind = TechniqueKind::Bitmask;

/// Mask of a technique that the test creates itself.
fn mask_of(gpu: &Gpu, case: &Case, technique: &mut Bitmask, params: &BitmaskParams) -> Vec<f32> {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    case.with_prepared(&casters, |frame| {
        let prepared = technique.prepare(&Stage::at_once(gpu), frame, params).expect("a good frame");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        technique.record(&mut Recorder::new(&mut encoder, None), frame, &prepared);
        gpu.queue().submit([encoder.finish()]);
        bytemuck::pod_collect_to_vec(&read_texture(gpu, frame.mask.texture(), 0, SIZE))
    })
}

/// The table finds the same points as a test of all, for every shape and for few and many points.
#[test]
fn the_table_leaves_no_point_out() {
    let Some(gpu) = gpu() else { return };
    for shape in [
        RECTANGLE,
        LightShape::Rectangle { size_m: Vec2::new(1.6, 0.3) },
        LightShape::Disk { radius_m: 0.6 },
        LightShape::Sphere { radius_m: 0.6 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.6, 0.3, 0.4) },
        LightShape::Sun { angular_diameter_rad: 0.2 },
    ] {
        let mut case = Case::half_plane(gpu, shape.clone());
        // Tilted and off-centre.
        case.light = Light::new(shape.clone(), Vec3::new(0.7, 4.0, -0.4), Vec3::new(0.1, 0.0, 0.3));
        for (key, value) in [("samples", "64"), ("samples", "200"), ("rotate", "false"), ("gaps", "open")] {
            let masks = [shaders::BITMASK_RESOLVE, shaders::BITMASK_RESOLVE_EXHAUSTIVE].map(|wgsl| {
                let mut params = BitmaskParams::default();
                for (key, value) in [("map_size", "256"), (key, value)] {
                    params.set(Bitmask::NAME, key, value).expect("in range");
                }
                mask_of(gpu, &case, &mut Bitmask::with_shader(gpu, wgsl), &params)
            });
            let partly = masks[0].iter().filter(|v| (0.02..0.98).contains(*v)).count();
            assert!(partly > 200, "{shape:?}: {partly} pixels in penumbrae");
            let off = masks[0].iter().zip(&masks[1]).filter(|(a, b)| a != b).count();
            assert_eq!(off, 0, "{shape:?}, {key}={value}: pixels that differ");
        }
    }
}

/// A square that one surface fills hides what its texels hide one by one, and no part that hides more is skipped.
#[test]
fn whole_squares_hide_what_their_texels_hide() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    // A strip so tilted that squares of few texels hide as a whole, and larger ones do not.
    let corners =
        [Vec3::new(0.4, 2.15, -1.5), Vec3::new(0.4, 2.15, 1.5), Vec3::new(-0.2, 2.0, 1.5), Vec3::new(-0.2, 2.0, -1.5)];
    case.meshes.push(Mesh::new(gpu, &corners, &[0, 1, 2, 0, 2, 3]));
    let pixels = case.ground_pixels(test_ground);
    for gaps in ["open", "surfaces", "all"] {
        let [whole, split] = [shaders::BITMASK_RESOLVE, shaders::BITMASK_RESOLVE_ONE_BY_ONE].map(|wgsl| {
            let mut params = BitmaskParams::default();
            for (key, value) in [("map_size", "512"), ("samples", "256"), ("patches", "64"), ("gaps", gaps)] {
                params.set(Bitmask::NAME, key, value).expect("in range");
            }
            mask_of(gpu, &case, &mut Bitmask::with_shader(gpu, wgsl), &params)
        });
        let partly = pixels.iter().filter(|(i, _)| (0.02..0.98).contains(&split[*i])).count();
        assert!(partly > 100, "{partly} pixels in penumbrae");
        let most = pixels.iter().map(|(i, _)| (whole[*i] - split[*i]).abs()).fold(0.0, f32::max);
        println!("gaps={gaps}: {most:.4} apart at the most");
        assert!(most <= 2.0 / 256.0, "gaps={gaps}: {most} apart");
    }
}

/// A second occluder inside the first one's shadow changes nothing, and one that reaches beyond it hides only what it hides by itself:
/// areas are not added up.
#[test]
fn what_is_hidden_twice_counts_once() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    let pixels = case.ground_pixels(test_ground);
    // At 3 m, where the segment to the light point o is at x + (o − x) · 3/4: hidden below −0.1 m.
    case.meshes.push(Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(-0.1, 4.0), 3.0));
    let truth = |p: Vec3| {
        let first_past_upper = (-0.1 - 0.25 * p.x) / 0.75;
        half_plane_visibility(p.x, 1.0).min((0.5 - first_past_upper).clamp(0.0, 1.0))
    };
    let both = pixels.iter().filter(|(_, p)| half_plane_visibility(p.x, 1.0) < 0.9 && truth(*p) > 0.1).count();
    assert!(both > 100, "{both} pixels see both edges");
    let error = |layers: &str| rmse(&pixels, &case.run(gpu, KIND, &[("samples", "256"), ("layers", layers)]), truth);
    let (one, two) = (error("1"), error("2"));
    println!("rmse {one:.4} with the nearest casters alone, {two:.4} with those behind them");
    assert!(two < 0.004, "rmse {two}");
    assert!(one > 5.0 * two, "rmse {one} without those behind");
}

/// Below a sheet that rises steeply towards the light, adjacent texels differ in depth, and the receiver sees the light between them.
#[test]
fn filled_gaps_keep_light_out() {
    let Some(gpu) = gpu() else { return };
    let light = Light::new(RECTANGLE, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    let corners =
        [Vec3::new(0.3, 3.1, -4.0), Vec3::new(0.3, 3.1, 4.0), Vec3::new(-2.5, 0.6, 4.0), Vec3::new(-2.5, 0.6, -4.0)];
    let sheet = Mesh::new(gpu, &corners, &[0, 1, 2, 0, 2, 3]);
    let case = Case::new(gpu, light, view, vec![ground, sheet]);
    // From here each segment to the light begins before the sheet and passes behind its upper edge: at 3.1 m it is at
    // x + (o − x) · 3.1/4, below 0.3 for every o up to half a metre.
    let below = case.ground_pixels(|p| (-1.8..-0.8).contains(&p.x) && p.z.abs() < 1.0);
    assert!(below.len() > 100, "{} pixels", below.len());
    let lit = |gaps: &str| {
        let mask = case.run(gpu, KIND, &[("map_size", "128"), ("gaps", gaps), ("patches", "64")]);
        below.iter().map(|(i, _)| mask[*i]).sum::<f32>() / below.len() as f32
    };
    let (open, filled) = (lit("open"), lit("surfaces"));
    println!("{open:.4} of the light comes through gaps, {filled:.4} where they are filled");
    assert!(filled < 1e-4 && open > 0.01, "{open} through gaps, {filled} where they are filled");
}

/// Fewer and larger patches add noise, but no bias: the mean over pixels stays the same.
#[test]
fn larger_patches_keep_the_mean() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    // Offset of the light, because otherwise the occluder's edge lies on the sides of squares.
    const BESIDE_M: f32 = 0.37;
    case.light = Light::new(RECTANGLE, Vec3::new(BESIDE_M, 4.0, 0.1), Vec3::new(BESIDE_M, 0.0, 0.1));
    let pixels = case.ground_pixels(test_ground);
    // Hidden are light points up to o = −x · (1 − 3/8) / (3/8), from the origin.
    let truth = |p: Vec3| (0.5 + BESIDE_M + p.x * 0.625 / 0.375).clamp(0.0, 1.0);
    let of = |patches: &str| {
        let settings = [("map_size", "2048"), ("samples", "256"), ("patches", patches)];
        let mask = case.run(gpu, KIND, &settings);
        let bias = pixels.iter().map(|(i, p)| mask[*i] - truth(*p)).sum::<f32>() / pixels.len() as f32;
        (rmse(&pixels, &mask, truth), bias)
    };
    let ((few, few_bias), (many, many_bias)) = (of("4"), of("64"));
    println!("rmse {few:.4} with 4 patches a side, {many:.4} with 64; mean error {few_bias:.5} and {many_bias:.5}");
    assert!(few_bias.abs() < 0.004 && many_bias.abs() < 0.002, "{few_bias} and {many_bias}");
    assert!(many < 0.5 * few, "rmse {few} and {many}");
}

#[test]
fn words_hold_every_number_of_samples() {
    let spec = BitmaskParams::specs().iter().find(|spec| spec.key == "samples").expect("a parameter");
    assert_eq!(spec.range, Some((1.0, f64::from(32 * gpu_types::MAX_WORDS))));
}
