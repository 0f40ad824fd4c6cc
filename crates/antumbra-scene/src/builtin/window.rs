//! `window`: a room lit through a latticed window.
//!
//! After the scene of Marrs, Watson & Healey, *Real-Time Soft Shadowing via Fragment Reprojection*, 2014, fig. 6 top:
//! 780 triangles, all of boxes, with regular bars that reveal the quality of light sampling.

use glam::{Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

/// The opening in the wall: x from −1 to 1, y from 0.85 to 2.55 metres.
const OPENING: (Vec2, Vec2) = (Vec2::new(-1.0, 0.85), Vec2::new(1.0, 2.55));
/// The wall's outer and inner faces, metres along z; the room is at +z.
const WALL_Z_M: (f32, f32) = (-0.22, 0.0);

/// The room, of 65 boxes.
pub(super) fn window(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    let boards = stage.material("floor", palette::WOOD * 1.5, 0.6);
    let mut floor = MeshBuilder::new();
    floor.box_between(Vec3::new(-3.6, -0.1, WALL_Z_M.0 - 0.1), Vec3::new(3.2, 0.0, 4.6));
    stage.add("floor", boards, floor);
    add_wall(&mut stage);
    add_frame(&mut stage);
    add_sill(&mut stage);
    add_shutters(&mut stage);

    let oak = stage.material("furniture", palette::WOOD, 0.55);
    let mut furniture = MeshBuilder::new();
    add_table(&mut furniture);
    furniture.tint(shade(0.9, 0.3));
    add_chair(&mut furniture);
    add_stool(&mut furniture);
    furniture.tint(shade(0.3, 0.3));
    add_chest(&mut furniture);
    stage.add("furniture", oak, furniture);

    stage.camera(Vec3::new(1.7, 2.6, 5.3), Vec3::new(0.05, 0.72, 1.2), 42.0);
    stage.square_light(0.4, Vec3::new(-0.9, 4.6, -3.4), Vec3::new(0.1, 0.6, 1.2));
    stage.scene
}

/// Four boxes that overlap a little at the corners of the opening.
fn add_wall(stage: &mut Stage) {
    let (low, high) = OPENING;
    let (outer, inner) = WALL_Z_M;
    let plaster = stage.material("wall", palette::PLASTER, 0.9);
    let mut wall = MeshBuilder::new();
    wall.box_between(Vec3::new(-3.5, -0.01, outer), Vec3::new(low.x, 3.1, inner));
    wall.box_between(Vec3::new(high.x, -0.012, outer), Vec3::new(3.1, 3.102, inner));
    wall.box_between(Vec3::new(low.x - 0.1, -0.014, outer + 0.002), Vec3::new(high.x + 0.1, low.y, inner - 0.002));
    wall.box_between(Vec3::new(low.x - 0.1, high.y, outer + 0.002), Vec3::new(high.x + 0.1, 3.098, inner - 0.002));
    stage.add("wall", plaster, wall);
}

/// A frame around the opening, and the lattice in it.
fn add_frame(stage: &mut Stage) {
    let (low, high) = OPENING;
    let (outer, inner) = WALL_Z_M;
    let white = stage.material("frame", Vec3::new(0.68, 0.66, 0.60), 0.5);
    let mut frame = MeshBuilder::new();
    let middle = 0.5 * (outer + inner);
    let depth = Vec3::new(0.0, 0.0, 0.04);
    let mut bar = |a: Vec2, b: Vec2, half_depth: Vec3| {
        frame.box_between(a.extend(middle) - half_depth, b.extend(middle) + half_depth);
    };
    const FRAME_M: f32 = 0.07;
    bar(low + Vec2::new(-0.01, -0.01), Vec2::new(low.x + FRAME_M, high.y + 0.01), depth);
    bar(Vec2::new(high.x - FRAME_M, low.y - 0.01), high + Vec2::new(0.01, 0.012), depth);
    bar(low + Vec2::new(0.01, -0.012), Vec2::new(high.x - 0.01, low.y + FRAME_M), depth * 0.95);
    bar(Vec2::new(low.x + 0.01, high.y - FRAME_M), high + Vec2::new(-0.01, 0.014), depth * 0.95);
    // The lattice: bars of 3.5 cm, a mullion of 6 cm.
    const BAR_HALF_M: f32 = 0.0175;
    for (i, x) in [-0.6f32, -0.2, 0.2, 0.6].into_iter().enumerate() {
        let half = BAR_HALF_M + 0.0001 * i as f32;
        bar(Vec2::new(x - half, low.y), Vec2::new(x + half, high.y), depth * 0.5);
    }
    for (i, y) in [1.275f32, 1.7, 2.125].into_iter().enumerate() {
        let half = BAR_HALF_M + 0.0001 * i as f32;
        bar(Vec2::new(low.x, y - half), Vec2::new(high.x, y + half), depth * 0.4);
    }
    stage.add("frame", white, frame);
}

/// A sill, and skirting along the wall.
fn add_sill(stage: &mut Stage) {
    let (low, _) = OPENING;
    let (outer, inner) = WALL_Z_M;
    let middle = 0.5 * (outer + inner);
    let wood = stage.material("sill", palette::PALE_WOOD, 0.6);
    let mut sill = MeshBuilder::new();
    sill.box_between(Vec3::new(-1.12, low.y - 0.04, middle + 0.03), Vec3::new(1.12, low.y + 0.005, inner + 0.16));
    for (x0, x1) in [(-3.48, -0.02), (0.02, 3.08)] {
        sill.box_between(Vec3::new(x0, -0.005, inner - 0.02), Vec3::new(x1, 0.12, inner + 0.02));
    }
    stage.add("sill and skirting", wood, sill);
}

/// Two shutters, open at a right angle into the room.
fn add_shutters(stage: &mut Stage) {
    let (low, high) = OPENING;
    let (_, inner) = WALL_Z_M;
    let paint = stage.material("shutters", palette::TEAL_PAINT, 0.5);
    let mut shutters = MeshBuilder::new();
    for (x, side) in [(low.x - 0.06, -1.0), (high.x + 0.06, 1.0)] {
        let hinge = Vec3::new(x, 0.0, inner + 0.02);
        let out = Vec3::new(0.5 * side, 0.0, 0.866);
        let across = Vec3::Y.cross(out) * 0.02;
        let height = high.y - low.y;
        let post = |s: f32| hinge + out * s + Vec3::Y * low.y;
        for s in [0.04, 0.9] {
            shutters.beam(post(s), post(s) + Vec3::Y * height, 0.08, 0.04, across);
        }
        for y in [0.045, height - 0.045] {
            shutters.beam(post(0.01) + Vec3::Y * y, post(0.93) + Vec3::Y * y, 0.08, 0.036, across);
        }
        for i in 0..8 {
            let y = 0.15 + (height - 0.3) * (i as f32 + 0.5) / 8.0;
            shutters.beam(post(0.05) + Vec3::Y * y, post(0.89) + Vec3::Y * y, 0.13, 0.022, across + Vec3::Y * 0.014);
        }
    }
    stage.add("shutters", paint, shutters);
}

/// A table with three books: 8 boxes.
fn add_table(furniture: &mut MeshBuilder) {
    let table = Vec3::new(1.75, 0.0, 1.35);
    furniture.box_on(table + Vec3::Y * 0.71, Vec3::new(1.3, 0.045, 0.75));
    for (x, z) in [(-0.57, -0.3), (0.57, -0.3), (-0.57, 0.3), (0.57, 0.3)] {
        furniture.box_on(table + Vec3::new(x, -0.005, z), Vec3::new(0.06, 0.72, 0.06));
    }
    for (i, (color, turn)) in
        [(palette::RED_PAINT, 0.2f32), (palette::SLATE_BLUE, -0.15), (palette::OCHRE, 0.45)].into_iter().enumerate()
    {
        furniture.tint(color / palette::WOOD);
        let (sin, cos) = turn.sin_cos();
        let axes = [Vec3::new(cos, 0.0, -sin), Vec3::Y, Vec3::new(sin, 0.0, cos)];
        let center = table + Vec3::new(0.25, 0.775 + 0.045 * i as f32, 0.02);
        furniture.oriented_box(center, axes, Vec3::new(0.14, 0.0235, 0.1));
    }
}

/// A chair: 9 boxes.
fn add_chair(furniture: &mut MeshBuilder) {
    let chair = Vec3::new(-1.0, 0.0, 2.15);
    furniture.box_on(chair + Vec3::Y * 0.43, Vec3::new(0.45, 0.04, 0.44));
    for (x, z, height) in [(-0.19, -0.19, 0.44), (0.19, -0.19, 0.44), (-0.19, 0.19, 0.95), (0.19, 0.19, 0.95)] {
        furniture.box_on(chair + Vec3::new(x, -0.005, z), Vec3::new(0.045, height, 0.045));
    }
    for y in [0.62, 0.8] {
        furniture.box_on(chair + Vec3::new(0.0, y, 0.19), Vec3::new(0.4, 0.1, 0.025));
    }
    for x in [-0.19, 0.19] {
        furniture.box_on(chair + Vec3::new(x, 0.2, 0.0), Vec3::new(0.03, 0.035, 0.4));
    }
}

/// A stool: 3 boxes.
fn add_stool(furniture: &mut MeshBuilder) {
    let stool = Vec3::new(0.35, 0.0, 2.45);
    furniture.box_on(stool + Vec3::Y * 0.4, Vec3::new(0.42, 0.04, 0.32));
    for x in [-0.16, 0.16] {
        furniture.box_on(stool + Vec3::new(x, -0.005, 0.0), Vec3::new(0.035, 0.41, 0.28));
    }
}

/// A chest against the wall: 2 boxes.
fn add_chest(furniture: &mut MeshBuilder) {
    let chest = Vec3::new(-2.1, 0.0, 0.4);
    furniture.box_on(chest - Vec3::Y * 0.005, Vec3::new(0.9, 0.46, 0.48));
    furniture.box_on(chest + Vec3::Y * 0.45, Vec3::new(0.95, 0.05, 0.52));
}
