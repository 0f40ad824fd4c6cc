//! `tilted-planes` and `spheres`: scenes in which a wrong depth bias is visible.
//!
//! Too little bias causes acne, first on surfaces at grazing light; too much detaches the shadows of small objects from
//! what they stand on. In both scenes the light can sink to 5 degrees above the ground.

use glam::{Quat, Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette};
use crate::Scene;

/// Puts a square light on a circle about `target`, at the elevation that the arguments ask for.
fn light_at_elevation(stage: &mut Stage, arguments: &Arguments, target: Vec3) {
    const DISTANCE_M: f32 = 6.5;
    const SIDE_M: f32 = 0.5;
    /// Azimuth of the light, degrees from +z towards −x: left of the camera and in front of the scene.
    const AZIMUTH_DEG: f32 = 62.0;
    let (sin, cos) = (arguments.get("light_elevation_deg") as f32).to_radians().sin_cos();
    let horizon = AZIMUTH_DEG.to_radians();
    let direction = Vec3::new(-horizon.sin() * cos, sin, horizon.cos() * cos);
    stage.square_light(SIDE_M, target + direction * DISTANCE_M, target);
}

/// Three rows of six square slabs: tilted about x, about z, and about both; on each a cube, a rod and a ball.
pub(super) fn tilted_planes(arguments: &Arguments) -> Scene {
    const SLAB_M: Vec3 = Vec3::new(0.8, 0.04, 0.8);
    const PITCH_M: Vec2 = Vec2::new(1.08, 1.35);
    const TILT_STEP_DEG: f32 = 15.0;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::ZERO, Vec2::new(7.6, 5.6), palette::SAND);
    let slab_material = stage.material("slabs", palette::PLASTER, 0.8);
    let prop_material = stage.material("props", palette::TERRACOTTA, 0.6);
    let mut slabs = MeshBuilder::new();
    let mut props = MeshBuilder::new();
    for row in 0..3 {
        for column in 0..6 {
            let tilt = (TILT_STEP_DEG * column as f32).to_radians();
            let turn = match row {
                0 => Quat::from_rotation_x(tilt),
                1 => Quat::from_rotation_z(tilt),
                _ => Quat::from_rotation_x(tilt) * Quat::from_rotation_z(-0.5 * tilt),
            };
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| turn * axis);
            let half = 0.5 * SLAB_M;
            // The lowest corner is 3 mm below the ground.
            let reach: f32 = axes.iter().zip(half.to_array()).map(|(axis, half)| axis.y.abs() * half).sum();
            let center = Vec3::new((column as f32 - 2.5) * PITCH_M.x, reach - 0.003, (row as f32 - 1.0) * PITCH_M.y);
            slabs.oriented_box(center, axes, half);
            let on_slab = |x: f32, z: f32| center + turn * Vec3::new(x, half.y, z);
            let up = axes[1];
            const CUBE_HALF_M: f32 = 0.06;
            const SUNK_M: f32 = 0.001;
            props.oriented_box(on_slab(-0.2, -0.18) + up * (CUBE_HALF_M - SUNK_M), axes, Vec3::splat(CUBE_HALF_M));
            props.cylinder(on_slab(0.2, -0.15) - up * SUNK_M, on_slab(0.2, -0.15) + up * 0.22, 0.025, 16);
            props.sphere(on_slab(0.0, 0.18) + up * (0.07 - SUNK_M), 0.07, 24, 16);
        }
    }
    stage.add("slabs", slab_material, slabs);
    stage.add("props", prop_material, props);
    stage.camera(Vec3::new(0.7, 4.3, 5.4), Vec3::new(0.05, 0.1, 0.1), 40.0);
    light_at_elevation(&mut stage, arguments, Vec3::new(0.0, 0.05, 0.0));
    stage.scene
}

/// Two rows of five spheres, coarse to fine, resting on the ground.
pub(super) fn spheres(arguments: &Arguments) -> Scene {
    /// Numbers of meridians and parallels.
    const TESSELLATIONS: [(u32, u32); 10] =
        [(6, 4), (8, 6), (10, 8), (12, 8), (16, 12), (24, 16), (32, 20), (48, 32), (80, 48), (128, 80)];
    const RADIUS_M: f32 = 0.42;
    const PITCH_M: f32 = 1.25;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::ZERO, Vec2::new(7.6, 5.6), palette::SAND);
    let colors =
        [palette::TERRACOTTA, palette::OCHRE, palette::PLASTER, palette::TEAL_PAINT * 1.6, palette::SLATE_BLUE * 1.8];
    let materials = colors.map(|color| stage.material("clay", color, 0.5));
    for (i, (segments, rings)) in TESSELLATIONS.into_iter().enumerate() {
        let (row, column) = (i / 5, i % 5);
        let stagger = 0.3 * (row as f32 - 0.5);
        let x = (column as f32 - 2.0) * PITCH_M + stagger;
        let z = (0.5 - row as f32) * -1.7;
        let mut sphere = MeshBuilder::new();
        // The lower pole is a vertex, so that even the coarsest touches the ground in a point.
        sphere.sphere(Vec3::new(x, RADIUS_M, z), RADIUS_M, segments, rings);
        stage.add(&format!("sphere {segments} x {rings}"), materials[column], sphere);
    }
    stage.camera(Vec3::new(0.7, 3.6, 5.6), Vec3::new(0.1, 0.22, 0.05), 37.0);
    light_at_elevation(&mut stage, arguments, Vec3::new(0.0, 0.2, 0.0));
    stage.scene
}
