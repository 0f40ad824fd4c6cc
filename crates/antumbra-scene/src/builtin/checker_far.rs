//! `checker-far`: a chequered canopy over a road to the horizon, under the sun.
//!
//! Fine regular occluders. Their shadows are smaller than a texel everywhere, and smaller than a pixel towards the
//! horizon: without filtering they turn into moiré.

use glam::{Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::Scene;
use antumbra_light::LightShape;

/// 14 m by 90 m of boards in every other cell of 45 cm, on posts.
pub(super) fn checker_far(arguments: &Arguments) -> Scene {
    const CELL_M: f32 = 0.45;
    const COLUMNS: u32 = 31;
    const ROWS: u32 = 200;
    const HEIGHT_M: f32 = 2.7;
    /// Difference between cell and board sizes, metres: boards that meet at a corner must not share an edge.
    const GAP_M: f32 = 0.02;
    let half_width = 0.5 * CELL_M * COLUMNS as f32;
    let length = CELL_M * ROWS as f32;
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.0, 4.0 - 0.5 * length), Vec2::new(2.0 * half_width + 6.0, length + 8.0), palette::SAND);

    let paint = stage.material("boards", palette::PLASTER, 0.8);
    let mut boards = MeshBuilder::new();
    for row in 0..ROWS {
        for column in (row % 2..COLUMNS).step_by(2) {
            let center = Vec3::new((column as f32 + 0.5) * CELL_M - half_width, HEIGHT_M, 2.0 - row as f32 * CELL_M);
            let half = Vec3::new(0.5 * (CELL_M - GAP_M), 0.015, 0.5 * (CELL_M - GAP_M));
            boards.box_between(center - half, center + half);
        }
    }
    stage.add("boards", paint, boards);

    let wood = stage.material("frame", palette::DARK_WOOD * 1.6, 0.7);
    let mut frame = MeshBuilder::new();
    const BAYS: u32 = 20;
    for bay in 0..=BAYS {
        let z = 2.2 - length * bay as f32 / BAYS as f32;
        frame.tint(shade((bay % 3) as f32 / 3.0, 0.15));
        frame.box_between(
            Vec3::new(-half_width - 0.1, HEIGHT_M - 0.16, z - 0.05),
            Vec3::new(half_width + 0.1, HEIGHT_M - 0.005, z + 0.05),
        );
        for x in [-half_width, 0.0, half_width] {
            frame.box_between(Vec3::new(x - 0.06, -0.005, z - 0.06), Vec3::new(x + 0.06, HEIGHT_M - 0.02, z + 0.06));
        }
    }
    stage.add("frame", wood, frame);

    stage.camera(Vec3::new(3.2, 1.65, 4.4), Vec3::new(2.2, 1.15, -6.0), 48.0);
    stage.light(
        LightShape::Sun { angular_diameter_rad: 1.5f32.to_radians() },
        Vec3::new(-30.0, 40.0, -20.0 - 0.5 * length),
        Vec3::new(0.0, 0.0, 4.0 - 0.5 * length),
    );
    stage.scene
}
