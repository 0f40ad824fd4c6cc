//! Textbook configurations of few occluders, each the worst case of some technique.
//!
//! `overlap`: Lauritzen & McCool, *Layered Variance Shadow Maps*, GI 2008, figs. 1, 2 and 6. `lantern-wall`,
//! `leaning-plank`, `stacked-panels`: Selgrad, Dachsbacher, Meyer & Stamminger, *Filtering Multi-Layer Shadow Maps for
//! Accurate Soft Shadows*, CGF 2014, figs. 1, 14 and 15.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use super::{Arguments, noise::Random};
use crate::Scene;

/// Depth by which objects sink into what they stand on, metres, so that no two faces coincide.
const SUNK_M: f32 = 0.005;

/// A pergola's boards (A) over a low table (B) over the ground (C): A to B is some seven times B to C.
///
/// Chebyshev's bound in C's part under both is about 1 / (1 + (A to B / B to C)² · …), so the penumbra of A shows
/// through B.
pub(super) fn overlap(arguments: &Arguments) -> Scene {
    const BOARDS_HEIGHT_M: f32 = 3.3;
    const TABLE_HEIGHT_M: f32 = 0.5;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.2, -0.1), Vec2::new(8.0, 7.2), palette::SAND);

    let wood = stage.material("boards", palette::PALE_WOOD, 0.7);
    let mut boards = MeshBuilder::new();
    let mut random = Random::new(1);
    for (i, x) in [-1.75f32, -1.05, -0.35, 0.35].into_iter().enumerate() {
        boards.tint(shade(random.unit(), 0.2));
        let overhang = if i % 2 == 0 { 1.55 } else { 1.45 };
        boards.box_between(
            Vec3::new(x - 0.17, BOARDS_HEIGHT_M, -overhang - 0.3),
            Vec3::new(x + 0.17, BOARDS_HEIGHT_M + 0.05, overhang - 0.3),
        );
    }
    boards.tint(shade(0.2, 0.2));
    for z in [-1.5, 0.9] {
        boards.beam(
            Vec3::new(-2.3, BOARDS_HEIGHT_M - 0.055, z),
            Vec3::new(2.45, BOARDS_HEIGHT_M - 0.055, z),
            0.12,
            0.12,
            Vec3::Y,
        );
        for x in [-2.15, 2.3] {
            boards.box_between(
                Vec3::new(x - 0.05, -SUNK_M, z - 0.05),
                Vec3::new(x + 0.05, BOARDS_HEIGHT_M - 0.06, z + 0.05),
            );
        }
    }
    stage.add("boards", wood, boards);

    let paint = stage.material("table", palette::TEAL_PAINT, 0.5);
    let mut table = MeshBuilder::new();
    table.box_between(Vec3::new(-0.75, TABLE_HEIGHT_M, -0.65), Vec3::new(1.85, TABLE_HEIGHT_M + 0.06, 0.85));
    for (x, z) in [(-0.65, -0.55), (1.75, -0.55), (-0.65, 0.75), (1.75, 0.75)] {
        table.box_between(Vec3::new(x - 0.04, -SUNK_M, z - 0.04), Vec3::new(x + 0.04, TABLE_HEIGHT_M + 0.01, z + 0.04));
    }
    stage.add("table", paint, table);

    stage.camera(Vec3::new(1.3, 2.9, 5.6), Vec3::new(0.35, 0.62, 0.2), 42.0);
    stage.square_light(0.55, Vec3::new(-2.2, 7.0, -1.8), Vec3::new(0.5, 0.4, 0.2));
    stage.scene
}

/// A lantern close to a wall, and a banner between the light and the lantern's surroundings.
pub(super) fn lantern_wall(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.1, 1.6), Vec2::new(5.8, 3.6), palette::STONE);

    let plaster = stage.material("wall", palette::PLASTER, 0.9);
    let mut wall = MeshBuilder::new();
    wall.box_between(Vec3::new(-3.0, -SUNK_M, -0.3), Vec3::new(3.0, 3.7, 0.0));
    wall.tint(Vec3::splat(0.75));
    wall.box_between(Vec3::new(-3.05, -0.02, -0.2), Vec3::new(3.05, 0.35, 0.06));
    wall.box_between(Vec3::new(-3.05, 3.55, -0.32), Vec3::new(3.05, 3.75, 0.08));
    stage.add("wall", plaster, wall);

    let iron = stage.material("iron", palette::IRON * 1.5, 0.45);
    let hook = Vec3::new(0.62, 2.62, 0.34);
    let foot = hook - Vec3::Y * 0.68;
    stage.add("lantern", iron, lantern(hook, foot));

    let wax = stage.material("candle", Vec3::new(0.78, 0.70, 0.52), 0.6);
    let mut candle = MeshBuilder::new();
    candle.cylinder(foot + Vec3::Y * 0.02, foot + Vec3::Y * 0.24, 0.045, 16);
    stage.add("candle", wax, candle);

    let cloth = stage.material("banner", palette::RED_PAINT, 0.9);
    let mut banner = MeshBuilder::new();
    banner.box_between(Vec3::new(-1.3, 1.55, 2.24), Vec3::new(-0.68, 3.3, 2.27));
    stage.add("banner", cloth, banner);
    let wood = stage.material("banner pole", palette::DARK_WOOD, 0.6);
    let mut pole = MeshBuilder::new();
    pole.cylinder(Vec3::new(-1.95, -SUNK_M, 2.3), Vec3::new(-1.95, 3.5, 2.3), 0.035, 12);
    pole.sphere(Vec3::new(-1.95, 3.52, 2.3), 0.06, 16, 10);
    pole.cylinder(Vec3::new(-2.05, 3.3, 2.255), Vec3::new(-0.58, 3.3, 2.255), 0.022, 12);
    pole.frustum(Vec3::new(-1.95, -SUNK_M, 2.3), Vec3::new(-1.95, 0.12, 2.3), 0.22, 0.16, 20);
    stage.add("banner pole", wood, pole);

    stage.camera(Vec3::new(1.9, 1.9, 4.7), Vec3::new(0.05, 1.72, 0.2), 40.0);
    stage.square_light(0.5, Vec3::new(-2.4, 3.6, 4.6), Vec3::new(-0.35, 1.1, 0.6));
    stage.scene
}

/// A lantern with its bracket on the wall, which hangs from `hook` down to `foot`.
fn lantern(hook: Vec3, foot: Vec3) -> MeshBuilder {
    let mut lantern = MeshBuilder::new();
    lantern.box_between(Vec3::new(hook.x - 0.06, 2.25, -SUNK_M), Vec3::new(hook.x + 0.06, 2.85, 0.025));
    let bracket: Vec<Vec3> = (0..=16)
        .map(|i| {
            let t = i as f32 / 16.0;
            Vec3::new(hook.x, 2.32 + 0.36 * (t * 0.25 * TAU).sin(), 0.015 + (hook.z + 0.06) * t)
        })
        .collect();
    lantern.tube(&bracket, 8, |_| 0.016);
    lantern.box_between(Vec3::new(hook.x - 0.015, 2.61, 0.0), Vec3::new(hook.x + 0.015, 2.64, hook.z + 0.1));
    lantern.cylinder(hook - Vec3::Y * 0.16, hook + Vec3::Y * 0.01, 0.012, 8);
    // Cap, cage and foot, from the hook down; radii in metres.
    let eaves = hook - Vec3::Y * 0.3;
    let cap = [(0.0, 0.0), (0.2, 0.0), (0.2, 0.03), (0.11, 0.09), (0.06, 0.15), (0.03, 0.2), (0.0, 0.2)];
    lantern.lathe(eaves, Vec3::Y, &cap.map(Vec2::from), 24);
    let base = [(0.0, -0.06), (0.03, -0.06), (0.05, -0.02), (0.15, 0.0), (0.15, 0.03), (0.0, 0.03)];
    lantern.lathe(foot, Vec3::Y, &base.map(Vec2::from), 24);
    for i in 0..6 {
        let spoke = Vec2::from_angle(TAU * (i as f32 + 0.25) / 6.0);
        let outward = Vec3::new(spoke.x, 0.0, spoke.y);
        lantern.beam(foot + outward * 0.135, eaves + outward * 0.165 + Vec3::Y * 0.01, 0.024, 0.024, outward);
    }
    let ring = |r: f32, y: f32| [(r - 0.012, y), (r + 0.012, y), (r + 0.012, y + 0.024), (r - 0.012, y + 0.024)];
    lantern.lathe_ring(foot, Vec3::Y, &ring(0.152, 0.2).map(Vec2::from), 24);
    lantern
}

/// A plank that leans against a low wall; the light behind the wall casts its shadow towards the camera.
pub(super) fn leaning_plank(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.0, 0.6), Vec2::new(7.5, 5.6), palette::SAND);

    let stone = stage.material("wall", palette::STONE, 0.9);
    let mut wall = MeshBuilder::new();
    wall.box_between(Vec3::new(1.66, -SUNK_M, -0.42), Vec3::new(1.92, 2.2, 0.12));
    stage.add("wall", stone, wall);

    let wood = stage.material("plank", palette::PALE_WOOD, 0.65);
    let mut plank = MeshBuilder::new();
    plank.beam(Vec3::new(-2.3, 0.024, -0.15), Vec3::new(1.85, 2.32, -0.15), 0.42, 0.05, Vec3::Y);
    stage.add("plank", wood, plank);

    stage.camera(Vec3::new(-1.4, 3.2, 5.3), Vec3::new(0.15, 0.66, 0.45), 38.0);
    stage.square_light(0.6, Vec3::new(-0.2, 5.0, -2.7), Vec3::new(0.0, 0.5, 0.3));
    stage.scene
}

/// Panels in one another's shadow: a stack of flat ones under the light and a row of upright ones.
pub(super) fn stacked_panels(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.2, 0.2), Vec2::new(7.5, 6.5), palette::SAND);
    let light_center = Vec3::new(-3.4, 4.9, -0.6);

    let paint = stage.material("panels", palette::SLATE_BLUE * 1.6, 0.5);
    let ochre = stage.material("boards", palette::OCHRE, 0.6);
    let steel = stage.material("rods", palette::STEEL, 0.4);

    // Each panel is the projection of the one above it from the light's centre: same direction, size by distance.
    let lowest = Vec3::new(-0.65, 0.95, -0.45);
    let mut panels = MeshBuilder::new();
    let mut rods = MeshBuilder::new();
    for height in [0.95f32, 1.3, 1.65, 2.0] {
        let towards_light = (height - lowest.y) / (light_center.y - lowest.y);
        let center = lowest.lerp(light_center, towards_light);
        let half = Vec3::new(0.85, 0.0, 0.6) * (1.0 - towards_light);
        panels.box_between(center - half - Vec3::Y * 0.02, center + half + Vec3::Y * 0.02);
    }
    for (dx, dz) in [(-0.78, -0.53), (0.78, -0.53), (-0.78, 0.53), (0.78, 0.53)] {
        let corner = lowest + Vec3::new(dx, 0.0, dz);
        let foot = corner.lerp(light_center, -lowest.y / (light_center.y - lowest.y));
        let top = corner.lerp(light_center, 1.07 / (light_center.y - lowest.y));
        rods.cylinder(foot - Vec3::Y * SUNK_M, top, 0.02, 10);
    }
    stage.add("panels", paint, panels);
    stage.add("rods", steel, rods);

    // Upright boards, one behind the other along the light's direction over the ground, shrinking likewise.
    let first = Vec3::new(0.35, 0.0, 1.35);
    let along = (Vec3::new(first.x - light_center.x, 0.0, first.z - light_center.z)).normalize();
    let across = along.cross(Vec3::Y).normalize();
    let mut boards = MeshBuilder::new();
    for i in 0..4 {
        let base = first - along * (0.32 * i as f32);
        boards.oriented_box(
            base + Vec3::Y * (0.5 * 0.9 - SUNK_M),
            [across, Vec3::Y, -along],
            Vec3::new(0.45, 0.45, 0.02),
        );
    }
    stage.add("boards", ochre, boards);

    stage.camera(Vec3::new(1.9, 3.4, 5.6), Vec3::new(0.1, 0.62, 0.3), 38.0);
    stage.square_light(0.8, light_center, Vec3::new(0.0, 0.5, 0.3));
    stage.scene
}
