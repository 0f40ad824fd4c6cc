//! `hairball`: a ball of hairs that are each far thinner than a texel of any shadow map.
//!
//! After the hair ball of 44 000 triangles of Sintorn, Eisemann & Assarsson 2008, fig. 14.

use glam::{Vec2, Vec3};

use super::Arguments;
use super::noise::{Random, value_noise};
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;

/// Hairs of seven segments with three sides, closed at both ends: 44 triangles each.
pub(super) fn hairball(arguments: &Arguments) -> Scene {
    const TRIANGLES: usize = 44_000;
    const SEGMENTS: usize = 7;
    const BALL_RADIUS_M: f32 = 0.45;
    const HAIR_LENGTH_M: f32 = 0.85;
    const ROOT_RADIUS_M: f32 = 0.006;
    const CENTER: Vec3 = Vec3::new(0.0, 1.45, 0.0);
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.2, 0.2), Vec2::new(7.4, 6.2), palette::SAND);
    let skin = stage.material("ball", palette::DARK_WOOD * 1.5, 0.8);
    let mut ball = MeshBuilder::new();
    ball.sphere(CENTER, BALL_RADIUS_M, 24, 16);
    stage.add("ball", skin, ball);

    let fibre = stage.material("hair", palette::OCHRE, 0.5);
    let mut hair = MeshBuilder::new();
    let mut random = Random::new(44);
    let triangles_each = 6 * SEGMENTS + 2;
    let hairs = (TRIANGLES - stage.triangle_count()) / triangles_each;
    for _ in 0..hairs {
        let outward = random.direction();
        hair.tint(shade(random.unit(), 0.35));
        let length = HAIR_LENGTH_M * random.range(0.75, 1.1);
        let mut point = CENTER + outward * (BALL_RADIUS_M - 0.03);
        let mut heading = outward;
        let mut points = vec![point];
        for _ in 0..SEGMENTS {
            point += heading * (length / SEGMENTS as f32);
            points.push(point);
            // Neighbouring hairs turn alike, and all droop a little, which forms locks.
            let lock = Vec3::from_array([0.0, 31.0, 57.0].map(|shift| value_noise(point * 2.6 + shift)));
            heading = (heading + lock * 0.55 - Vec3::Y * 0.07).normalize();
        }
        hair.tube(&points, 3, |k| ROOT_RADIUS_M * (1.0 - 0.7 * k as f32 / SEGMENTS as f32));
    }
    stage.add("hair", fibre, hair);

    stage.camera(Vec3::new(0.8, 3.1, 5.0), Vec3::new(0.35, 1.12, 0.1), 40.0);
    stage.square_light(0.5, Vec3::new(-1.9, 5.4, -0.6), Vec3::new(0.0, 0.4, 0.1));
    stage.scene
}
