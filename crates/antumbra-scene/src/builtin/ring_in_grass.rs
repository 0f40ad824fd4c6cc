//! `ring-in-grass`: a ring stands in a lawn of separate blades.
//!
//! After the ring scene of 379 000 triangles in Sintorn, Eisemann & Assarsson 2008, fig. 15 right, originally from Laine,
//! Aila, Assarsson, Lehtinen & Akenine-Möller, *Soft Shadow Volumes for Ray Tracing*, SIGGRAPH 2005.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Arguments;
use super::noise::{Random, value_noise};
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

/// Sides of the lawn, metres.
const LAWN_M: Vec2 = Vec2::new(5.6, 4.6);

pub(super) fn ring_in_grass(arguments: &Arguments) -> Scene {
    const TRIANGLES: usize = 379_000;
    const TRIANGLES_PER_BLADE: usize = 5;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::ZERO, LAWN_M, palette::BARK * 1.4);

    let gold = stage.metal("ring", Vec3::new(0.80, 0.52, 0.17), 0.3);
    stage.add("ring", gold, ring());

    let grass = stage.push_material(crate::Material {
        name: "grass".into(),
        base_color: palette::GRASS.extend(1.0),
        roughness: 0.7,
        double_sided: true,
        ..crate::Material::default()
    });
    let count = (TRIANGLES - stage.triangle_count()) / TRIANGLES_PER_BLADE;
    stage.add("grass", grass, lawn(count));

    stage.camera(Vec3::new(1.5, 2.5, 4.2), Vec3::new(0.15, 0.68, 0.1), 38.0);
    stage.light(
        antumbra_light::LightShape::Sphere { radius_m: 0.35 },
        Vec3::new(-2.2, 4.9, -1.4),
        Vec3::new(0.1, 0.3, 0.2),
    );
    stage.scene
}

/// A band with a rounded section and a cord of knots along its middle, about +z.
fn ring() -> MeshBuilder {
    const RING_RADIUS_M: f32 = 0.95;
    const COLUMNS: u32 = 192;
    const ROWS: u32 = 48;
    let mut ring = MeshBuilder::new();
    ring.place(Affine3A::from_rotation_translation(
        Quat::from_rotation_y(0.55) * Quat::from_rotation_x(-0.16),
        Vec3::new(-0.15, 0.94, -0.1),
    ));
    ring.torus_grid(COLUMNS, ROWS, |i, j| {
        let around = TAU * i as f32 / COLUMNS as f32;
        let girth = TAU * j as f32 / ROWS as f32;
        let cord = 0.018 * (0.5 + 0.5 * (24.0 * around).cos()) * girth.cos().max(0.0).powi(4);
        let (section_r, section_z) = ((0.1 + cord) * girth.cos(), 0.2 * girth.sin());
        let (sin, cos) = around.sin_cos();
        let radius = RING_RADIUS_M + section_r;
        Vec3::new(radius * cos, radius * sin, section_z)
    });
    ring
}

/// Blades of grass. A blade is three pairs of points and a tip: five triangles.
fn lawn(count: usize) -> MeshBuilder {
    let mut blades = MeshBuilder::new();
    let mut random = Random::new(379);
    for _ in 0..count {
        let half = 0.5 * LAWN_M - 0.06;
        let base = Vec3::new(random.around_zero(half.x), -0.01, random.around_zero(half.y));
        // Tufts: noise makes blades long and light, or short and dark, together.
        let tuft = value_noise(base * 3.5 + Vec3::Y * 0.5);
        let height = (0.17 + 0.06 * tuft) * random.range(0.65, 1.25);
        let azimuth = random.range(0.0, TAU);
        let lean_direction = Vec3::new(azimuth.cos(), 0.0, azimuth.sin());
        let wind = Vec3::new(0.35, 0.0, 0.15) * (0.6 + 0.4 * tuft);
        let bend = (lean_direction * random.range(0.1, 0.6) + wind) * height;
        let across = lean_direction.cross(Vec3::Y) * random.range(0.003, 0.0055);
        let at = |t: f32| base + Vec3::Y * (height * (t - 0.18 * t * t)) + bend * (t * t);
        let pairs =
            [(0.0, 1.0), (0.4, 0.85), (0.75, 0.5)].map(|(t, width)| [at(t) - across * width, at(t) + across * width]);
        let normal = across.cross(at(1.0) - base).normalize();
        let dry = random.unit().powi(3);
        let hue = Vec3::new(1.0 + 0.9 * dry, 1.0 + 0.15 * dry, 1.0);
        blades.tint(shade(random.unit(), 0.3) * (1.0 + 0.25 * tuft) * hue);
        blades.blade_sheet(&pairs, at(1.0), normal);
    }
    blades
}
