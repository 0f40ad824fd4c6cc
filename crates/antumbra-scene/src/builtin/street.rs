//! `street`: a market street of many layers: tiled roofs, awnings, wires, lanterns, balconies, stalls.
//!
//! After the *Streets of Asia* scene of 400 000 triangles of Selgrad, Dachsbacher, Meyer & Stamminger 2014, fig. 16:
//! "a more game-like scene", whose depth complexity seen from the light is high.
//!
//! The street runs along z. A place on a row of houses is given by its side (−1 left, +1 right), its z, its height and
//! its distance from the facades towards the street's middle.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Mat3, Quat, Vec2, Vec3};

use super::Arguments;
use super::noise::Random;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

/// Distance from the street's middle to the facades, metres.
const HALF_WIDTH_M: f32 = 2.9;
/// Number of houses per row.
const HOUSES: usize = 5;
/// Width of a house along the street, metres.
const HOUSE_M: f32 = 4.2;
/// z of the beginning of the rows, metres; they run towards −z.
const FIRST_Z_M: f32 = 4.4;

/// Mesh builders, one per material.
#[derive(Default)]
struct Parts {
    walls: MeshBuilder,
    wood: MeshBuilder,
    tiles: MeshBuilder,
    iron: MeshBuilder,
    cloth: MeshBuilder,
    paper: MeshBuilder,
    fruit: MeshBuilder,
    paving: MeshBuilder,
}

/// World position of a place on a row of houses.
fn on(side: f32, z: f32, height: f32, out: f32) -> Vec3 {
    Vec3::new(side * (HALF_WIDTH_M - out), height, z)
}

pub(super) fn street(arguments: &Arguments) -> Scene {
    const TRIANGLES: usize = 400_000;
    let mut random = Random::new(400);
    let mut parts = Parts::default();
    let mut crates: Vec<(Vec3, Vec3)> = Vec::new();
    add_paving(&mut parts, &mut random);
    for side in [-1.0, 1.0] {
        for house in 0..HOUSES {
            add_house(&mut parts, &mut random, side, house);
            add_stall(&mut parts, &mut random, &mut crates, side, house);
        }
    }
    add_overhead(&mut parts, &mut random);
    add_clutter(&mut parts, &mut random);

    let mut stage = Stage::new(arguments.scene);
    let length = HOUSE_M * HOUSES as f32;
    stage.ground(
        Vec2::new(0.0, FIRST_Z_M - 0.5 * length),
        Vec2::new(2.0 * HALF_WIDTH_M + 5.4, length + 1.5),
        palette::STONE * 0.6,
    );
    let surfaces = [
        ("walls", palette::PLASTER, 0.9),
        ("wood", palette::WOOD * 0.8, 0.7),
        ("tiles", Vec3::new(0.20, 0.20, 0.22), 0.6),
        ("iron", palette::IRON, 0.5),
        ("cloth", Vec3::ONE * 0.8, 0.9),
        ("lanterns", palette::RED_PAINT * 1.5, 0.6),
        ("paving", palette::STONE * 0.85, 0.9),
    ];
    let Parts { walls, wood, tiles, iron, cloth, paper, mut fruit, paving } = parts;
    let builders = [walls, wood, tiles, iron, cloth, paper, paving];
    for ((name, color, roughness), builder) in surfaces.into_iter().zip(builders) {
        let material = stage.material(name, color, roughness);
        stage.add(name, material, builder);
    }
    // Fruit in the crates uses up the remaining triangles.
    const SEGMENTS: u32 = 14;
    const RINGS: u32 = 9;
    let triangles_each = (2 * SEGMENTS * (RINGS - 1)) as usize;
    let pieces = (TRIANGLES - stage.triangle_count() - fruit.triangle_count()) / triangles_each;
    let kinds = [
        Vec3::new(0.95, 0.35, 0.03),
        Vec3::new(0.65, 0.05, 0.04),
        Vec3::new(0.75, 0.62, 0.06),
        Vec3::new(0.22, 0.42, 0.05),
        Vec3::new(0.35, 0.06, 0.28),
    ];
    for piece in 0..pieces {
        let (index, place) = (piece % crates.len(), piece / crates.len());
        let (corner, size) = crates[index];
        const ROW: usize = 5;
        let (i, j, layer) = (place % ROW, place / ROW % ROW, place / (ROW * ROW));
        let cell = Vec3::new(size.x, 0.0, size.z) / ROW as f32;
        let offset = 0.5 * (layer % 2) as f32;
        let center = corner
            + cell * (Vec3::new(i as f32, 0.0, j as f32) * 0.94 + 0.5 + 0.3 * offset)
            + Vec3::new(random.around_zero(0.006), 0.0, random.around_zero(0.006))
            + Vec3::Y * (size.y + 0.055 * layer as f32 - 0.02);
        fruit.tint(kinds[index % kinds.len()] * shade(random.unit(), 0.2));
        fruit.sphere(center, random.range(0.036, 0.046), SEGMENTS, RINGS);
    }
    let material = stage.material("fruit", Vec3::splat(0.8), 0.4);
    stage.add("fruit", material, fruit);

    stage.camera(Vec3::new(0.5, 3.1, 7.4), Vec3::new(-0.1, 1.75, -3.0), 46.0);
    stage.square_light(1.4, Vec3::new(-1.7, 14.5, 2.0), Vec3::new(0.3, 0.0, -4.5));
    stage.scene
}

/// Slabs of stone in courses, with joints.
fn add_paving(parts: &mut Parts, random: &mut Random) {
    const COURSE_M: f32 = 0.36;
    let courses = (HOUSE_M * HOUSES as f32 / COURSE_M) as usize;
    for course in 0..courses {
        let z = FIRST_Z_M - (course as f32 + 0.5) * COURSE_M;
        let mut x = -HALF_WIDTH_M - 0.3 * random.unit();
        while x < HALF_WIDTH_M {
            let width = random.range(0.35, 0.65);
            let top = random.range(0.012, 0.024);
            parts.paving.tint(shade(random.unit(), 0.18));
            let (low, high) = (
                Vec3::new(x, -0.02, z - 0.5 * COURSE_M + 0.008),
                Vec3::new(x + width - 0.014, top, z + 0.5 * COURSE_M - 0.008),
            );
            parts.paving.box_between(low, high);
            x += width;
        }
    }
}

fn add_house(parts: &mut Parts, random: &mut Random, side: f32, house: usize) {
    let z1 = FIRST_Z_M - HOUSE_M * house as f32;
    let z0 = z1 - HOUSE_M;
    let middle = 0.5 * (z0 + z1);
    let eaves = 4.5 + 0.9 * random.unit() + if house.is_multiple_of(2) { 0.5 } else { 0.0 };
    let washes = [
        Vec3::new(1.0, 1.0, 1.0),
        Vec3::new(1.05, 0.82, 0.62),
        Vec3::new(0.75, 0.85, 0.82),
        Vec3::new(1.0, 0.72, 0.66),
        Vec3::new(0.86, 0.8, 0.66),
    ];
    parts.walls.tint(washes[(house * 2 + usize::from(side > 0.0)) % washes.len()]);
    let gap = 0.03 + 0.01 * house as f32;
    parts.walls.box_between(on(side, z0 + gap, -0.03, 0.0), on(side, z1 - gap, eaves + 0.1, -2.6));

    // Timber: corner posts, storey beams, and the eaves' rafters.
    parts.wood.tint(shade(random.unit(), 0.3));
    for z in [z0 + 0.12, middle + 0.03, z1 - 0.12] {
        board(&mut parts.wood, side, (z - 0.08, z + 0.08), (-0.01, eaves), (-0.04, 0.05));
    }
    for y in [0.12, 2.55, eaves - 0.1] {
        board(&mut parts.wood, side, (z0 + 0.05, z1 - 0.05), (y - 0.07, y + 0.07), (-0.03, 0.06));
    }

    add_shop(parts, random, side, z0, middle);

    add_windows(parts, random, side, z0, eaves);
    if (house + usize::from(side > 0.0)).is_multiple_of(2) {
        add_balcony(parts, random, side, middle, 2.72);
    } else {
        let shift = random.around_zero(0.8);
        add_air_conditioner(parts, side, middle + shift, 2.75);
        add_air_conditioner(parts, side, z0 + 0.6, 2.75);
    }
    add_roof(parts, random, side, (z0, z1), eaves);
    let insets = [(); 2].map(|()| random.range(0.5, 1.2));
    add_sign(parts, random, side, z0 + insets[0], 2.5);
    add_sign(parts, random, side, z1 - insets[1], 3.1);
}

/// Adds a box at a house's front, given by its extents along the street, in height, and out of the wall.
fn board(mesh: &mut MeshBuilder, side: f32, z: (f32, f32), y: (f32, f32), out: (f32, f32)) {
    mesh.box_between(on(side, z.0, y.0, out.0), on(side, z.1, y.1, out.1));
}

/// The ground floor of the house that begins at `z0`: a door, and from its middle on a shop front behind bars.
fn add_shop(parts: &mut Parts, random: &mut Random, side: f32, z0: f32, middle: f32) {
    parts.wood.tint(Vec3::new(0.6, 1.2, 1.3) * shade(random.unit(), 0.2));
    let door = z0 + 0.85;
    board(&mut parts.wood, side, (door - 0.45, door + 0.45), (0.0, 2.1), (-0.02, 0.03));
    for k in 0..4 {
        let y = 0.3 + 0.46 * k as f32;
        board(&mut parts.wood, side, (door - 0.36, door + 0.36), (y, y + 0.32), (0.0, 0.045));
    }
    parts.wood.tint(shade(random.unit(), 0.3));
    for k in 0..12 {
        let z = middle + 0.3 + 0.14 * k as f32;
        board(&mut parts.wood, side, (z - 0.02, z + 0.02), (0.7, 2.3), (0.05, 0.09));
    }
    for y in [0.7, 1.5, 2.3] {
        board(&mut parts.wood, side, (middle + 0.22, middle + 1.92), (y - 0.04, y + 0.04), (0.03, 0.08));
    }
}

/// The upper floor: latticed windows with louvred shutters.
fn add_windows(parts: &mut Parts, random: &mut Random, side: f32, z0: f32, eaves: f32) {
    let paint = [Vec3::new(0.25, 0.9, 0.8), Vec3::new(1.3, 0.35, 0.25), Vec3::new(0.4, 0.6, 1.2)][random.below(3)];
    for window in 0..3 {
        let z = z0 + HOUSE_M * (window as f32 + 0.5) / 3.0;
        let (low, high) = (3.05, eaves - 0.45);
        parts.wood.tint(shade(random.unit(), 0.3));
        for (a, b) in [(z - 0.34, z - 0.28), (z + 0.28, z + 0.34)] {
            board(&mut parts.wood, side, (a, b), (low - 0.05, high + 0.05), (-0.02, 0.05));
        }
        board(&mut parts.wood, side, (z - 0.4, z + 0.4), (low - 0.07, low), (-0.01, 0.12));
        board(&mut parts.wood, side, (z - 0.36, z + 0.36), (high, high + 0.06), (-0.01, 0.07));
        for k in 1..6 {
            let bar = z - 0.28 + 0.56 * k as f32 / 6.0;
            board(&mut parts.wood, side, (bar - 0.011, bar + 0.011), (low, high), (0.012, 0.034));
        }
        for k in 1..6 {
            let bar = low + (high - low) * k as f32 / 6.0;
            board(&mut parts.wood, side, (z - 0.29, z + 0.29), (bar - 0.011, bar + 0.011), (0.01, 0.03));
        }
        // Shutters stand open at various angles.
        parts.wood.tint(paint * shade(random.unit(), 0.25));
        for (hinge, sign) in [(z - 0.36, -1.0f32), (z + 0.36, 1.0)] {
            let open = random.range(0.3, 1.2);
            let swing = Vec3::new(-side * open.sin(), 0.0, sign * open.cos());
            let depth = swing.cross(Vec3::Y);
            let post = |s: f32, y: f32| on(side, hinge, y, 0.06) + swing * s;
            for s in [0.02, 0.3] {
                parts.wood.beam(post(s, low), post(s, high), 0.035, 0.03, depth);
            }
            let slats = 10;
            for k in 0..slats {
                let y = low + (high - low) * (k as f32 + 0.5) / slats as f32;
                parts.wood.beam(post(0.0, y), post(0.32, y), 0.09, 0.012, depth + Vec3::Y * 0.8);
            }
        }
    }
}

/// Rows of half-pipe tiles on a slab that overhangs the street.
fn add_roof(parts: &mut Parts, random: &mut Random, side: f32, z: (f32, f32), eaves_m: f32) {
    const PITCH_RAD: f32 = 0.42;
    const OVERHANG_M: f32 = 0.75;
    const SLOPE_LENGTH_M: f32 = 2.6;
    const TILE_PITCH_M: Vec2 = Vec2::new(0.2, 0.3);
    let (sin, cos) = PITCH_RAD.sin_cos();
    let down = Vec3::new(-side * cos, -sin, 0.0);
    let up = Vec3::new(-side * sin, cos, 0.0);
    let across = up.cross(down);
    let edge = on(side, 0.5 * (z.0 + z.1), eaves_m + 0.05, OVERHANG_M);
    let half_width = 0.5 * (z.1 - z.0) - 0.02;
    let axes = [across, up, down];
    parts.tiles.tint(Vec3::splat(0.7));
    let center = edge - down * (0.5 * SLOPE_LENGTH_M);
    parts.tiles.oriented_box(center, axes, Vec3::new(half_width, 0.03, 0.5 * SLOPE_LENGTH_M));
    // A ridge, and a wall's top behind it.
    let ridge = edge - down * SLOPE_LENGTH_M + up * 0.1;
    parts.tiles.cylinder(ridge - Vec3::Z * half_width, ridge + Vec3::Z * half_width, 0.12, 16);

    const ARC_POINTS: usize = 11;
    let arc = |radius_m: f32| -> Vec<Vec2> {
        (0..ARC_POINTS)
            .map(|k| {
                let (sin, cos) = (PI * (1.0 - k as f32 / (ARC_POINTS - 1) as f32)).sin_cos();
                Vec2::new(cos, 0.75 * sin) * radius_m
            })
            .collect()
    };
    let (lower, upper) = (arc(0.075), arc(0.095));
    let columns = (2.0 * half_width / TILE_PITCH_M.x) as usize;
    let rows = (SLOPE_LENGTH_M / TILE_PITCH_M.y) as usize;
    for row in 0..rows {
        for column in 0..columns {
            let s = (column as f32 + 0.5) / columns as f32 * 2.0 - 1.0;
            let start = edge - down * ((row as f32 + 1.0) * TILE_PITCH_M.y - 0.06)
                + across * (s * half_width)
                + up * random.range(0.028, 0.036);
            // Each tile lies on the one below it.
            let tilt = Quat::from_axis_angle(across, -0.05 + random.around_zero(0.015));
            let turn = tilt * Quat::from_axis_angle(up, random.around_zero(0.02));
            let frame = Mat3::from_quat(turn) * Mat3::from_cols(across, up, down);
            parts.tiles.tint(shade(random.unit(), 0.25));
            let part = Affine3A::from_mat3_translation(frame, start + up * 0.012);
            parts.tiles.strip_prism(part, &lower, &upper, TILE_PITCH_M.y + 0.05);
        }
    }
    parts.wood.tint(shade(random.unit(), 0.3));
    for k in 0..14 {
        let z = Vec3::Z * (half_width * ((k as f32 + 0.5) / 7.0 - 1.0));
        let tail = edge + z - up * 0.07;
        parts.wood.beam(tail - down * 1.0, tail - down * 0.04, 0.06, 0.08, up);
    }
}

fn add_balcony(parts: &mut Parts, random: &mut Random, side: f32, z: f32, height: f32) {
    const HALF_M: f32 = 1.25;
    const DEPTH_M: f32 = 0.75;
    parts.wood.tint(shade(random.unit(), 0.25));
    parts.wood.box_between(on(side, z - HALF_M, height - 0.08, -0.05), on(side, z + HALF_M, height, DEPTH_M));
    for s in [-1.0, 0.0, 1.0] {
        let foot = on(side, z + s * (HALF_M - 0.1), height - 0.65, 0.0);
        let head = on(side, z + s * (HALF_M - 0.1), height - 0.06, 0.6);
        parts.wood.beam(foot, head, 0.06, 0.06, Vec3::Y);
    }
    let rail = height + 0.85;
    parts.wood.box_between(
        on(side, z - HALF_M - 0.02, rail, DEPTH_M - 0.09),
        on(side, z + HALF_M + 0.02, rail + 0.05, DEPTH_M + 0.01),
    );
    for s in [-1.0, 1.0] {
        let at = z + s * (HALF_M - 0.04);
        parts
            .wood
            .box_between(on(side, at - 0.03, rail + 0.004, 0.0), on(side, at + 0.03, rail + 0.046, DEPTH_M - 0.02));
    }
    let baluster = [
        (0.0, -0.02),
        (0.024, -0.02),
        (0.024, 0.1),
        (0.014, 0.2),
        (0.032, 0.4),
        (0.014, 0.62),
        (0.024, 0.75),
        (0.024, 0.87),
        (0.0, 0.87),
    ];
    let profile = baluster.map(Vec2::from);
    let count = 15;
    for k in 0..count {
        let at = z - HALF_M + 0.05 + (2.0 * HALF_M - 0.1) * k as f32 / (count - 1) as f32;
        parts.wood.lathe(on(side, at, height, DEPTH_M - 0.04), Vec3::Y, &profile, 10);
    }
    for k in 1..4 {
        for s in [-1.0, 1.0] {
            let at = z + s * (HALF_M - 0.04);
            parts.wood.lathe(on(side, at, height, DEPTH_M - 0.04 - 0.18 * k as f32), Vec3::Y, &profile, 10);
        }
    }
    // Pots on the balcony with stiff pointed leaves.
    for s in [-0.8, 0.1, 0.75] {
        add_pot(parts, random, on(side, z + s, height - 0.005, 0.45), 0.8);
    }
}

/// A clay pot with a plant of cones.
fn add_pot(parts: &mut Parts, random: &mut Random, base: Vec3, scale: f32) {
    let profile =
        [(0.0, 0.0), (0.1, 0.0), (0.15, 0.2), (0.17, 0.21), (0.17, 0.26), (0.14, 0.26), (0.13, 0.22), (0.0, 0.22)];
    parts.fruit.tint(palette::TERRACOTTA * 1.3);
    parts.fruit.lathe(base, Vec3::Y, &profile.map(|(r, h)| Vec2::new(r, h) * scale), 18);
    for _ in 0..26 {
        let out = random.in_disc();
        let root = base + Vec3::new(0.09 * out.x, 0.2, 0.09 * out.y) * scale;
        let tip = root + Vec3::new(0.34 * out.x, random.range(0.3, 0.55), 0.34 * out.y) * scale;
        parts.fruit.tint(palette::LEAF * 1.3 * shade(random.unit(), 0.35));
        parts.fruit.cone(root, tip, 0.022 * scale, 6);
    }
}

fn add_air_conditioner(parts: &mut Parts, side: f32, z: f32, height: f32) {
    parts.walls.tint(Vec3::splat(0.85));
    parts.walls.box_between(on(side, z - 0.36, height, 0.08), on(side, z + 0.36, height + 0.5, 0.36));
    parts.iron.tint(Vec3::splat(3.0));
    for k in 0..12 {
        let y = height + 0.05 + 0.036 * k as f32;
        parts.iron.box_between(on(side, z - 0.32, y, 0.35), on(side, z + 0.32, y + 0.012, 0.385));
    }
    for s in [-0.28, 0.28] {
        parts
            .iron
            .box_between(on(side, z + s - 0.02, height - 0.04, -0.01), on(side, z + s + 0.02, height + 0.01, 0.38));
    }
    // A hose that runs down the wall.
    let points: Vec<Vec3> = (0..=14)
        .map(|k| {
            let t = k as f32 / 14.0;
            on(side, z + 0.42 + 0.05 * (9.0 * t).sin(), height + 0.25 - 2.0 * t, 0.09 + 0.02 * (7.0 * t).cos())
        })
        .collect();
    parts.iron.tube(&points, 8, |_| 0.018);
}

/// A framed board that hangs out over the street on two arms, with strokes that stand for writing.
fn add_sign(parts: &mut Parts, random: &mut Random, side: f32, z: f32, height: f32) {
    let colors = [
        Vec3::new(0.55, 0.06, 0.05),
        Vec3::new(0.75, 0.52, 0.08),
        Vec3::new(0.06, 0.28, 0.3),
        Vec3::new(0.7, 0.66, 0.58),
    ];
    let (tall, wide) = (random.range(0.9, 1.5), random.range(0.4, 0.55));
    let out = 0.3;
    let color = random.below(colors.len());
    parts.cloth.tint(colors[color]);
    parts.cloth.box_between(on(side, z - 0.03, height, out), on(side, z + 0.03, height + tall, out + wide));
    parts.wood.tint(Vec3::splat(0.5));
    for y in [height - 0.02, height + tall - 0.03] {
        parts.wood.box_between(on(side, z - 0.045, y, out - 0.03), on(side, z + 0.045, y + 0.05, out + wide + 0.03));
    }
    for edge in [out - 0.025, out + wide - 0.02] {
        parts.wood.box_between(
            on(side, z - 0.042, height + 0.01, edge),
            on(side, z + 0.042, height + tall - 0.01, edge + 0.045),
        );
    }
    parts.iron.tint(Vec3::ONE);
    for y in [height + 0.15, height + tall - 0.15] {
        parts.iron.cylinder(on(side, z, y, -0.05), on(side, z, y, out + 0.05), 0.015, 10);
    }
    parts.cloth.tint(colors[(color + 3) % colors.len()]);
    let glyphs = (tall / 0.3) as usize;
    for glyph in 0..glyphs {
        let middle = height + tall * (glyph as f32 + 0.5) / glyphs as f32;
        for stroke in 0..5 {
            let (y, o) = (middle + random.around_zero(0.09), out + wide * (0.5 + random.around_zero(0.2)));
            let (half_y, half_o) = if stroke % 2 == 0 { (0.012, 0.11) } else { (0.09, 0.014) };
            let relief = 0.034 + 0.001 * stroke as f32;
            parts.cloth.box_between(
                on(side, z - relief, y - half_y, o - half_o),
                on(side, z + relief, y + half_y, o + half_o),
            );
        }
    }
}

/// A counter with crates under a striped awning.
fn add_stall(parts: &mut Parts, random: &mut Random, crates: &mut Vec<(Vec3, Vec3)>, side: f32, house: usize) {
    let z = FIRST_Z_M - HOUSE_M * (house as f32 + 0.62) + 0.25 * side;
    const HALF_M: f32 = 1.05;
    let (near, far) = (0.5, 1.35);
    parts.wood.tint(shade(random.unit(), 0.3));
    parts.wood.box_between(on(side, z - HALF_M, 0.68, near), on(side, z + HALF_M, 0.74, far));
    for k in 0..9 {
        let at = z - HALF_M + 0.03 + (2.0 * HALF_M - 0.06) * k as f32 / 8.0;
        parts.wood.box_between(on(side, at - 0.1, 0.0, far - 0.05), on(side, at + 0.1, 0.69, far - 0.02));
    }
    for (s, out) in [(-1.0, near), (1.0, near), (-1.0, far + 0.1), (1.0, far + 0.1)] {
        let foot = on(side, z + s * (HALF_M + 0.04), -0.01, out);
        parts.wood.cylinder(foot, foot + Vec3::Y * if out > 1.0 { 1.86 } else { 2.3 }, 0.025, 10);
    }
    // Crates lean towards the customer: three by two on the counter, two in front of it.
    for row in 0..2 {
        for column in 0..3 {
            let corner_z = z - HALF_M + 0.06 + 0.68 * column as f32;
            let out = near + 0.04 + 0.42 * row as f32;
            add_tray(parts, random, crates, side, corner_z, out, 0.73 + 0.12 * (1 - row) as f32);
        }
    }
    for column in 0..2 {
        add_tray(parts, random, crates, side, z - 0.8 + 0.85 * column as f32, far + 0.08, 0.12);
    }
    // The awning: stripes that sag between ridge and edge, each its own cloth.
    const STRIPES: usize = 9;
    const POINTS: usize = 10;
    let colors = [
        Vec3::new(0.6, 0.07, 0.06),
        Vec3::new(0.08, 0.3, 0.42),
        Vec3::new(0.65, 0.42, 0.07),
        Vec3::new(0.1, 0.36, 0.16),
    ];
    let color = colors[(house + 2 * usize::from(side > 0.0)) % colors.len()];
    let (top, low) = (2.36, 1.82);
    let profile = |lift: f32| -> Vec<Vec2> {
        (0..POINTS)
            .map(|k| {
                let t = k as f32 / (POINTS - 1) as f32;
                Vec2::new(t * 1.5, low + (top - low) * t - 0.09 * (PI * t).sin() + lift)
            })
            .collect()
    };
    let (lower, upper) = (profile(0.0), profile(0.012));
    for stripe in 0..STRIPES {
        let width = 2.0 * (HALF_M + 0.12) / STRIPES as f32;
        let edge = z - HALF_M - 0.12 + width * stripe as f32;
        parts.cloth.tint(if stripe % 2 == 0 { color } else { Vec3::new(0.85, 0.8, 0.7) });
        // Strip space: x from the street to the wall, y up, z along the street, seen from either side.
        let toward_wall = Vec3::X * side;
        let frame = Mat3::from_cols(toward_wall, Vec3::Y, toward_wall.cross(Vec3::Y));
        let start = on(side, if side > 0.0 { edge } else { edge + width }, 0.0, 1.75);
        parts.cloth.strip_prism(Affine3A::from_mat3_translation(frame, start), &lower, &upper, width - 0.002);
    }
    // Things that hang from the awning's front: bottle gourds.
    let gourd = [
        (0.0, -0.3),
        (0.05, -0.29),
        (0.075, -0.22),
        (0.05, -0.14),
        (0.03, -0.1),
        (0.035, -0.06),
        (0.012, -0.02),
        (0.0, 0.0),
    ];
    for k in 0..8 {
        let at = z - HALF_M + 0.1 + (2.0 * HALF_M - 0.2) * k as f32 / 7.0;
        let hook = on(side, at, 1.8 - random.range(0.0, 0.12), far + 0.1);
        parts.fruit.tint(Vec3::new(0.7, 0.48, 0.12) * shade(random.unit(), 0.25));
        parts.fruit.lathe(hook, Vec3::Y, &gourd.map(Vec2::from), 14);
        parts.iron.tint(Vec3::ONE);
        parts.iron.cylinder(hook - Vec3::Y * 0.02, Vec3::new(hook.x, 1.9, hook.z), 0.005, 5);
    }
}

/// An open crate of five boards; remembers where its fruit lies.
fn add_tray(
    parts: &mut Parts,
    random: &mut Random,
    crates: &mut Vec<(Vec3, Vec3)>,
    side: f32,
    z: f32,
    out: f32,
    height: f32,
) {
    let (long, deep, tall) = (0.6, 0.4, 0.14);
    let (a, b) = (on(side, z, height, out), on(side, z + long, height, out + deep));
    let (low, high) = (a.min(b), a.max(b));
    parts.wood.tint(Vec3::new(1.5, 1.6, 1.7) * shade(random.unit(), 0.25));
    parts.wood.box_between(low, high.with_y(height + 0.05));
    const BOARD_M: f32 = 0.018;
    let top = height + tall;
    parts.wood.box_between(low.with_y(height + 0.002), Vec3::new(low.x + BOARD_M, top, high.z));
    parts.wood.box_between(Vec3::new(high.x - BOARD_M, height + 0.002, low.z), high.with_y(top));
    let inset = 0.003;
    parts.wood.box_between(
        Vec3::new(low.x + inset, height + 0.004, low.z + inset),
        Vec3::new(high.x - inset, top - inset, low.z + BOARD_M),
    );
    parts.wood.box_between(
        Vec3::new(low.x + inset, height + 0.004, high.z - BOARD_M),
        Vec3::new(high.x - inset, top - inset, high.z - inset),
    );
    let rim = Vec3::new(BOARD_M, 0.0, BOARD_M);
    let corner = low + rim;
    crates.push((corner, Vec3::new(high.x - low.x - 2.0 * rim.x, 0.09, high.z - low.z - 2.0 * rim.z)));
}

/// Wires, strings of lanterns and washing across the street.
fn add_overhead(parts: &mut Parts, random: &mut Random) {
    add_wires(parts, random);
    add_poles(parts, random);
    add_lanterns(parts, random);
    add_washing(parts, random);
}

/// A line between two points that hangs `sag_m` lower in its middle.
fn sagging(a: Vec3, b: Vec3, sag_m: f32, steps: usize) -> Vec<Vec3> {
    (0..=steps)
        .map(|k| {
            let t = k as f32 / steps as f32;
            a.lerp(b, t) - Vec3::Y * (4.0 * sag_m * t * (1.0 - t))
        })
        .collect()
}

/// Wires from house to house.
fn add_wires(parts: &mut Parts, random: &mut Random) {
    let length = HOUSE_M * HOUSES as f32;
    parts.iron.tint(Vec3::ONE);
    for _ in 0..44 {
        let z = FIRST_Z_M - 0.6 - random.unit() * (length - 1.2);
        let height = random.range(3.9, 5.0);
        let a = on(-1.0, z, height + random.around_zero(0.4), 0.02);
        let b = on(1.0, z + random.around_zero(1.2), height + random.around_zero(0.4), 0.02);
        parts.iron.tube(&sagging(a, b, random.range(0.1, 0.5), 16), 5, |_| 0.009);
    }
}

/// Two bundles of wires along the street from pole to pole.
fn add_poles(parts: &mut Parts, random: &mut Random) {
    for side in [-1.0f32, 1.0] {
        let pole = |k: usize| on(side, FIRST_Z_M - 1.0 - 6.4 * k as f32, 0.0, 0.55);
        for k in 0..4 {
            parts.wood.tint(Vec3::splat(0.6));
            parts.wood.frustum(pole(k) - Vec3::Y * 0.02, pole(k) + Vec3::Y * 5.6, 0.1, 0.07, 14);
            for y in [4.9, 5.3] {
                parts.wood.box_between(pole(k) + Vec3::new(-0.5, y, -0.04), pole(k) + Vec3::new(0.5, y + 0.09, 0.04));
            }
            for wire in 0..6 {
                let offset = Vec3::new(-0.44 + 0.176 * wire as f32, if wire % 2 == 0 { 5.0 } else { 5.4 }, 0.0);
                parts.paper.tint(Vec3::new(1.2, 6.0, 8.0));
                parts.paper.cylinder(pole(k) + offset - Vec3::Y * 0.02, pole(k) + offset + Vec3::Y * 0.1, 0.03, 10);
                if k > 0 {
                    parts.iron.tint(Vec3::ONE);
                    let lift = Vec3::Y * 0.09;
                    let points =
                        sagging(pole(k - 1) + offset + lift, pole(k) + offset + lift, random.range(0.2, 0.35), 20);
                    parts.iron.tube(&points, 5, |_| 0.01);
                }
            }
        }
    }
}

/// Strings of lanterns: ribbed paper between two caps.
fn add_lanterns(parts: &mut Parts, random: &mut Random) {
    const RIBS: usize = 12;
    let lantern: Vec<Vec2> = std::iter::once(Vec2::new(0.0, -0.17))
        .chain((0..=RIBS).map(|k| {
            let t = k as f32 / RIBS as f32;
            let bulge = 0.08 + 0.11 * (PI * t).sin().max(0.0).sqrt();
            Vec2::new(bulge - if k % 2 == 0 { 0.008 } else { 0.0 }, -0.17 + 0.34 * t)
        }))
        .chain(std::iter::once(Vec2::new(0.0, 0.17)))
        .collect();
    for string in 0..9 {
        let z = FIRST_Z_M - 1.3 - 2.2 * string as f32;
        let a = on(-1.0, z + random.around_zero(0.4), 3.7, 0.02);
        let b = on(1.0, z + random.around_zero(0.4), 3.8, 0.02);
        let points = sagging(a, b, 0.5, 18);
        parts.iron.tint(Vec3::ONE);
        parts.iron.tube(&points, 5, |_| 0.008);
        for k in 0..7 {
            let hook = points[3 + 2 * k];
            let center = hook - Vec3::Y * 0.24;
            parts.paper.tint(if (k + string) % 3 == 1 { Vec3::new(1.2, 4.2, 1.2) } else { shade(random.unit(), 0.2) });
            parts.paper.lathe(center, Vec3::Y, &lantern, 20);
            parts.wood.tint(Vec3::splat(0.3));
            parts.wood.cylinder(center + Vec3::Y * 0.16, center + Vec3::Y * 0.2, 0.07, 12);
            parts.wood.cylinder(center - Vec3::Y * 0.2, center - Vec3::Y * 0.16, 0.07, 12);
            parts.iron.cylinder(center + Vec3::Y * 0.19, hook, 0.004, 5);
            parts.paper.cylinder(center - Vec3::Y * 0.42, center - Vec3::Y * 0.19, 0.012, 6);
        }
    }
}

/// Lines of washing.
fn add_washing(parts: &mut Parts, random: &mut Random) {
    let colors = [Vec3::splat(0.9), Vec3::new(0.25, 0.4, 0.7), Vec3::new(0.75, 0.3, 0.25), Vec3::new(0.8, 0.7, 0.35)];
    for line in 0..5 {
        let z = FIRST_Z_M - 2.6 - 3.9 * line as f32;
        let points = sagging(on(-1.0, z, 4.7, 0.02), on(1.0, z - 0.3, 4.6, 0.02), 0.25, 24);
        parts.iron.tint(Vec3::splat(3.0));
        parts.iron.tube(&points, 5, |_| 0.006);
        for k in 0..5 {
            const POINTS: usize = 13;
            let top = points[4 + 4 * k];
            let (width, drop) = (random.range(0.4, 0.7), random.range(0.5, 0.95));
            let phase = random.range(0.0, TAU);
            let fold = |lift: f32| -> Vec<Vec2> {
                (0..POINTS)
                    .map(|i| {
                        let x = width * (i as f32 / (POINTS - 1) as f32 - 0.5);
                        Vec2::new(x, 0.03 * (16.0 * x + phase).sin() + lift)
                    })
                    .collect()
            };
            let down = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.25 * TAU), top + Vec3::Y * 0.01);
            parts.cloth.tint(colors[random.below(colors.len())]);
            parts.cloth.strip_prism(down, &fold(0.0), &fold(0.012), drop);
        }
    }
}

/// Parasols, pots, jars and stools on the ground.
fn add_clutter(parts: &mut Parts, random: &mut Random) {
    let jar = [
        (0.0, 0.0),
        (0.16, 0.0),
        (0.24, 0.15),
        (0.27, 0.32),
        (0.22, 0.5),
        (0.12, 0.58),
        (0.14, 0.64),
        (0.11, 0.64),
        (0.09, 0.58),
        (0.0, 0.58),
    ];
    for k in 0..14 {
        let side = if k % 2 == 0 { -1.0 } else { 1.0 };
        let z = FIRST_Z_M - 0.35 - 1.47 * k as f32;
        parts.fruit.tint(Vec3::new(0.3, 0.17, 0.1) * shade(random.unit(), 0.4));
        parts.fruit.lathe(on(side, z, 0.005, 0.36), Vec3::Y, &jar.map(Vec2::from), 24);
        add_pot(parts, random, on(-side, z + 0.3, 0.005, 0.32), 1.1);
    }
    // Parasols: thin shells on a pole, with ribs.
    for (k, (x, z)) in [(0.55f32, 0.9f32), (-0.5, -3.4), (0.4, -8.2)].into_iter().enumerate() {
        let foot = Vec3::new(x, 0.0, z);
        parts.wood.tint(Vec3::splat(0.8));
        parts.wood.cylinder(foot, foot + Vec3::Y * 2.75, 0.022, 12);
        parts.wood.frustum(foot, foot + Vec3::Y * 0.1, 0.26, 0.2, 20);
        let shell = [(0.0, 2.64), (0.5, 2.5), (1.0, 2.25), (1.0, 2.262), (0.5, 2.514), (0.0, 2.656)];
        parts.cloth.tint([Vec3::new(0.75, 0.25, 0.1), Vec3::new(0.2, 0.42, 0.45), Vec3::new(0.8, 0.6, 0.2)][k]);
        parts.cloth.lathe(foot, Vec3::Y, &shell.map(Vec2::from), 32);
        for rib in 0..8 {
            let (sin, cos) = (TAU * rib as f32 / 8.0).sin_cos();
            let outward = Vec3::new(cos, 0.0, sin);
            parts.wood.beam(
                foot + Vec3::Y * 2.0,
                foot + outward * 0.62 + Vec3::Y * 2.42,
                0.014,
                0.014,
                Vec3::new(0.1, 1.0, 0.1),
            );
        }
        // A round table and three stools in its shade.
        parts.wood.cylinder(foot + Vec3::Y * 0.7, foot + Vec3::Y * 0.74, 0.45, 32);
        for stool in 0..3 {
            let angle = 0.7 + TAU * stool as f32 / 3.0;
            let at = foot + Vec3::new(angle.cos(), 0.0, angle.sin()) * 0.72;
            parts.wood.tint(Vec3::new(1.5, 0.4, 0.3));
            parts.wood.cylinder(at + Vec3::Y * 0.42, at + Vec3::Y * 0.46, 0.17, 20);
            for leg in 0..4 {
                let (sin, cos) = (TAU * leg as f32 / 4.0 + 0.4).sin_cos();
                let spread = Vec3::new(cos, 0.0, sin);
                parts.wood.cylinder(at + spread * 0.17, at + spread * 0.12 + Vec3::Y * 0.43, 0.014, 8);
            }
        }
    }
}
