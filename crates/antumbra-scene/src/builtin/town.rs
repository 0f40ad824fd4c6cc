//! `town`: more than a kilometre of houses, trees and poles under a low sun, seen from a street.

use std::f32::consts::FRAC_PI_4;

use antumbra_light::{LightShape, hash_u32, unit_f32};
use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette};
use crate::Scene;

/// Distance between streets, metres, and number of rows of houses on either side of the middle.
const BLOCK_M: f32 = 46.0;
const ROWS: i32 = 14;

const TREES: u32 = 1100;
const POLES: i32 = 20;
const POLE_STEP_M: f32 = 32.0;

/// Half width of the camera's street with its pavements, metres.
const STREET_HALF_M: f32 = 7.0;

pub(super) fn town(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    let half = BLOCK_M * (ROWS as f32 + 1.0);
    stage.ground(Vec2::ZERO, Vec2::splat(2.0 * half), palette::MEADOW);
    let asphalt = stage.material("street", palette::STONE * 0.5, 0.9);
    let mut street = MeshBuilder::new();
    street.box_between(Vec3::new(-STREET_HALF_M, -0.05, -half + 1.0), Vec3::new(STREET_HALF_M, 0.02, half - 1.0));
    stage.add("street", asphalt, street);
    add_houses(&mut stage);
    add_trees(&mut stage, half);
    add_poles(&mut stage);
    add_things(&mut stage);
    stage.camera(Vec3::new(2.2, 1.7, 14.0), Vec3::new(-3.5, 2.1, -40.0), 58.0);
    stage.scene.cameras[0].far_m = 3000.0;
    let sun = LightShape::Sun { angular_diameter_rad: 0.53f32.to_radians() };
    stage.light(sun, Vec3::ZERO, Vec3::new(0.70, -0.42, -0.34));
    stage.scene
}

fn unit(seed: u32) -> f32 {
    unit_f32(hash_u32(seed))
}

/// Instances of one house on all lots, each shifted, turned and scaled differently.
fn add_houses(stage: &mut Stage) {
    let plaster = stage.material("house", palette::PLASTER, 0.9);
    let tiles = stage.material("roof", palette::TERRACOTTA, 0.8);
    let mut walls = MeshBuilder::new();
    walls.box_between(Vec3::new(-5.0, -0.05, -4.0), Vec3::new(5.0, 5.6, 4.0));
    walls.box_between(Vec3::new(2.2, 5.0, -1.0), Vec3::new(3.0, 9.0, -0.2));
    // A porch: a slab on posts.
    walls.box_between(Vec3::new(-2.0, 2.6, 3.9), Vec3::new(1.5, 2.75, 5.6));
    for (i, x) in [-1.8f32, 1.3].into_iter().enumerate() {
        walls.cylinder(Vec3::new(x, -0.04, 5.4), Vec3::new(x, 2.65, 5.4), 0.09 + 0.001 * i as f32, 10);
    }
    let mut roof = MeshBuilder::new();
    roof.place(Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.82)) * Affine3A::from_rotation_y(FRAC_PI_4));
    roof.cone(Vec3::new(0.0, 5.5, 0.0), Vec3::new(0.0, 8.6, 0.0), 7.9, 4);
    let [walls, roof] = [stage.mesh("house", plaster, walls), stage.mesh("roof", tiles, roof)];
    for i in 0..2 * ROWS {
        let column = i / 2;
        let side = if i % 2 == 0 { -1.0 } else { 1.0 };
        for row in -ROWS..=ROWS {
            let seed = 977 * (row + ROWS) as u32 + i as u32;
            let shift = 3.0 * Vec2::new(unit(seed), unit(seed + 50_000)) - 1.5;
            let at = Vec3::new(
                side * (17.0 + BLOCK_M * column as f32 + shift.x),
                0.0,
                BLOCK_M * (row as f32 + 0.35) + shift.y,
            );
            let quarter = if column == 0 { side * -2.0 * FRAC_PI_4 } else { (seed % 4) as f32 * 2.0 * FRAC_PI_4 };
            let turn = Quat::from_rotation_y(quarter + 0.1 * unit(seed + 90_000));
            let size = Vec3::new(1.0, 0.8 + 0.5 * unit(seed + 70_000), 1.0);
            let place = Affine3A::from_scale_rotation_translation(size, turn, at);
            stage.instance(walls, place);
            stage.instance(roof, place);
        }
    }
}

/// Conifers between the houses and along the street.
fn add_trees(stage: &mut Stage, half_m: f32) {
    let bark = stage.material("trunk", palette::BARK, 0.9);
    let needles = stage.material("needles", palette::LEAF, 0.9);
    let mut trunk = MeshBuilder::new();
    trunk.frustum(Vec3::new(0.0, -0.05, 0.0), Vec3::new(0.0, 2.4, 0.0), 0.16, 0.12, 8);
    let mut crown = MeshBuilder::new();
    for (i, (y, radius)) in [(1.4f32, 1.5f32), (2.7, 1.15), (3.9, 0.8)].into_iter().enumerate() {
        crown.cone(Vec3::new(0.0, y, 0.0), Vec3::new(0.0, y + 1.9, 0.0), radius, 12 + i as u32);
    }
    let [trunk, crown] = [stage.mesh("trunk", bark, trunk), stage.mesh("crown", needles, crown)];
    for i in 0..TREES {
        let along = half_m * (2.0 * unit(3 * i + 1_000_000) - 1.0);
        // A tenth of them line the street.
        let aside = if i % 10 == 0 {
            (if i % 20 == 0 { 1.0 } else { -1.0 }) * (STREET_HALF_M + 1.2)
        } else {
            half_m * (2.0 * unit(3 * i + 1_000_001) - 1.0)
        };
        if aside.abs() < STREET_HALF_M + 1.0 || (i % 10 != 0 && aside.abs() < 25.0) {
            continue;
        }
        let size = 0.8 + 1.3 * unit(3 * i + 1_000_002);
        let at = Vec3::new(aside, 0.0, along);
        let place = Affine3A::from_scale_rotation_translation(Vec3::splat(size), Quat::from_rotation_y(6.0 * size), at);
        stage.instance(trunk, place);
        stage.instance(crown, place);
    }
}

/// Poles with arms, and wires from one to the next.
fn add_poles(stage: &mut Stage) {
    let steel = stage.metal("pole", palette::STEEL, 0.5);
    let mut pole = MeshBuilder::new();
    pole.cylinder(Vec3::new(0.0, -0.05, 0.0), Vec3::new(0.0, 7.0, 0.0), 0.08, 10);
    pole.box_between(Vec3::new(-0.6, 6.7, -0.04), Vec3::new(0.6, 6.8, 0.04));
    let mut wires = MeshBuilder::new();
    for x in [-0.55f32, 0.55] {
        let sag = |i: u32| {
            let t = i as f32 / 8.0;
            Vec3::new(x, 6.82 - 0.8 * (t - t * t), POLE_STEP_M * t)
        };
        let points: Vec<Vec3> = (0..=8).map(sag).collect();
        wires.tube(&points, 5, |_| 0.012);
    }
    let [pole, wires] = [stage.mesh("pole", steel, pole), stage.mesh("wires", steel, wires)];
    for i in -POLES..POLES {
        let place = Affine3A::from_translation(Vec3::new(-STREET_HALF_M + 0.9, 0.0, POLE_STEP_M * i as f32));
        stage.instance(pole, place);
        stage.instance(wires, place);
    }
}

/// A bench, a fence and a few boxes: fine detail in the first metres.
fn add_things(stage: &mut Stage) {
    let wood = stage.material("fence and bench", palette::PALE_WOOD, 0.7);
    let mut things = MeshBuilder::new();
    for i in 0..24 {
        let z = 8.0 - 0.45 * i as f32;
        things.box_between(Vec3::new(5.28, -0.02, z - 0.05), Vec3::new(5.32, 1.0, z + 0.05));
    }
    for (i, y) in [0.3f32, 0.75].into_iter().enumerate() {
        let inset = 0.01 * i as f32;
        things.box_between(Vec3::new(5.32 - 0.005, y, -2.7 - inset), Vec3::new(5.36, y + 0.08, 8.3 + inset));
    }
    things.box_between(Vec3::new(0.0, 0.42, 5.0), Vec3::new(0.45, 0.47, 6.6));
    for (i, z) in [5.1f32, 6.4].into_iter().enumerate() {
        things.box_between(Vec3::new(0.03, 0.0, z), Vec3::new(0.42, 0.425 + 0.001 * i as f32, z + 0.08));
    }
    stage.add("fence and bench", wood, things);
}
