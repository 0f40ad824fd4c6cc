//! What hangs across the street.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::{FIRST_Z_M, HOUSE_M, HOUSES, Parts, on};
use crate::builtin::noise::Random;
use crate::builtin::stage::shade;

/// Wires, strings of lanterns and washing across the street.
pub(super) fn add_overhead(parts: &mut Parts, random: &mut Random) {
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
