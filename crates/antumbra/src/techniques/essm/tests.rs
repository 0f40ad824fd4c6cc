//! Sums at any depth, and the paper's that do not hold.

use antumbra_light::{Light, LightShape};
use glam::{Vec2, Vec3};

use crate::contract::TechniqueKind;
use crate::gpu::Gpu;
use crate::techniques::tests::{Case, Mesh, View, gpu, test_ground};

/// A 12 m ground under a half-plane (x < 0) at 1.5 m and a light at 4 m, and beside it a floor `depth_m` further down.
fn deep(gpu: &Gpu, depth_m: f32) -> Case {
    let light = Light::new(LightShape::Rectangle { size_m: Vec2::ONE }, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    let view = View::new(Vec3::new(2.0, 1.2, 5.0), Vec3::new(0.6, 0.0, 0.0));
    let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    let occluder = Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 1.5);
    let mut meshes = vec![ground, occluder];
    if depth_m > 0.0 {
        // Seen past the ground's edge, at tangents from 1.5 to 2.
        let far = 4.0 + depth_m;
        meshes.push(Mesh::horizontal(gpu, Vec2::new(1.4 * far, -far), Vec2::new(2.0 * far, far), -depth_m));
    }
    Case::new(gpu, light, view, meshes)
}

/// The largest error where all or nothing of the light is seen.
fn worst(gpu: &Gpu, depth_m: f32, settings: &[(&str, &str)]) -> f32 {
    let case = deep(gpu, depth_m);
    let mask = case.run(gpu, TechniqueKind::Essm, settings);
    // The penumbra is 0.3 m wide to each side, and a texel of a 512² map of such a width is 3 cm.
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

#[test]
fn doubling_makes_the_same_tables() {
    let Some(gpu) = gpu() else { return };
    let case = deep(gpu, 0.0);
    for table in ["tiles", "tile_grid"] {
        let mask = |scan| case.run(gpu, TechniqueKind::Essm, &[("table", table), ("scan", scan), ("map_size", "500")]);
        assert!(mask("blocks") == mask("doubling"), "{table}: integer sums do not depend on how they travel");
    }
}
