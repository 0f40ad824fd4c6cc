//! `fence-alpha` and `fence-geometry`: one wire fence, as masked cards and as wires.
//!
//! After Selgrad, Dachsbacher, Meyer & Stamminger 2014, fig. 11: a fence of fine detail from alpha maps. Comparison with
//! the same pattern as solid wires shows what filtering a mask costs.

use std::f32::consts::FRAC_1_SQRT_2;

use antumbra_light::LightShape;
use glam::{Vec2, Vec3};

use super::Arguments;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette};
use crate::{AlphaMode, Image, Material, Scene, Wrap};

/// Width of each of the fence's panels, metres.
const PANEL_WIDTH_M: f32 = 1.8;
/// Lower and upper edge of the mesh, metres.
const MESH_Y_M: (f32, f32) = (0.08, 1.52);
/// Width and height of a diamond, metres; panels and heights are whole numbers of it.
const DIAMOND_M: f32 = 0.12;
/// Radius of a wire, metres.
const WIRE_RADIUS_M: f32 = 0.005;
/// Positions of the posts along the fence, x and z in metres; all panels have the same width.
fn posts() -> [Vec2; 4] {
    let corner = Vec2::new(0.9, 0.1);
    let west = Vec2::new(-PANEL_WIDTH_M, 0.0);
    let south = Vec2::from_angle(-0.9) * PANEL_WIDTH_M * Vec2::new(1.0, -1.0);
    [corner + 2.0 * west, corner + west, corner, corner + south]
}

/// Everything but the wires: ground, posts, top rail, a wooden post box and a ball to receive shadows.
fn surroundings(name: &str) -> Stage {
    let mut stage = Stage::new(name);
    stage.ground(Vec2::new(-0.3, 0.5), Vec2::new(8.0, 7.0), palette::STONE * 1.1);
    let steel = stage.material("posts", palette::TEAL_PAINT * 0.7, 0.4);
    let mut frame = MeshBuilder::new();
    let posts = posts().map(|p| Vec3::new(p.x, 0.0, p.y));
    for post in posts {
        frame.cylinder(post - Vec3::Y * 0.01, post + Vec3::Y * 1.6, 0.03, 14);
        frame.sphere(post + Vec3::Y * 1.61, 0.042, 16, 10);
    }
    for pair in posts.windows(2) {
        let lift = Vec3::Y * (MESH_Y_M.1 + 0.005);
        frame.cylinder(pair[0] + lift, pair[1] + lift, 0.02, 12);
    }
    stage.add("posts", steel, frame);
    let clay = stage.material("ball", palette::RED_PAINT * 1.3, 0.4);
    let mut ball = MeshBuilder::new();
    ball.sphere(Vec3::new(0.15, 0.279, 0.75), 0.28, 48, 32);
    stage.add("ball", clay, ball);

    stage.camera(Vec3::new(-1.0, 2.7, 4.9), Vec3::new(0.0, 0.45, 0.6), 38.0);
    stage.light(LightShape::Disk { radius_m: 0.16 }, Vec3::new(0.9, 4.9, -3.0), Vec3::new(0.0, 0.4, 0.6));
    stage
}

/// Fence of alpha-tested quads, one per panel; one texture tile is one diamond.
pub(super) fn fence_alpha(arguments: &Arguments) -> Scene {
    let mut stage = surroundings(arguments.scene);
    stage.scene.images.push(wire_image());
    let wire = stage.push_material(Material {
        name: "wire".into(),
        base_color_image: Some(stage.scene.images.len() - 1),
        alpha: AlphaMode::Mask { cutoff: 0.5 },
        roughness: 0.4,
        double_sided: true,
        ..Material::default()
    });
    let mut cards = MeshBuilder::new();
    let posts = posts();
    for pair in posts.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|p| Vec3::new(p.x, 0.0, p.y));
        let (low, high) = (Vec3::Y * MESH_Y_M.0, Vec3::Y * MESH_Y_M.1);
        let tiles = Vec2::new(PANEL_WIDTH_M, MESH_Y_M.1 - MESH_Y_M.0) / DIAMOND_M;
        let uvs = [Vec2::new(0.0, tiles.y), tiles, Vec2::new(tiles.x, 0.0), Vec2::ZERO];
        let normal = (b - a).cross(Vec3::Y).normalize();
        cards.card_sheet([a + low, b + low, b + high, a + high], uvs, normal);
    }
    stage.add("wire cards", wire, cards);
    stage.scene
}

/// A diamond: wires along both diagonals of a square tile. Alpha is ½ on a wire's edge, so that the cutoff ½ of the
/// bilinear alpha gives the wires their true width.
fn wire_image() -> Image {
    const TEXELS: u32 = 128;
    let texel_m = DIAMOND_M / TEXELS as f32;
    // Distance to both diagonals on the torus of tiles, because neighbouring tiles reach in at the corners.
    let distance_m = |coordinate: f32| (coordinate - coordinate.round()).abs() * DIAMOND_M * FRAC_1_SQRT_2;
    let texel = |i: u32| {
        let p = Vec2::new((i % TEXELS) as f32 + 0.5, (i / TEXELS) as f32 + 0.5) / TEXELS as f32;
        let nearest = distance_m(p.x - p.y).min(distance_m(p.x + p.y));
        let alpha = (0.5 + (WIRE_RADIUS_M - nearest) / (2.0 * texel_m)).clamp(0.0, 1.0);
        // Lighter along the middle, as a round wire is. Transparent texels have the wire's colour, so that filtering does not
        // darken edges.
        let bulge = (1.0 - (nearest / WIRE_RADIUS_M).min(1.0).powi(2)).sqrt();
        let grey = (120.0 + 50.0 * bulge) as u8;
        [grey, grey, grey, (255.0 * alpha).round() as u8]
    };
    Image { width: TEXELS, height: TEXELS, rgba8: (0..TEXELS * TEXELS).map(texel).collect(), wrap: [Wrap::Repeat; 2] }
}

/// Fence of wires, each a six-sided tube along a diagonal of its panel.
pub(super) fn fence_geometry(arguments: &Arguments) -> Scene {
    const SIDES: u32 = 6;
    let mut stage = surroundings(arguments.scene);
    let steel = stage.material("wire", palette::STEEL, 0.4);
    let mut wires = MeshBuilder::new();
    let posts = posts();
    let (low, high) = MESH_Y_M;
    let height = high - low;
    for (panel, pair) in posts.windows(2).enumerate() {
        let [a, b] = [pair[0], pair[1]].map(|p| Vec3::new(p.x, 0.0, p.y));
        let along = (b - a).normalize();
        // Sides alternate, so that the end ring of a wire does not coincide with the first ring in the next panel.
        let normal = along.cross(Vec3::Y) * if panel % 2 == 0 { 1.0 } else { -1.0 };
        // A wire that rises to the right meets the lower edge at x = k · DIAMOND_M, clipped to 0 ≤ x ≤ width.
        let (first, last) = ((-height / DIAMOND_M).round() as i32 + 1, (PANEL_WIDTH_M / DIAMOND_M).round() as i32);
        for k in first..last {
            let x = k as f32 * DIAMOND_M;
            let (x0, x1) = (x.max(0.0), (x + height).min(PANEL_WIDTH_M));
            let start = Vec2::new(x0, low + x0 - x);
            let end = Vec2::new(x1, low + x1 - x);
            for (mirror, offset) in [(false, 0.35), (true, -0.35)] {
                let at = |p: Vec2| {
                    let x = if mirror { PANEL_WIDTH_M - p.x } else { p.x };
                    a + along * x + Vec3::Y * p.y + normal * (offset * WIRE_RADIUS_M)
                };
                wires.cylinder(at(start), at(end), WIRE_RADIUS_M, SIDES);
            }
        }
    }
    stage.add("wires", steel, wires);
    stage.scene
}
