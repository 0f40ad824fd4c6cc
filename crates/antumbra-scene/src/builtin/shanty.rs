//! `shanty`: sheds of planks and corrugated iron, pipes, barrels, a water tank.
//!
//! After the shanty town of 23 500 triangles of Marrs, Watson & Healey 2014, fig. 6 middle: many thin overlapping
//! occluders at many heights.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Arguments;
use super::noise::Random;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

mod sheds;

use sheds::{Shed, add_shed};

/// Mesh builders, one per material.
#[derive(Default)]
struct Parts {
    planks: MeshBuilder,
    iron: MeshBuilder,
    pipes: MeshBuilder,
    barrels: MeshBuilder,
    cloth: MeshBuilder,
}

pub(super) fn shanty(arguments: &Arguments) -> Scene {
    const TRIANGLES: usize = 23_500;
    const TRIANGLES_PER_PLANK: usize = 12;
    let mut random = Random::new(235);
    let mut parts = Parts::default();
    let sheds = [
        Shed { floor: Vec3::new(-1.9, 0.0, -1.5), size_m: Vec3::new(2.2, 1.9, 1.8), turn_rad: 0.12, roof_rise_m: 0.45 },
        Shed { floor: Vec3::new(1.7, 0.0, -1.7), size_m: Vec3::new(2.1, 2.3, 1.7), turn_rad: -0.1, roof_rise_m: 0.3 },
        Shed { floor: Vec3::new(-2.9, 0.0, 1.2), size_m: Vec3::new(1.3, 1.5, 1.4), turn_rad: 0.35, roof_rise_m: 0.25 },
    ];
    for shed in &sheds {
        add_shed(&mut parts, &mut random, shed);
    }
    add_tank(&mut parts, Vec3::new(2.75, 0.0, 0.75));
    add_pipes(&mut parts);
    for (i, (x, z)) in
        [(0.2, -1.9), (0.65, -1.5), (-0.35, -1.1), (2.0, 1.9), (-1.75, 1.95), (-1.3, 1.55)].into_iter().enumerate()
    {
        add_barrel(&mut parts, Vec3::new(x, -0.005, z), i);
    }
    add_washing(&mut parts, &mut random);
    add_bridge(&mut parts, &mut random);
    add_awning(&mut parts, &mut random);
    add_fence(&mut parts, &mut random);
    add_ladder(&mut parts);
    for (x, y, z, turn, size) in
        [(0.95f32, 0.0f32, 0.95f32, 0.4f32, 0.5f32), (1.05, 0.497, 0.9, 0.9, 0.38), (1.6, 0.0, 1.15, -0.2, 0.42)]
    {
        add_crate(&mut parts, &mut random, Vec3::new(x, y, z), turn, size);
    }

    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.0, 0.3), Vec2::new(9.0, 7.5), Vec3::new(0.42, 0.32, 0.22));
    let wood = stage.material("planks", Vec3::new(0.34, 0.24, 0.16), 0.85);
    let iron = stage.material("corrugated iron", palette::RUST * 1.25, 0.6);
    let pipe = stage.material("pipes", Vec3::new(0.16, 0.26, 0.27), 0.5);
    let drum = stage.material("barrels", Vec3::new(0.12, 0.24, 0.40), 0.5);
    let linen = stage.material("washing", Vec3::new(0.62, 0.55, 0.45), 0.95);
    stage.add("corrugated iron", iron, parts.iron);
    stage.add("pipes", pipe, parts.pipes);
    stage.add("barrels", drum, parts.barrels);
    stage.add("washing", linen, parts.cloth);
    // Loose planks use up the remaining triangles.
    let loose = (TRIANGLES - stage.triangle_count() - parts.planks.triangle_count()) / TRIANGLES_PER_PLANK;
    add_loose_planks(&mut parts.planks, &mut random, loose);
    stage.add("planks", wood, parts.planks);

    stage.camera(Vec3::new(1.5, 4.3, 6.3), Vec3::new(0.05, 0.75, -0.05), 40.0);
    stage.square_light(0.5, Vec3::new(-3.0, 6.1, 0.5), Vec3::new(0.1, 0.3, 0.2));
    stage.scene
}

/// Planks across the alley, from roof to roof.
fn add_bridge(parts: &mut Parts, random: &mut Random) {
    for i in 0..9 {
        let z = -2.2 + 0.21 * i as f32;
        if i % 4 != 2 {
            let lift = random.range(0.0, 0.05);
            let start = Vec3::new(-1.0 + random.around_zero(0.15), 2.34 + lift, z + random.around_zero(0.06));
            let end = Vec3::new(0.9 + random.around_zero(0.2), 2.48 + lift, z + random.around_zero(0.1));
            parts.planks.tint(shade(random.unit(), 0.35));
            parts.planks.beam(start, end, random.range(0.1, 0.17), 0.03, Vec3::Y);
        }
    }
}

/// A slatted awning over the yard, from the small shed to a trestle.
fn add_awning(parts: &mut Parts, random: &mut Random) {
    for x in [-0.55, 1.15] {
        parts.planks.beam(Vec3::new(x, -0.01, 1.98), Vec3::new(x - 0.04, 2.2, 1.95), 0.07, 0.07, Vec3::Z);
        parts.planks.beam(Vec3::new(x, 2.16, 2.15), Vec3::new(x - 0.02, 2.3, -0.75), 0.05, 0.08, Vec3::Y);
    }
    for i in 0..8 {
        let z = 0.25 + 0.25 * i as f32 + random.around_zero(0.03);
        let y = 2.31 - 0.05 * (z + 0.75);
        parts.planks.tint(shade(random.unit(), 0.35));
        parts.planks.beam(
            Vec3::new(-0.8 + random.around_zero(0.12), y, z + random.around_zero(0.03)),
            Vec3::new(1.4 + random.around_zero(0.12), y, z + random.around_zero(0.03)),
            0.11,
            0.025,
            Vec3::Y,
        );
    }
}

/// A fence along the right, with gaps.
fn add_fence(parts: &mut Parts, random: &mut Random) {
    for i in 0..22 {
        let base = Vec3::new(3.55 + random.around_zero(0.03), -0.02, -0.6 + 0.17 * i as f32);
        let top = base + Vec3::new(random.around_zero(0.08), random.range(0.85, 1.2), random.around_zero(0.05));
        parts.planks.tint(shade(random.unit(), 0.35));
        if i % 7 != 4 {
            parts.planks.beam(base, top, 0.025, 0.13, Vec3::Z);
        }
    }
    for y in [0.3, 0.75] {
        parts.planks.beam(Vec3::new(3.59, y, -0.8), Vec3::new(3.61, y + 0.03, 3.3), 0.03, 0.08, Vec3::Y);
    }
}

/// A ladder against the right-hand shed.
fn add_ladder(parts: &mut Parts) {
    let (foot, head) = (Vec3::new(1.15, -0.01, 0.1), Vec3::new(1.1, 2.6, -0.72));
    let side = Vec3::X * 0.2;
    for s in [-1.0, 1.0] {
        parts.planks.beam(foot + side * s, head + side * s, 0.035, 0.06, Vec3::Z);
    }
    for k in 1..9 {
        let rung = foot.lerp(head, k as f32 / 9.0);
        parts.planks.beam(rung - side * 1.1, rung + side * 1.1, 0.028, 0.03, Vec3::Z);
    }
}

/// Loose planks: in piles, as litter, and leaning.
fn add_loose_planks(planks: &mut MeshBuilder, random: &mut Random, count: usize) {
    for i in 0..count {
        planks.tint(shade(random.unit(), 0.4));
        let length = random.range(0.5, 1.3);
        let turn = random.range(0.0, TAU);
        let along = Vec3::new(turn.cos(), 0.0, turn.sin());
        let (start, end) = match i % 8 {
            // Two piles by the left-hand shed.
            0..4 => {
                let layer = (i / 16) as f32;
                let jitter = Vec3::new(random.around_zero(0.35), 0.0, random.around_zero(0.08));
                let middle_z = if i % 2 == 0 { 0.35 } else { 1.05 };
                let lane = 0.14 * ((i / 2 % 4) as f32 - 1.5);
                let pile = Vec3::new(-0.75, 0.02 + 0.03 * layer, middle_z + lane) + jitter * 0.5;
                let direction = Vec3::new(1.0, 0.0, 0.12 * random.around_zero(1.0)).normalize();
                (pile - direction * 0.6, pile + direction * 0.6)
            }
            // Litter.
            4 => {
                let middle = Vec3::new(random.around_zero(3.3), random.range(0.015, 0.03), random.range(-0.4, 3.4));
                (middle - along * (0.4 * length), middle + along * (0.4 * length) + Vec3::Y * random.range(0.0, 0.08))
            }
            // Leaning against the sheds and the fence.
            _ => {
                let (foot, against) = [
                    (Vec3::new(-1.9, 0.0, -0.15), Vec3::new(0.05, 1.0, -0.42)),
                    (Vec3::new(2.0, 0.0, -0.35), Vec3::new(-0.05, 1.1, -0.4)),
                    (Vec3::new(3.2, 0.0, 1.6), Vec3::new(0.33, 0.9, 0.0)),
                ][random.below(3)];
                let slide = if against.x > 0.2 { Vec3::Z } else { Vec3::X } * random.around_zero(0.9);
                (foot + slide - Vec3::Y * 0.02, foot + slide + against * random.range(0.9, 1.4))
            }
        };
        planks.beam(start, end, random.range(0.07, 0.14), 0.028, Vec3::new(0.05, 1.0, 0.1));
    }
}

/// A round tank on four braced legs.
fn add_tank(parts: &mut Parts, foot: Vec3) {
    const DECK_M: f32 = 1.75;
    let corner = |i: usize, y: f32, half: f32| {
        let (x, z) = [(-half, -half), (half, -half), (half, half), (-half, half)][i % 4];
        foot + Vec3::new(x, y, z)
    };
    for i in 0..4 {
        parts.planks.tint(shade(i as f32 / 4.0, 0.2));
        parts.planks.beam(corner(i, -0.01, 0.46), corner(i, DECK_M, 0.38), 0.07, 0.07, Vec3::Z);
        for (low, high) in [(0.25, 0.85), (0.95, 1.6)] {
            parts.planks.beam(corner(i, low, 0.44), corner(i + 1, high, 0.4), 0.03, 0.06, Vec3::Y);
            parts.planks.beam(corner(i, high, 0.4), corner(i + 1, low, 0.44), 0.03, 0.058, Vec3::Y);
        }
    }
    for k in 0..7 {
        let x = -0.48 + 0.16 * k as f32;
        let z = Vec3::Z * 0.55;
        let middle = foot + Vec3::new(x, DECK_M, 0.0);
        parts.planks.tint(shade(k as f32 * 0.31 % 1.0, 0.3));
        parts.planks.beam(middle - z, middle + z, 0.14, 0.04, Vec3::Y);
    }
    let profile = [
        (0.0, 0.0),
        (0.44, 0.0),
        (0.44, 0.2),
        (0.46, 0.22),
        (0.44, 0.24),
        (0.44, 0.5),
        (0.46, 0.52),
        (0.44, 0.54),
        (0.44, 0.8),
        (0.4, 0.84),
        (0.08, 0.98),
        (0.08, 1.03),
        (0.0, 1.03),
    ];
    parts.iron.tint(shade(0.6, 0.3));
    parts.iron.lathe(foot + Vec3::Y * (DECK_M + 0.015), Vec3::Y, &profile.map(Vec2::from), 28);
}

/// Pipes that run down from the tank, over the alley and along the sheds, with bends and flanges.
fn add_pipes(parts: &mut Parts) {
    let runs: [(f32, &[Vec3]); 6] = [
        (
            0.045,
            &[
                Vec3::new(2.6, 1.8, 0.3),
                Vec3::new(2.6, 2.95, -0.4),
                Vec3::new(0.9, 2.98, -0.6),
                Vec3::new(-1.6, 2.75, -0.7),
                Vec3::new(-2.9, 2.7, -0.9),
            ],
        ),
        (
            0.055,
            &[
                Vec3::new(-2.9, 2.7, -0.9),
                Vec3::new(-3.25, 2.6, -0.7),
                Vec3::new(-3.25, 1.0, -0.55),
                Vec3::new(-3.25, -0.05, -0.5),
            ],
        ),
        (
            0.04,
            &[
                Vec3::new(2.75, 1.85, 1.1),
                Vec3::new(2.75, 1.5, 1.35),
                Vec3::new(2.75, 0.3, 1.4),
                Vec3::new(2.3, 0.12, 1.5),
                Vec3::new(0.4, 0.1, 1.75),
                Vec3::new(-2.0, 0.09, 2.4),
            ],
        ),
        (0.06, &[Vec3::new(0.45, -0.05, -0.85), Vec3::new(0.45, 1.9, -0.85), Vec3::new(0.45, 3.3, -0.9)]),
        (0.035, &[Vec3::new(-2.4, 1.85, 1.0), Vec3::new(-2.4, 2.5, 0.9), Vec3::new(-2.2, 3.1, 0.85)]),
        (
            0.03,
            &[
                Vec3::new(3.4, 1.35, 3.2),
                Vec3::new(3.4, 1.4, 0.5),
                Vec3::new(3.0, 2.0, -0.6),
                Vec3::new(2.7, 2.75, -0.95),
            ],
        ),
    ];
    for (i, (radius, corners)) in runs.into_iter().enumerate() {
        let points = rounded(corners);
        parts.pipes.tint(shade(i as f32 * 0.43 % 1.0, 0.3));
        parts.pipes.tube(&points, 16, |_| radius);
        for corner in 1..points.len() / 6 {
            let k = corner * 6;
            let along = (points[k] - points[k - 1]).normalize() * 0.02;
            parts.pipes.cylinder(points[k] - along, points[k] + along, radius * 1.5, 12);
        }
    }
    // A cowl on the chimney.
    parts.pipes.cone(Vec3::new(0.45, 3.36, -0.9), Vec3::new(0.45, 3.52, -0.9), 0.16, 16);
    parts.pipes.cylinder(Vec3::new(0.45, 3.28, -0.9), Vec3::new(0.45, 3.37, -0.9), 0.02, 8);
}

/// A polyline with its corners rounded by quadratic Bézier curves.
fn rounded(corners: &[Vec3]) -> Vec<Vec3> {
    const STEPS: usize = 5;
    const REACH_M: f32 = 0.22;
    let mut points = vec![corners[0]];
    for triple in corners.windows(3) {
        let [a, b, c] = [triple[0], triple[1], triple[2]];
        let start = b + (a - b).normalize() * REACH_M.min(0.4 * a.distance(b));
        let end = b + (c - b).normalize() * REACH_M.min(0.4 * c.distance(b));
        for k in 0..=STEPS {
            let t = k as f32 / STEPS as f32;
            points.push(start.lerp(b, t).lerp(b.lerp(end, t), t));
        }
    }
    points.push(*corners.last().expect("a pipe has ends"));
    points
}

/// An oil drum with two rolled hoops, upright or on its side.
fn add_barrel(parts: &mut Parts, base: Vec3, index: usize) {
    let profile = [
        (0.0, 0.02),
        (0.26, 0.02),
        (0.27, 0.0),
        (0.285, 0.01),
        (0.28, 0.04),
        (0.28, 0.27),
        (0.295, 0.29),
        (0.28, 0.31),
        (0.28, 0.56),
        (0.295, 0.58),
        (0.28, 0.6),
        (0.28, 0.84),
        (0.285, 0.87),
        (0.27, 0.88),
        (0.26, 0.86),
        (0.0, 0.86),
    ];
    let colors = [Vec3::ONE, Vec3::new(3.2, 0.5, 0.25), Vec3::new(1.2, 1.2, 0.5)];
    parts.barrels.tint(colors[index % 3]);
    let (origin, axis) = if index % 3 == 2 {
        let turn = 0.8 * index as f32;
        (base + Vec3::Y * 0.295, Vec3::new(turn.cos(), 0.0, turn.sin()))
    } else {
        (base, Vec3::Y)
    };
    parts.barrels.lathe(origin, axis, &profile.map(Vec2::from), 32);
}

/// A crate of slats about an inner box.
fn add_crate(parts: &mut Parts, random: &mut Random, base: Vec3, turn_rad: f32, size_m: f32) {
    let turn = Quat::from_rotation_y(turn_rad);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| turn * axis);
    let center = base + Vec3::Y * (0.5 * size_m + 0.01);
    parts.planks.tint(shade(0.2, 0.3));
    parts.planks.oriented_box(center, axes, Vec3::splat(0.46 * size_m));
    for side in 0..4 {
        let face = Quat::from_rotation_y(turn_rad + 0.25 * TAU * side as f32);
        for k in 0..4 {
            parts.planks.tint(shade(random.unit(), 0.35));
            let y = (k as f32 - 1.5) * 0.25 * size_m;
            let half = Vec3::new(0.5 * size_m, 0.105 * size_m, 0.012);
            let middle = center + face * Vec3::new(0.0, y, 0.48 * size_m);
            parts.planks.oriented_box(middle, [face * Vec3::X, Vec3::Y, face * Vec3::Z], half);
        }
    }
}

/// A line between the sheds with cloths that hang in waves.
fn add_washing(parts: &mut Parts, random: &mut Random) {
    let (a, b) = (Vec3::new(-2.3, 1.85, 0.7), Vec3::new(2.35, 1.95, 0.75));
    let on_line = |t: f32| a.lerp(b, t) - Vec3::Y * (0.5 * t * (1.0 - t));
    let line: Vec<Vec3> = (0..=20).map(|k| on_line(k as f32 / 20.0)).collect();
    parts.cloth.tint(Vec3::splat(0.5));
    parts.cloth.tube(&line, 6, |_| 0.01);
    let colors = [Vec3::ONE, Vec3::new(0.9, 0.3, 0.25), Vec3::new(0.35, 0.6, 0.95), Vec3::new(1.1, 0.9, 0.4)];
    for (i, t) in [0.2f32, 0.36, 0.55, 0.72].into_iter().enumerate() {
        const POINTS: usize = 13;
        let width = random.range(0.4, 0.6);
        let drop = random.range(0.45, 0.75);
        let top = on_line(t);
        let fold = |k: usize, lift: f32| {
            let x = width * (k as f32 / (POINTS - 1) as f32 - 0.5);
            Vec2::new(x, 0.03 * (14.0 * x + i as f32).sin() + lift)
        };
        let lower: Vec<Vec2> = (0..POINTS).map(|k| fold(k, 0.0)).collect();
        let upper: Vec<Vec2> = (0..POINTS).map(|k| fold(k, 0.012)).collect();
        // Strip space: x along the line, y across it, z down.
        let down = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.25 * TAU), top + Vec3::Y * 0.015);
        parts.cloth.tint(colors[i]);
        parts.cloth.strip_prism(down, &lower, &upper, drop);
    }
}
