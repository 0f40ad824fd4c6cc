//! `stained-glass`: panes of several colours in a lead frame throw coloured light on a floor.
//!
//! After Selgrad, Dachsbacher, Meyer & Stamminger 2014, fig. 1 left: coloured soft shadows of semi-transparent
//! occluders beside those of opaque ones.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette};
use crate::{Material, Scene};

/// Name and transmitted linear RGB of each kind of glass, which is coloured throughout.
const TINTS: [(&str, Vec3); 5] = [
    ("ruby", Vec3::new(0.814, 0.098, 0.107)),
    ("cobalt", Vec3::new(0.107, 0.191, 0.860)),
    ("amber", Vec3::new(0.953, 0.581, 0.107)),
    ("emerald", Vec3::new(0.116, 0.628, 0.219)),
    ("violet", Vec3::new(0.461, 0.135, 0.674)),
];

/// Bottom of the glass, centre of the rose, and radius of the rose, metres; the window's middle plane is z = 0.
const SILL_Y_M: f32 = 0.55;
const ROSE_CENTER: Vec3 = Vec3::new(0.0, 2.2, 0.0);
const ROSE_RADIUS_M: f32 = 1.0;

const PETALS: usize = 12;
/// Width of a lancet, and its upper end under the rose, metres.
const LANCET_WIDTH_M: f32 = 0.5 * ROSE_RADIUS_M;
const LANCET_TOP_Y_M: f32 = ROSE_CENTER.y - ROSE_RADIUS_M - 0.08;

/// The glass and the lead that holds it.
#[derive(Default)]
struct Glazing {
    panes: [MeshBuilder; TINTS.len()],
    lead: MeshBuilder,
}

impl Glazing {
    /// A lead bar, 2.6 cm deep.
    fn bar(&mut self, a: Vec3, b: Vec3, width_m: f32) {
        self.lead.beam(a, b, width_m, 0.026, Vec3::Z);
    }
}

/// The k-th corner of the dodecagon about the rose's middle.
fn rim(radius: f32, k: usize) -> Vec3 {
    let (sin, cos) = (TAU * (k % PETALS) as f32 / PETALS as f32).sin_cos();
    ROSE_CENTER + Vec3::new(sin, cos, 0.0) * radius
}

/// A rose of twelve petals in two rings over four lancets, in a stone wall.
pub(super) fn stained_glass(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.0, 1.9), Vec2::new(7.0, 5.6), palette::MARBLE * 0.9);

    let mut glazing = Glazing::default();
    add_rose(&mut glazing);
    add_lancets(&mut glazing);
    for (builder, (name, tint)) in glazing.panes.into_iter().zip(TINTS) {
        let glass = stage.push_material(Material {
            name: name.into(),
            base_color: tint.extend(1.0),
            transmission: 1.0,
            roughness: 0.1,
            double_sided: true,
            ..Material::default()
        });
        stage.add(name, glass, builder);
    }
    let metal = stage.material("lead", palette::IRON, 0.5);
    stage.add("lead", metal, glazing.lead);
    add_wall(&mut stage);
    add_bench(&mut stage);

    stage.camera(Vec3::new(1.9, 2.9, 5.9), Vec3::new(0.1, 1.1, 0.8), 46.0);
    stage.square_light(0.4, Vec3::new(-0.5, 6.2, -3.0), Vec3::new(0.0, 0.5, 1.0));
    stage.scene
}

/// Twelve petals in two rings about an eye.
fn add_rose(glazing: &mut Glazing) {
    const EYE_M: f32 = 0.24;
    const WAIST_M: f32 = 0.62;
    for k in 0..PETALS {
        // Clockwise about +z as k grows; panes face the room at +z.
        let quad = |inner: f32, outer: f32| [rim(inner, k), rim(outer, k), rim(outer, k + 1), rim(inner, k + 1)];
        let facing_room = |mut corners: [Vec3; 4]| {
            corners.reverse();
            corners
        };
        glazing.panes[k % 2].sheet(&facing_room(quad(EYE_M, WAIST_M)), Vec3::Z);
        glazing.panes[2 + (k % 3)].sheet(&facing_room(quad(WAIST_M, ROSE_RADIUS_M)), Vec3::Z);
        glazing.panes[2].sheet(&[rim(EYE_M, k + 1), rim(EYE_M, k), ROSE_CENTER], Vec3::Z);
        glazing.bar(rim(EYE_M - 0.01, k), rim(ROSE_RADIUS_M, k), 0.03);
        for radius in [EYE_M, WAIST_M, ROSE_RADIUS_M] {
            glazing.bar(rim(radius, k), rim(radius, k + 1), 0.03);
        }
    }
}

/// Four lancets under the rose, each of three panes by two.
fn add_lancets(glazing: &mut Glazing) {
    for lancet in 0..4 {
        let x0 = (lancet as f32 - 2.0) * LANCET_WIDTH_M;
        for row in 0..3 {
            for column in 0..2 {
                let x = x0 + 0.5 * LANCET_WIDTH_M * column as f32;
                let step = (LANCET_TOP_Y_M - SILL_Y_M) / 3.0;
                let y = SILL_Y_M + step * row as f32;
                let at = |dx: f32, dy: f32| Vec3::new(x + dx, y + dy, 0.0);
                let w = 0.5 * LANCET_WIDTH_M;
                glazing.panes[(lancet + 2 * row + 3 * column) % TINTS.len()]
                    .sheet(&[at(0.0, 0.0), at(w, 0.0), at(w, step), at(0.0, step)], Vec3::Z);
            }
        }
    }
    for k in 0..=8 {
        let x = (k as f32 - 4.0) * 0.5 * LANCET_WIDTH_M;
        let width = if k % 2 == 0 { 0.05 } else { 0.03 };
        glazing.bar(Vec3::new(x, SILL_Y_M - 0.02, 0.0), Vec3::new(x, LANCET_TOP_Y_M + 0.02, 0.0), width);
    }
    for k in 0..=3 {
        let y = SILL_Y_M + (LANCET_TOP_Y_M - SILL_Y_M) * k as f32 / 3.0;
        glazing.bar(Vec3::new(-ROSE_RADIUS_M - 0.03, y, 0.001), Vec3::new(ROSE_RADIUS_M + 0.03, y, 0.001), 0.03);
    }
}

/// The wall: posts, sill and lintel, and four slabs that fill the corners about the rose's dodecagon.
fn add_wall(stage: &mut Stage) {
    let stone = stage.material("wall", palette::STONE * 1.2, 0.9);
    let mut wall = MeshBuilder::new();
    const HALF_DEPTH_M: f32 = 0.09;
    let mut block = |a: Vec2, b: Vec2, inset: f32| {
        wall.box_between(a.extend(-HALF_DEPTH_M + inset), b.extend(HALF_DEPTH_M - inset));
    };
    let top = ROSE_CENTER.y + ROSE_RADIUS_M;
    let side = ROSE_RADIUS_M - 0.01;
    block(Vec2::new(-2.4, -0.005), Vec2::new(-side, 3.6), 0.0);
    block(Vec2::new(side, -0.006), Vec2::new(2.4, 3.601), 0.0);
    block(Vec2::new(-side - 0.1, -0.007), Vec2::new(side + 0.1, SILL_Y_M), 0.002);
    block(Vec2::new(-side - 0.1, top - 0.01), Vec2::new(side + 0.1, 3.599), 0.002);
    block(Vec2::new(-side - 0.1, LANCET_TOP_Y_M), Vec2::new(side + 0.1, ROSE_CENTER.y - ROSE_RADIUS_M + 0.01), 0.004);
    for (quadrant, (sx, sy)) in [(-1.0f32, -1.0f32), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].into_iter().enumerate() {
        // Between the rose's rim and the corner: rim points 0 to 3 of the quadrant, then the corner.
        let corner = |k: usize| rim(ROSE_RADIUS_M, k).truncate() - ROSE_CENTER.truncate();
        for k in 0..3 {
            let [p, q] = [corner(k), corner(k + 1)];
            let outside = Vec2::splat(ROSE_RADIUS_M + 0.05 + 0.004 * k as f32);
            let mut polygon = [p, outside, q].map(|v| v * Vec2::new(sx, sy) + ROSE_CENTER.truncate());
            if (polygon[1] - polygon[0]).perp_dot(polygon[2] - polygon[0]) < 0.0 {
                polygon.reverse();
            }
            // Each wedge has a depth of its own, so that no two share an edge.
            let inset = 0.006 + 0.001 * (3 * quadrant + k) as f32;
            let part = glam::Affine3A::from_translation(Vec3::new(0.0, 0.0, -HALF_DEPTH_M + inset));
            wall.prism(part, &polygon, 2.0 * (HALF_DEPTH_M - inset));
        }
    }
    stage.add("wall", stone, wall);
}

/// A bench in the coloured light.
fn add_bench(stage: &mut Stage) {
    let oak = stage.material("bench", palette::PALE_WOOD, 0.6);
    let mut bench = MeshBuilder::new();
    bench.box_on(Vec3::new(-0.95, 0.4, 2.1), Vec3::new(0.42, 0.05, 1.5));
    for z in [1.52, 2.68] {
        bench.box_on(Vec3::new(-0.95, -0.005, z), Vec3::new(0.36, 0.41, 0.06));
    }
    stage.add("bench", oak, bench);
}
