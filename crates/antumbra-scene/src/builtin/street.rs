//! `street`: a market street of many layers: tiled roofs, awnings, wires, lanterns, balconies, stalls.
//!
//! After the *Streets of Asia* scene of 400 000 triangles of Selgrad, Dachsbacher, Meyer & Stamminger 2014, fig. 16:
//! "a more game-like scene", whose depth complexity seen from the light is high.
//!
//! The street runs along z. A place on a row of houses is given by its side (−1 left, +1 right), its z, its height and
//! its distance from the facades towards the street's middle.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::Arguments;
use super::noise::Random;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

mod houses;
mod overhead;
mod stalls;

use houses::{add_house, add_pot};
use overhead::add_overhead;
use stalls::{add_fruit, add_stall};

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
    let triangles = TRIANGLES - stage.triangle_count() - fruit.triangle_count();
    add_fruit(&mut fruit, &mut random, &crates, triangles);
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
