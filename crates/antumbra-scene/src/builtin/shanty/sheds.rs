//! Sheds of the shanty town.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Parts;
use crate::builtin::noise::Random;
use crate::builtin::shapes::MeshBuilder;
use crate::builtin::stage::shade;

/// A rectangular shed: the middle of its floor, size (width, height at the eaves, depth) and turn about +y.
pub(super) struct Shed {
    pub(super) floor: Vec3,
    pub(super) size_m: Vec3,
    pub(super) turn_rad: f32,
    /// Rise of the roof from its back to its front, metres.
    pub(super) roof_rise_m: f32,
}

impl Shed {
    fn turn(&self) -> Quat {
        Quat::from_rotation_y(self.turn_rad)
    }

    /// World position of a place in the shed, from the middle of its floor.
    fn at(&self, x: f32, y: f32, z: f32) -> Vec3 {
        self.floor + self.turn() * Vec3::new(x, y, z)
    }

    /// Half of width and depth, metres.
    fn half_m(&self) -> (f32, f32) {
        (0.5 * self.size_m.x, 0.5 * self.size_m.z)
    }

    /// Height of the roof above the floor, metres.
    fn eaves(&self, z: f32) -> f32 {
        let (_, half_z) = self.half_m();
        self.size_m.y + self.roof_rise_m * (z + half_z) / (2.0 * half_z)
    }
}

/// Walls of upright planks with gaps, a door, and a lean-to roof of corrugated sheets on rafters.
pub(super) fn add_shed(parts: &mut Parts, random: &mut Random, shed: &Shed) {
    add_walls(parts, random, shed);
    add_roof(parts, random, shed);
}

/// Walls of upright planks on two boards each; the first has a door.
fn add_walls(parts: &mut Parts, random: &mut Random, shed: &Shed) {
    const PLANK_M: f32 = 0.14;
    let (half_x, half_z) = shed.half_m();
    for wall in 0..4 {
        let along_x = wall % 2 == 0;
        let side = if wall < 2 { 1.0 } else { -1.0 };
        let half = if along_x { half_x } else { half_z };
        let count = (2.0 * half / PLANK_M) as i32;
        for i in 0..count {
            let s = -half + (i as f32 + 0.5) * 2.0 * half / count as f32;
            let is_door = wall == 0 && (s + 0.1).abs() < 0.36;
            if is_door || random.unit() < 0.06 {
                continue;
            }
            let (x, z) = if along_x { (s, side * half_z) } else { (side * half_x, s) };
            let foot = shed.at(x, -random.range(0.005, 0.02), z);
            let head = shed.at(
                x + random.around_zero(0.025),
                shed.eaves(z) - random.range(0.0, 0.14),
                z + random.around_zero(0.025),
            );
            parts.planks.tint(shade(random.unit(), 0.4));
            let thickness = shed.turn() * if along_x { Vec3::Z } else { Vec3::X };
            parts.planks.beam(foot, head, PLANK_M * random.range(0.8, 0.98), 0.025, thickness);
        }
        for y in [0.35, 0.8 * shed.size_m.y] {
            let inset = 0.03;
            let [a, b] = [-1.0, 1.0].map(|end| {
                let (x, z) = if along_x {
                    (end * half_x * 0.98, side * (half_z - inset))
                } else {
                    (side * (half_x - inset), end * half_z * 0.98)
                };
                shed.at(x, y + 0.01 * wall as f32, z)
            });
            parts.planks.tint(shade(0.3, 0.3));
            parts.planks.beam(a, b, 0.04, 0.08, Vec3::Y);
        }
    }
}

/// Rafters, then sheets that overlap: waves run down the slope.
fn add_roof(parts: &mut Parts, random: &mut Random, shed: &Shed) {
    let (half_x, half_z) = shed.half_m();
    let overhang = 0.18;
    for i in 0..4 {
        let x = -half_x + 0.05 + (2.0 * half_x - 0.1) * i as f32 / 3.0;
        parts.planks.tint(shade(random.unit(), 0.3));
        parts.planks.beam(
            shed.at(x, shed.eaves(-half_z - overhang) + 0.02, -half_z - overhang),
            shed.at(x, shed.eaves(half_z + overhang) + 0.02, half_z + overhang),
            0.05,
            0.07,
            Vec3::Y,
        );
    }
    let sheets = 3;
    let sheet_width = (2.0 * half_x + 2.0 * overhang) / sheets as f32 + 0.12;
    let slope = (shed.roof_rise_m / (2.0 * half_z)).atan();
    for sheet in 0..sheets {
        let x = -half_x - overhang + (2.0 * half_x + 2.0 * overhang - sheet_width) * sheet as f32 / (sheets - 1) as f32;
        let slide = random.around_zero(0.08);
        let lift = 0.075 + 0.022 * (sheet % 2) as f32 + 0.004 * sheet as f32;
        let start = shed.at(x, shed.eaves(-half_z - overhang) + lift, -half_z - overhang + slide);
        let length = (2.0 * half_z + 2.0 * overhang) / slope.cos() * random.range(0.94, 1.05);
        // Sheet space: x across the waves, y up, z down the length.
        let part = Affine3A::from_rotation_translation(
            shed.turn() * Quat::from_rotation_y(random.around_zero(0.03)) * Quat::from_rotation_x(-slope),
            start,
        );
        parts.iron.tint(shade(random.unit(), 0.35));
        add_corrugated(&mut parts.iron, part, sheet_width, length);
    }
}

/// A sheet of waves of 9 cm, 2.2 cm high and 8 mm thick.
fn add_corrugated(mesh: &mut MeshBuilder, part: Affine3A, width_m: f32, length_m: f32) {
    const WAVE_M: f32 = 0.09;
    const POINTS_PER_WAVE: f32 = 6.0;
    const AMPLITUDE_M: f32 = 0.011;
    const THICKNESS_M: f32 = 0.008;
    let points = (width_m / WAVE_M * POINTS_PER_WAVE).round() as usize + 1;
    let wave = |k: usize| {
        let x = width_m * k as f32 / (points - 1) as f32;
        Vec2::new(x, AMPLITUDE_M * (TAU * x / WAVE_M + 0.4).sin())
    };
    let lower: Vec<Vec2> = (0..points).map(wave).collect();
    let upper: Vec<Vec2> = lower.iter().map(|p| *p + Vec2::Y * THICKNESS_M).collect();
    mesh.strip_prism(part, &lower, &upper, length_m);
}
