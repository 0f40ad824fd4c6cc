//! Tests of sums at any depth, and of the paper's sums, which fail in deep scenes.

use std::time::Instant;

use antumbra_light::{Light, LightShape};
use glam::{Vec2, Vec3};

use crate::TechniqueKind;
use crate::gpu::{Gpu, Recorder};
use crate::shadow::Casters;
use crate::testing::{Case, Mesh, View, gpu, half_plane_visibility, rmse, run, test_ground};

/// A 12 m ground under a half-plane (x < 0) at 1.5 m and a light at 4 m, and beside it a floor `depth_m` further down.
fn deep(gpu: &Gpu, depth_m: f32) -> Case {
    let light = Light::new(LightShape::Rectangle { size_m: Vec2::ONE }, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    let occluder = Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 1.5);
    let mut meshes = vec![ground, occluder];
    if depth_m > 0.0 {
        // Visible past the ground's edge, at tangents from 1.5 to 2.
        let far = 4.0 + depth_m;
        meshes.push(Mesh::horizontal(gpu, Vec2::new(1.4 * far, -far), Vec2::new(2.0 * far, far), -depth_m));
    }
    Case::new(gpu, light, view, meshes)
}

/// Returns the largest error where all or nothing of the light is visible.
fn worst(gpu: &Gpu, depth_m: f32, settings: &[(&str, &str)]) -> f32 {
    let case = deep(gpu, depth_m);
    let mask = case.run(gpu, TechniqueKind::Essm, settings);
    // The penumbra extends 0.3 m to each side, and a texel of a 512² map of such a width is 3 cm.
    let sure = case.ground_pixels(|p| test_ground(p) && p.x.abs() > 0.4);
    assert!(sure.iter().any(|(_, p)| p.x < 0.0) && sure.iter().any(|(_, p)| p.x > 0.0));
    sure.iter().map(|(i, p)| (mask[*i] - if p.x > 0.0 { 1.0 } else { 0.0 }).abs()).fold(0.0, f32::max)
}

#[test]
fn sums_hold_at_any_depth_and_size() {
    let Some(gpu) = gpu() else { return };
    for (map_size, depths) in
        [("512", &[0.0, 30.0, 1000.0][..]), ("1024", &[1000.0]), ("2048", &[1000.0]), ("4096", &[1000.0])]
    {
        for depth in depths {
            let error = worst(gpu, *depth, &[("map_size", map_size)]);
            println!("tiles, {map_size}, {depth} m: largest error {error:.4}");
            assert!(error <= 0.004, "{map_size}, {depth} m: {error}");
        }
    }
}

#[test]
fn the_paper_s_sums_fail_in_deep_scenes() {
    let Some(gpu) = gpu() else { return };
    for (table, scan) in [("tile_grid", "blocks"), ("tile_grid", "doubling"), ("float", "blocks")] {
        let error = worst(gpu, 1000.0, &[("table", table), ("scan", scan), ("direct_texels", "0")]);
        println!("{table} by {scan}, 1000 m: largest error {error:.4}");
        assert!(error > 0.1, "{table} holds after all: {error}; say so in the documentation");
    }
}

/// Tests sums of tiles of nothing but occluders, with the maximum number of bits.
#[test]
fn whole_tiles_of_every_precision_sum_without_wrapping() {
    let Some(gpu) = gpu() else { return };
    for (bits, exponent) in [("20", "13.8"), ("24", "16.6")] {
        for scan in ["blocks", "doubling"] {
            // One part, so that only tile borders cut it.
            let printed = [("table", "tile_grid"), ("direct_texels", "0"), ("subdivisions", "1"), ("map_size", "512")];
            let own = [("precision_bits", bits), ("exponent", exponent), ("scan", scan)];
            let error = worst(gpu, 0.0, &[printed.as_slice(), &own].concat());
            println!("{bits} bits, {scan}: largest error {error:.4}");
            // One part for a kernel is coarse; a tile that wraps would let in all of the light.
            assert!(error <= 0.07, "{bits} bits, {scan}: {error}");
        }
    }
}

#[test]
fn doubling_makes_the_same_tables() {
    let Some(gpu) = gpu() else { return };
    let case = deep(gpu, 0.0);
    for table in ["tiles", "tile_grid"] {
        let mask = |scan| case.run(gpu, TechniqueKind::Essm, &[("table", table), ("scan", scan), ("map_size", "500")]);
        assert!(mask("blocks") == mask("doubling"), "{table}: integer sums do not depend on how they travel");
    }
}

/// A list of points is filtered as an ellipse of their covariance: one point gives a hard shadow, and points that cover a
/// square give nearly its penumbra.
#[test]
fn lists_of_points_have_the_shadow_of_what_they_cover() {
    let Some(gpu) = gpu() else { return };
    let error = |side: u32, width_m: f32| {
        let place = |i: u32| width_m * ((i as f32 + 0.5) / side as f32 - 0.5);
        let positions_m =
            (0..side * side).map(|i| Vec3::new(place(i % side), 4.0, place(i / side))).collect::<Vec<_>>();
        let case = Case::half_plane(gpu, LightShape::Points { positions_m });
        let mask = case.run(gpu, TechniqueKind::Essm, &[("kernel", "isotropic")]);
        rmse(&case.ground_pixels(test_ground), &mask, |p| half_plane_visibility(p.x, width_m))
    };
    let (one, many) = (error(1, 0.0), error(16, 1.0));
    println!("one point: rmse {one:.4}; 256 over a square metre: {many:.4}");
    assert!(one < 0.03, "one point: {one}");
    assert!(many < 0.03, "256 points: {many}");
}

/// The map's window is reused only while nothing moves.
#[test]
fn a_kept_window_follows_what_moves() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ONE });
    let mut kept = TechniqueKind::Essm.create(gpu).expect("a technique");
    let mut masks = Vec::new();
    for x in [0.0, 0.0, 1.0] {
        case.light.center.x = x;
        let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
        let mask =
            case.with_frame(Casters::Meshes(&casters), |frame| run(gpu, &mut kept, frame)).expect("a good frame");
        assert!(
            mask == case.run(gpu, TechniqueKind::Essm, &[]),
            "the light at x = {x}: not what a new technique gives"
        );
        masks.push(mask);
    }
    assert!(masks[0] == masks[1] && masks[0] != masks[2]);
    // CPU time of preparing and recording a frame.
    let mut ms_of = |step: f32| {
        const FRAMES: u32 = 20;
        let begin = Instant::now();
        for _ in 0..FRAMES {
            case.light.center.x += step;
            let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            case.with_frame(Casters::Meshes(&casters), |frame| {
                kept.prepare(frame).expect("a good frame").record(&mut Recorder::new(&mut encoder, None));
            });
        }
        1e3 * begin.elapsed().as_secs_f64() / f64::from(FRAMES)
    };
    println!("prepare: {:.3} ms while all stands still, {:.3} ms while the light moves", ms_of(0.0), ms_of(1e-3));
}

/// A panel whose lower half is below the ground's plane: with the horizon the ground sees its upper half, and as published all
/// of it.
#[test]
fn the_horizon_is_a_switch() {
    let Some(gpu) = gpu() else { return };
    let light =
        Light::new(LightShape::Rectangle { size_m: Vec2::ONE }, Vec3::new(0.0, 0.3, -3.0), Vec3::new(0.0, 0.0, 0.0));
    let view = View::new(Vec3::new(0.0, 1.5, 3.0), Vec3::ZERO);
    let ground = Mesh::horizontal(gpu, Vec2::splat(-4.0), Vec2::splat(4.0), 0.0);
    let case = Case::new(gpu, light, view, vec![ground]);
    let mean = |horizon: &str| {
        let mask = case.run(gpu, TechniqueKind::Essm, &[("horizon", horizon), ("map_size", "256")]);
        let seen = case.ground_pixels(|p| p.x.abs() < 0.5 && p.z.abs() < 0.5);
        assert!(!seen.is_empty());
        seen.iter().map(|(i, _)| mask[*i]).sum::<f32>() / seen.len() as f32
    };
    let (with, without) = (mean("true"), mean("false"));
    println!("lit {with} with the horizon, {without} without");
    // The light is 1 m high, centred at 0.3 m and tilted by a tenth: .8 of it is above the ground.
    assert!((0.75..0.85).contains(&with) && without > 0.97, "{with}, {without}");
}
