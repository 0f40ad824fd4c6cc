//! `lamp-room` and `hall`: rooms that enclose their light, so that one shadow map cannot cover them.

use std::f32::consts::TAU;

use antumbra_light::LightShape;
use glam::{Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

/// Half extents of the room's floor, and the room's height, metres.
const ROOM_HALF_M: Vec2 = Vec2::new(3.0, 2.5);
const ROOM_HEIGHT_M: f32 = 2.7;
/// Thickness of walls, floor and ceiling, metres.
const WALL_M: f32 = 0.12;

/// A room with a lamp that hangs in its middle: things on all sides of it, on the floor, the walls and the ceiling.
pub(super) fn lamp_room(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    add_shell(&mut stage, ROOM_HALF_M, ROOM_HEIGHT_M);
    let lamp = Vec3::new(0.15, 1.75, -0.1);

    let beams = stage.material("beams", palette::DARK_WOOD * 1.6, 0.7);
    let mut wood = MeshBuilder::new();
    for (i, x) in [-2.1f32, -0.75, 0.9, 2.2].into_iter().enumerate() {
        let from = Vec3::new(x, ROOM_HEIGHT_M - 0.22, -ROOM_HALF_M.y + 0.01);
        wood.tint(shade(0.2 * i as f32, 0.25));
        wood.box_between(from, Vec3::new(x + 0.14, ROOM_HEIGHT_M - 0.03, ROOM_HALF_M.y - 0.01));
    }
    stage.add("beams", beams, wood);

    let iron = stage.metal("cord and rose", palette::IRON, 0.5);
    let mut cord = MeshBuilder::new();
    cord.cylinder(lamp + 0.3 * Vec3::Y, Vec3::new(lamp.x, ROOM_HEIGHT_M - 0.035, lamp.z), 0.012, 10);
    cord.frustum(lamp + 0.22 * Vec3::Y, lamp + 0.36 * Vec3::Y, 0.07, 0.03, 16);
    stage.add("cord and rose", iron, cord);

    let oak = stage.material("furniture", palette::PALE_WOOD, 0.6);
    let mut furniture = MeshBuilder::new();
    add_table(&mut furniture, Vec3::new(0.1, 0.0, 0.1));
    for (i, (x, z)) in [(-1.2f32, 0.2f32), (1.4, 0.0), (0.2, 1.3), (-0.1, -1.25)].into_iter().enumerate() {
        furniture.tint(shade(0.25 * i as f32, 0.3));
        add_stool(&mut furniture, Vec3::new(x, 0.0, z));
    }
    add_shelves(&mut furniture);
    stage.add("furniture", oak, furniture);

    let glaze = stage.material("pots", palette::SLATE_BLUE * 1.6, 0.35);
    let mut pots = MeshBuilder::new();
    for i in 0..9 {
        let turn = TAU * i as f32 / 9.0;
        let at = Vec3::new(0.1 + 0.42 * turn.cos(), 0.742, 0.1 + 0.3 * turn.sin());
        pots.tint(shade(i as f32 / 9.0, 0.5));
        pots.sphere(at + 0.06 * Vec3::Y, 0.055 + 0.004 * (i % 3) as f32, 20, 12);
    }
    for (i, (x, y)) in [(-1.6f32, 1.12f32), (-1.0, 1.12), (0.4, 1.62), (1.1, 1.62), (1.6, 1.12)].into_iter().enumerate()
    {
        pots.tint(shade(0.2 * i as f32, 0.5));
        pots.frustum(Vec3::new(x, y, -2.32), Vec3::new(x, y + 0.24, -2.32), 0.06, 0.1, 18);
    }
    stage.add("pots", glaze, pots);

    stage.camera(Vec3::new(2.55, 1.95, 2.2), Vec3::new(-0.5, 1.05, -0.7), 78.0);
    stage.light(LightShape::Sphere { radius_m: 0.12 }, lamp, Vec3::new(0.1, 0.0, 0.1));
    stage.scene
}

/// Six slabs about a room that stands on y = 0.
fn add_shell(stage: &mut Stage, half_m: Vec2, height_m: f32) {
    let boards = stage.material("floor", palette::WOOD * 1.5, 0.6);
    let plaster = stage.material("walls", palette::PLASTER, 0.9);
    let (x, z) = (half_m.x, half_m.y);
    let mut floor = MeshBuilder::new();
    floor.box_between(Vec3::new(-x - WALL_M, -WALL_M, -z - WALL_M), Vec3::new(x + WALL_M, 0.0, z + WALL_M));
    stage.add("floor", boards, floor);
    let mut walls = MeshBuilder::new();
    let top = height_m + WALL_M;
    // Ends differ a little, so that no two slabs share corners.
    walls.box_between(
        Vec3::new(-x - 0.98 * WALL_M, height_m, -z - 0.98 * WALL_M),
        Vec3::new(x + 0.98 * WALL_M, top, z + 0.98 * WALL_M),
    );
    walls.box_between(
        Vec3::new(-x - 0.9 * WALL_M, -0.01, -z - 0.9 * WALL_M),
        Vec3::new(-x, top - 0.01, z + 0.9 * WALL_M),
    );
    walls.box_between(
        Vec3::new(x, -0.012, -z - 0.9 * WALL_M),
        Vec3::new(x + 0.9 * WALL_M, top - 0.012, z + 0.9 * WALL_M),
    );
    walls.box_between(
        Vec3::new(-x - 0.8 * WALL_M, -0.014, -z - 0.8 * WALL_M),
        Vec3::new(x + 0.8 * WALL_M, top - 0.014, -z),
    );
    walls.box_between(
        Vec3::new(-x - 0.8 * WALL_M, -0.016, z),
        Vec3::new(x + 0.8 * WALL_M, top - 0.016, z + 0.8 * WALL_M),
    );
    stage.add("walls", plaster, walls);
}

fn add_table(furniture: &mut MeshBuilder, at: Vec3) {
    furniture.box_between(at + Vec3::new(-0.75, 0.70, -0.5), at + Vec3::new(0.75, 0.74, 0.5));
    for (i, (x, z)) in [(-0.68f32, -0.43f32), (0.68, -0.43), (-0.68, 0.43), (0.68, 0.43)].into_iter().enumerate() {
        let half = 0.03 + 0.0005 * i as f32;
        furniture.box_between(at + Vec3::new(x - half, -0.002, z - half), at + Vec3::new(x + half, 0.705, z + half));
    }
}

fn add_stool(furniture: &mut MeshBuilder, at: Vec3) {
    furniture.cylinder(at + 0.42 * Vec3::Y, at + 0.46 * Vec3::Y, 0.2, 24);
    for i in 0..3 {
        let turn = TAU * i as f32 / 3.0;
        let out = Vec3::new(turn.cos(), 0.0, turn.sin());
        furniture.cylinder(at + 0.19 * out - 0.002 * Vec3::Y, at + 0.11 * out + 0.43 * Vec3::Y, 0.018, 8);
    }
}

/// Boards on brackets along the wall at −z, and a cupboard beside them.
fn add_shelves(furniture: &mut MeshBuilder) {
    for (i, y) in [1.08f32, 1.58].into_iter().enumerate() {
        let step = 0.001 * i as f32;
        furniture.tint(shade(0.3 + 0.4 * i as f32, 0.2));
        furniture.box_between(Vec3::new(-1.9 + step, y, -2.495), Vec3::new(1.9 - step, y + 0.03, -2.15));
        for x in [-1.7f32, 0.0, 1.7] {
            furniture.box_between(Vec3::new(x, y - 0.2, -2.496), Vec3::new(x + 0.03, y + 0.002, -2.2));
        }
    }
    furniture.tint(shade(0.6, 0.3));
    furniture.box_between(Vec3::new(-2.99, 0.0, -0.7), Vec3::new(-2.5, 1.5, 0.9));
}

/// Half extents of the hall's floor, and the hall's height, metres.
const HALL_HALF_M: Vec2 = Vec2::new(9.0, 6.0);
const HALL_HEIGHT_M: f32 = 7.0;

/// A hall of one mesh, columns and galleries included. Its bounding box contains the light and gives no near plane.
pub(super) fn hall(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    let stone = stage.material("hall", palette::STONE * 1.2, 0.85);
    let mut hall = MeshBuilder::new();
    let (x, z, top) = (HALL_HALF_M.x, HALL_HALF_M.y, HALL_HEIGHT_M);
    hall.box_between(Vec3::new(-x - 0.5, -0.3, -z - 0.5), Vec3::new(x + 0.5, 0.0, z + 0.5));
    hall.box_between(Vec3::new(-x - 0.49, top, -z - 0.49), Vec3::new(x + 0.49, top + 0.3, z + 0.49));
    for (i, side) in [-1.0f32, 1.0].into_iter().enumerate() {
        let step = 0.002 * i as f32;
        let (near, far) = (side * x, side * (x + 0.45));
        hall.box_between(
            Vec3::new(near.min(far), -0.2 - step, -z - 0.47),
            Vec3::new(near.max(far), top + 0.2 + step, z + 0.47),
        );
        let (near, far) = (side * z, side * (z + 0.44));
        hall.box_between(
            Vec3::new(-x - 0.46, -0.21 - step, near.min(far)),
            Vec3::new(x + 0.46, top + 0.21 + step, near.max(far)),
        );
        // A gallery, with a railing.
        let (inner, outer) = (side * 4.4, side * (z - 0.01));
        hall.box_between(Vec3::new(-x + 0.01, 3.6, inner.min(outer)), Vec3::new(x - 0.01, 3.85, inner.max(outer)));
        hall.beam(Vec3::new(-x + 0.02, 4.75, side * 4.5), Vec3::new(x - 0.02, 4.75, side * 4.5), 0.08, 0.06, Vec3::Y);
        for post in 0..35 {
            let at = Vec3::new(-x + 0.25 + 0.5 * post as f32, 3.84, side * 4.5);
            hall.box_between(at - Vec3::new(0.02, 0.0, 0.02), at + Vec3::new(0.02, 0.9, 0.02));
        }
        for column in 0..6 {
            let at = Vec3::new(-7.5 + 3.0 * column as f32, -0.005, side * 4.2);
            hall.tint(shade(0.15 * column as f32, 0.15));
            hall.cylinder(at, at + 3.65 * Vec3::Y, 0.22, 24);
            hall.box_on(at, Vec3::new(0.62, 0.2, 0.62));
        }
    }
    for (i, (x, z)) in [(-5.0f32, -0.8f32), (-2.2, 1.1), (1.5, -1.4), (4.6, 0.9), (6.8, -1.0)].into_iter().enumerate() {
        hall.tint(shade(0.2 * i as f32, 0.3));
        hall.box_on(Vec3::new(x, -0.003, z), Vec3::new(1.1, 0.9 + 0.15 * i as f32, 0.8));
    }
    stage.add("hall", stone, hall);
    stage.camera(Vec3::new(-8.2, 2.4, 3.4), Vec3::new(2.0, 1.8, -1.0), 64.0);
    let at = Vec3::new(-0.4, 5.2, 0.3);
    stage.light(LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) }, at, at - Vec3::Y);
    stage.scene
}
