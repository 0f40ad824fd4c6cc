//! `knot` and `ten-knots`: one closed surface with a given number of triangles, and ten instances of it.
//!
//! Replaces the torus knot of varying tessellation of Sintorn, Eisemann & Assarsson 2008, fig. 11, and the dragon and the
//! ten dragons of Marrs, Watson & Healey 2014, figs. 1 and 3: much geometry that shadows itself.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Arguments;
use super::noise::{Random, value_noise};
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette};
use crate::Scene;

/// A (2, 3) torus knot with ripples and a rough skin, centred on the origin in the xz plane, 3.1 m across and 1.5 m
/// high. Its number of triangles is `triangles` within 1 %.
fn knot_surface(triangles: f64) -> MeshBuilder {
    const RING_RADIUS_M: f32 = 1.0;
    const WINDING_RADIUS_M: f32 = 0.42;
    const TUBE_RADIUS_M: f32 = 0.2;
    /// Ratio of the knot's length to its girth, which makes the quads about square.
    const COLUMNS_PER_ROW: f64 = 12.0;
    let rows = (0.5 * triangles / COLUMNS_PER_ROW).sqrt().round().max(3.0);
    let columns = (0.5 * triangles / rows).round();

    let center = |turn: f32| {
        let (around, winding) = (2.0 * turn, 3.0 * turn);
        let radius = RING_RADIUS_M + WINDING_RADIUS_M * winding.cos();
        Vec3::new(radius * around.cos(), WINDING_RADIUS_M * winding.sin(), radius * around.sin())
    };
    let at = |turn: f32, girth: f32| {
        const STEP: f32 = 1e-3;
        let (before, here, after) = (center(turn - STEP), center(turn), center(turn + STEP));
        let tangent = (after - before).normalize();
        // Frenet's frame, which closes on itself; the knot's curvature never vanishes.
        let inward = (before + after - 2.0 * here).reject_from(tangent).normalize();
        let binormal = tangent.cross(inward);
        let (sin, cos) = girth.sin_cos();
        // Girth turns against the binormal, so that the grid faces outwards.
        let outward = inward * cos - binormal * sin;
        let ripple = 0.06 * (40.0 * turn + 2.0 * girth).sin() + 0.05 * (3.0 * girth - 14.0 * turn).sin();
        let skin = here + outward * TUBE_RADIUS_M;
        let roughness = 0.12 * value_noise(skin * 6.0) + 0.05 * value_noise(skin * 17.0);
        here + outward * (TUBE_RADIUS_M * (1.0 + ripple + roughness))
    };
    let mut builder = MeshBuilder::new();
    builder.torus_grid(columns as u32, rows as u32, |i, j| {
        at(TAU * i as f32 / columns as f32, TAU * j as f32 / rows as f32)
    });
    builder
}

/// One knot, upright, on a low plinth.
pub(super) fn knot(arguments: &Arguments) -> Scene {
    /// Triangles of ground and plinth.
    const OTHER_TRIANGLES: f64 = 24.0;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.2, 0.2), Vec2::new(8.0, 7.0), palette::SAND);
    let stone = stage.material("plinth", palette::STONE, 0.85);
    let mut plinth = MeshBuilder::new();
    plinth.box_between(Vec3::new(-0.95, -0.005, -0.6), Vec3::new(0.95, 0.16, 0.6));
    stage.add("plinth", stone, plinth);

    let bronze = stage.material("knot", Vec3::new(0.46, 0.24, 0.11), 0.45);
    let knot = stage.mesh("knot", bronze, knot_surface(arguments.get("triangles") - OTHER_TRIANGLES));
    let upright = Quat::from_rotation_y(0.35) * Quat::from_rotation_x(0.25 * TAU) * Quat::from_rotation_y(0.25 * TAU);
    stage.instance(knot, Affine3A::from_rotation_translation(upright, Vec3::new(0.0, 1.74, 0.0)));

    stage.camera(Vec3::new(1.5, 3.3, 6.2), Vec3::new(0.55, 1.3, 0.0), 42.0);
    stage.square_light(0.6, Vec3::new(-2.7, 5.6, -0.9), Vec3::new(0.0, 0.4, 0.2));
    stage.scene
}

/// Ten instances of one mesh of 99 998 triangles: lying, standing, leaning.
pub(super) fn ten_knots(arguments: &Arguments) -> Scene {
    const KNOTS: u32 = 10;
    const TRIANGLES_EACH: f64 = 1e5;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.2, 0.1), Vec2::new(11.4, 8.6), palette::SAND);
    let bronze = stage.material("knot", Vec3::new(0.36, 0.30, 0.17), 0.45);
    let knot = stage.mesh("knot", bronze, knot_surface(TRIANGLES_EACH));
    let mut random = Random::new(10);
    for i in 0..KNOTS {
        // Rows of 3, 4 and 3; every other knot stands on its rim.
        let (row, column, in_row) = match i {
            0..3 => (0, i, 3),
            3..7 => (1, i - 3, 4),
            _ => (2, i - 7, 3),
        };
        let scale = random.range(0.5, 0.66);
        let is_upright = (i + row) % 2 == 0;
        let turn = Quat::from_rotation_y(random.range(0.0, TAU));
        let pose = if is_upright {
            turn * Quat::from_rotation_x(0.25 * TAU) * Quat::from_rotation_y(0.25 * TAU)
        } else {
            turn * Quat::from_rotation_x(random.range(0.0, 0.12))
        };
        let height = scale * if is_upright { 1.6 } else { 0.66 };
        let x = (column as f32 - 0.5 * (in_row - 1) as f32) * 2.35 + random.around_zero(0.15);
        let z = (row as f32 - 1.0) * 2.3 + random.around_zero(0.15);
        let position = Vec3::new(x, height, z);
        stage.instance(knot, Affine3A::from_scale_rotation_translation(Vec3::splat(scale), pose, position));
    }
    stage.camera(Vec3::new(1.5, 5.6, 7.6), Vec3::new(0.2, 0.2, 0.3), 37.0);
    stage.square_light(0.8, Vec3::new(-3.6, 8.4, -1.6), Vec3::new(-0.1, 0.2, 0.1));
    stage.scene
}
