//! `staircase`: stairs beside the wall that contains their light, so that wall, rail and treads lie near its horizon.

use antumbra_light::LightShape;
use glam::{Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

const STEPS: usize = 13;
const RISE_M: f32 = 0.18;
const RUN_M: f32 = 0.27;
/// z of the lowest step's front edge, metres; stairs climb towards −z.
const FOOT_Z_M: f32 = 1.6;
/// x of the wall with the light and of the stairs' open side, metres.
const WALL_X_M: f32 = -1.2;
const OPEN_X_M: f32 = 0.0;

pub(super) fn staircase(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    add_well(&mut stage);
    add_steps(&mut stage);
    add_rails(&mut stage);
    stage.camera(Vec3::new(1.75, 1.75, 3.9), Vec3::new(-0.35, 1.15, -0.4), 56.0);
    // Halfway up, one centimetre in front of the plaster.
    let center = Vec3::new(WALL_X_M + 0.01, 1.95, 0.1);
    stage.light(LightShape::Rectangle { size_m: Vec2::new(0.9, 0.35) }, center, center + Vec3::X);
    stage.scene
}

/// Floor, ceiling and the walls on three sides.
fn add_well(stage: &mut Stage) {
    let tiles = stage.material("floor", palette::STONE, 0.7);
    let mut floor = MeshBuilder::new();
    floor.box_between(Vec3::new(-1.5, -0.1, -3.2), Vec3::new(2.9, 0.0, 5.2));
    stage.add("floor", tiles, floor);
    let plaster = stage.material("walls", palette::PLASTER, 0.9);
    let mut walls = MeshBuilder::new();
    // Ends differ a little, so that no two slabs share corners.
    walls.box_between(Vec3::new(WALL_X_M - 0.15, -0.01, -3.1), Vec3::new(WALL_X_M, 4.2, 5.0));
    walls.box_between(Vec3::new(2.5, -0.012, -3.08), Vec3::new(2.65, 4.19, 4.98));
    walls.box_between(Vec3::new(WALL_X_M - 0.14, -0.014, -3.06), Vec3::new(2.64, 4.18, -2.9));
    walls.box_between(Vec3::new(WALL_X_M - 0.13, 4.1, -3.04), Vec3::new(2.63, 4.25, 4.96));
    stage.add("walls", plaster, walls);
}

/// Separate treads and risers, let into the wall.
fn add_steps(stage: &mut Stage) {
    let oak = stage.material("steps", palette::PALE_WOOD, 0.6);
    let mut steps = MeshBuilder::new();
    for i in 0..STEPS {
        let (front, top) = (FOOT_Z_M - RUN_M * i as f32, RISE_M * (i + 1) as f32);
        let step = 0.0004 * i as f32;
        steps.tint(shade(0.37 * i as f32 % 1.0, 0.25));
        steps.box_between(
            Vec3::new(WALL_X_M + 0.012 + step, top - 0.04, front - RUN_M),
            Vec3::new(OPEN_X_M + 0.03, top, front + 0.025),
        );
        steps.box_between(
            Vec3::new(WALL_X_M + 0.02 + step, top - RISE_M + 0.002, front - 0.02),
            Vec3::new(OPEN_X_M - 0.03 - step, top - 0.038, front),
        );
    }
    // The landing, up to the wall behind.
    let top = RISE_M * (STEPS + 1) as f32;
    let front = FOOT_Z_M - RUN_M * STEPS as f32;
    steps.tint(shade(0.5, 0.25));
    steps.box_between(Vec3::new(WALL_X_M + 0.011, top - 0.12, -2.895), Vec3::new(1.2, top, front + 0.02));
    stage.add("steps", oak, steps);
}

/// A rail on brackets along the wall, and balusters with a rail at the open side.
fn add_rails(stage: &mut Stage) {
    let steel = stage.metal("rails", palette::STEEL, 0.45);
    let mut rails = MeshBuilder::new();
    let slope = Vec3::new(0.0, RISE_M, -RUN_M);
    let foot = |x: f32, height: f32| Vec3::new(x, RISE_M + height, FOOT_Z_M - 0.5 * RUN_M);
    let last = (STEPS - 1) as f32;
    rails.cylinder(foot(WALL_X_M + 0.08, 0.9), foot(WALL_X_M + 0.08, 0.9) + last * slope, 0.022, 16);
    for i in [1, 4, 7, 10] {
        let at = foot(WALL_X_M + 0.08, 0.9) + i as f32 * slope;
        rails.cylinder(at - 0.001 * Vec3::Y, Vec3::new(WALL_X_M - 0.01, at.y - 0.07, at.z), 0.008, 8);
    }
    rails.cylinder(foot(OPEN_X_M, 0.95) - 0.4 * slope, foot(OPEN_X_M, 0.95) + (last + 0.4) * slope, 0.028, 16);
    for i in 0..STEPS {
        for half in [-0.25f32, 0.25] {
            let base = foot(OPEN_X_M, 0.0) + i as f32 * slope - half * RUN_M * Vec3::Z;
            let top = base.y + 0.95 + half * RISE_M;
            rails.cylinder(base - 0.02 * Vec3::Y, Vec3::new(base.x, top, base.z), 0.009 + 0.00005 * i as f32, 10);
        }
    }
    stage.add("rails", steel, rails);
}
