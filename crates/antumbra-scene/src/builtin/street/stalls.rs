//! Stalls of the market, and their fruit.

use std::f32::consts::PI;

use glam::{Affine3A, Mat3, Vec2, Vec3};

use super::{FIRST_Z_M, HOUSE_M, Parts, on};
use crate::builtin::noise::Random;
use crate::builtin::shapes::MeshBuilder;
use crate::builtin::stage::shade;

/// Half the length of a stall along the street, metres.
const HALF_M: f32 = 1.05;
/// Distances of a counter's edges from the facades, metres.
const NEAR_M: f32 = 0.5;
const FAR_M: f32 = 1.35;

/// A counter with crates under a striped awning.
pub(super) fn add_stall(
    parts: &mut Parts,
    random: &mut Random,
    crates: &mut Vec<(Vec3, Vec3)>,
    side: f32,
    house: usize,
) {
    let z = FIRST_Z_M - HOUSE_M * (house as f32 + 0.62) + 0.25 * side;
    add_counter(parts, random, side, z);
    // Crates lean towards the customer: three by two on the counter, two in front of it.
    for row in 0..2 {
        for column in 0..3 {
            let corner_z = z - HALF_M + 0.06 + 0.68 * column as f32;
            let out = NEAR_M + 0.04 + 0.42 * row as f32;
            add_tray(parts, random, crates, side, corner_z, out, 0.73 + 0.12 * (1 - row) as f32);
        }
    }
    for column in 0..2 {
        add_tray(parts, random, crates, side, z - 0.8 + 0.85 * column as f32, FAR_M + 0.08, 0.12);
    }
    let colors = [
        Vec3::new(0.6, 0.07, 0.06),
        Vec3::new(0.08, 0.3, 0.42),
        Vec3::new(0.65, 0.42, 0.07),
        Vec3::new(0.1, 0.36, 0.16),
    ];
    add_awning(parts, side, z, colors[(house + 2 * usize::from(side > 0.0)) % colors.len()]);
    add_gourds(parts, random, side, z);
}

/// A counter of boards, and the posts of its awning.
fn add_counter(parts: &mut Parts, random: &mut Random, side: f32, z: f32) {
    parts.wood.tint(shade(random.unit(), 0.3));
    parts.wood.box_between(on(side, z - HALF_M, 0.68, NEAR_M), on(side, z + HALF_M, 0.74, FAR_M));
    for k in 0..9 {
        let at = z - HALF_M + 0.03 + (2.0 * HALF_M - 0.06) * k as f32 / 8.0;
        parts.wood.box_between(on(side, at - 0.1, 0.0, FAR_M - 0.05), on(side, at + 0.1, 0.69, FAR_M - 0.02));
    }
    for (s, out) in [(-1.0, NEAR_M), (1.0, NEAR_M), (-1.0, FAR_M + 0.1), (1.0, FAR_M + 0.1)] {
        let foot = on(side, z + s * (HALF_M + 0.04), -0.01, out);
        parts.wood.cylinder(foot, foot + Vec3::Y * if out > 1.0 { 1.86 } else { 2.3 }, 0.025, 10);
    }
}

/// An awning: stripes that sag between ridge and edge, each its own cloth.
fn add_awning(parts: &mut Parts, side: f32, z: f32, color: Vec3) {
    const STRIPES: usize = 9;
    const POINTS: usize = 10;
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
}

/// Bottle gourds that hang from an awning's front.
fn add_gourds(parts: &mut Parts, random: &mut Random, side: f32, z: f32) {
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
        let hook = on(side, at, 1.8 - random.range(0.0, 0.12), FAR_M + 0.1);
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

/// Fruit in the crates, of at most `triangles` triangles.
pub(super) fn add_fruit(fruit: &mut MeshBuilder, random: &mut Random, crates: &[(Vec3, Vec3)], triangles: usize) {
    const SEGMENTS: u32 = 14;
    const RINGS: u32 = 9;
    let triangles_each = (2 * SEGMENTS * (RINGS - 1)) as usize;
    let pieces = triangles / triangles_each;
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
}
