//! Houses of the street.

use std::f32::consts::PI;

use glam::{Affine3A, Mat3, Quat, Vec2, Vec3};

use super::{FIRST_Z_M, HOUSE_M, Parts, on};
use crate::builtin::noise::Random;
use crate::builtin::shapes::MeshBuilder;
use crate::builtin::stage::{palette, shade};

/// A house with its shop, windows, roof and signs.
pub(super) fn add_house(parts: &mut Parts, random: &mut Random, side: f32, house: usize) {
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
pub(super) fn add_pot(parts: &mut Parts, random: &mut Random, base: Vec3, scale: f32) {
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
