//! `columns`: a ring of columns with the light among them.
//!
//! After the columns of Sintorn, Eisemann & Assarsson, *Sample Based Visibility for Soft Shadows using Alias-free
//! Shadow Maps*, EGSR 2008, figs. 7 and 10: few triangles, long shadows whose width changes along their length.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette};
use crate::Scene;

const COLUMNS: u32 = 8;
const RING_RADIUS_M: f32 = 2.0;
const COLUMN_HEIGHT_M: f32 = 1.8;
const COLUMN_RADIUS_M: f32 = 0.16;

/// Eight columns of 52 triangles, each with a plinth, a capital, a block above it and a lintel to the next: 840 with
/// the floor and the octagonal step.
pub(super) fn columns(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::ZERO, Vec2::splat(9.6), palette::SAND);

    let marble = stage.material("marble", palette::MARBLE, 0.6);
    let stone = stage.material("step", palette::STONE * 1.15, 0.8);
    let spoke = |i: f32| {
        let (sin, cos) = (TAU * i / COLUMNS as f32).sin_cos();
        Vec3::new(sin, 0.0, cos)
    };
    const STEP_M: f32 = 0.14;

    let mut step = MeshBuilder::new();
    let octagon: Vec<Vec2> = (0..8).map(|i| Vec2::from_angle(TAU * i as f32 / 8.0) * (RING_RADIUS_M + 0.55)).collect();
    let upright = Affine3A::from_rotation_translation(Quat::from_rotation_x(-0.25 * TAU), Vec3::new(0.0, -0.02, 0.0));
    step.prism(upright, &octagon, STEP_M + 0.02);
    stage.add("step", stone, step);

    let mut columns = MeshBuilder::new();
    for i in 0..COLUMNS {
        let outward = spoke(i as f32);
        let axes = [Vec3::Y.cross(outward), Vec3::Y, outward];
        let base = outward * RING_RADIUS_M + Vec3::Y * STEP_M;
        let top = base + Vec3::Y * COLUMN_HEIGHT_M;
        columns.oriented_box(base + Vec3::Y * 0.07, axes, Vec3::new(0.22, 0.075, 0.22));
        columns.frustum(base + Vec3::Y * 0.13, top + Vec3::Y * 0.01, COLUMN_RADIUS_M, COLUMN_RADIUS_M * 0.86, 14);
        columns.oriented_box(top + Vec3::Y * 0.07, axes, Vec3::new(0.21, 0.07, 0.21));
        columns.oriented_box(top + Vec3::Y * 0.34, axes, Vec3::new(0.16, 0.21, 0.18));
        let next = spoke(i as f32 + 1.0) * RING_RADIUS_M + Vec3::Y * top.y;
        columns.beam(top + Vec3::Y * 0.28, next + Vec3::Y * 0.28, 0.24, 0.28, Vec3::Y);
    }
    stage.add("columns", marble, columns);

    stage.camera(Vec3::new(1.2, 4.0, 6.6), Vec3::new(0.1, 0.45, 0.7), 44.0);
    stage.square_light(0.5, Vec3::new(-0.4, 5.0, -0.5), Vec3::new(-0.1, 0.0, -0.1));
    stage.scene
}
