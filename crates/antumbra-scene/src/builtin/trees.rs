//! `tree`, `tree-alpha`, `bench-under-tree` and `grove`: leaves as triangles and as masked cards, on the same branches.
//!
//! `tree` after Selgrad, Dachsbacher, Meyer & Stamminger 2014, fig. 12 and the plants of Shen, Feng, Yang & Wei 2013,
//! fig. 1; `bench-under-tree` after Lauritzen & McCool 2008, fig. 3: tree to bench is many times bench to ground, so
//! the tree's penumbra bleeds through the bench.

use std::f32::consts::TAU;

use antumbra_light::LightShape;
use glam::{Affine3A, Quat, Vec2, Vec3};

use super::Arguments;
use super::noise::Random;
use super::shapes::MeshBuilder;
use super::stage::{Stage, palette, shade};
use crate::{AlphaMode, Image, Material, Scene, Wrap};

/// A limb: a polyline that tapers.
struct Limb {
    points: Vec<Vec3>,
    root_radius_m: f32,
    tip_radius_m: f32,
    level: usize,
}

/// Growth parameters of a tree. Arrays are indexed by level; level 0 is the trunk.
struct Habit {
    /// Number of children of each limb, per level; the array's length is the number of levels that bear limbs.
    children: &'static [usize],
    /// Lengths of limbs, metres.
    length_m: &'static [f32],
    /// Angle between a limb and its parent, degrees.
    spread_deg: &'static [f32],
    /// Position of the first bough along the trunk, as a fraction of the trunk's length.
    bare: f32,
}

const OLD_TREE: Habit = Habit {
    children: &[8, 6, 5, 4],
    length_m: &[2.1, 1.5, 0.85, 0.46, 0.24],
    spread_deg: &[0.0, 58.0, 50.0, 48.0, 45.0],
    bare: 0.5,
};

/// A taller tree with fewer limbs, for scenes with objects beneath it.
const TALL_TREE: Habit = Habit {
    children: &[7, 6, 4, 3],
    length_m: &[3.1, 1.75, 0.9, 0.5, 0.28],
    spread_deg: &[0.0, 66.0, 52.0, 48.0, 45.0],
    bare: 0.72,
};

/// A tree with few limbs, for many instances.
const YOUNG_TREE: Habit =
    Habit { children: &[7, 4], length_m: &[2.6, 1.25, 0.7], spread_deg: &[0.0, 52.0, 50.0], bare: 0.42 };

const TRUNK_RADIUS_M: f32 = 0.15;

fn grow(habit: &Habit, root: Vec3, seed: u32) -> Vec<Limb> {
    let mut random = Random::new(seed);
    let mut limbs = Vec::new();
    grow_limb(habit, &mut random, &mut limbs, root - Vec3::Y * 0.05, Vec3::Y, TRUNK_RADIUS_M, 0);
    limbs
}

fn grow_limb(
    habit: &Habit,
    random: &mut Random,
    limbs: &mut Vec<Limb>,
    start: Vec3,
    direction: Vec3,
    root_radius_m: f32,
    level: usize,
) {
    const GOLDEN_ANGLE_RAD: f32 = 2.399_963;
    let segments = [6, 5, 4, 3, 2][level];
    let length = habit.length_m[level] * if level == 0 { 1.0 } else { random.range(0.75, 1.15) };
    let wander = if level == 0 { 0.06 } else { 0.2 };
    let mut heading = direction;
    let mut points = vec![start];
    for _ in 0..segments {
        // Limbs wander, and reach up to the light.
        heading = (heading + random.direction() * wander + Vec3::Y * 0.06).normalize();
        points.push(*points.last().expect("a limb has a start") + heading * (length / segments as f32));
    }
    let tip_radius_m = root_radius_m * if level == 0 { 0.45 } else { 0.35 };
    if let Some(children) = habit.children.get(level).copied() {
        let bare = if level == 0 { habit.bare } else { 0.3 };
        let first_azimuth = random.range(0.0, TAU);
        for child in 0..children {
            let t = bare + (1.0 - bare) * (child as f32 + 0.9) / children as f32;
            let along = (t * segments as f32).min(segments as f32 - 1e-3);
            let (k, fraction) = (along as usize, along.fract());
            let base = points[k].lerp(points[k + 1], fraction);
            let parent = (points[k + 1] - points[k]).normalize();
            let azimuth = first_azimuth + GOLDEN_ANGLE_RAD * child as f32;
            let side = Quat::from_axis_angle(parent, azimuth) * parent.any_orthonormal_vector();
            // The last child continues its parent.
            let spread = habit.spread_deg[level + 1] * if child + 1 == children { 0.35 } else { 1.0 };
            let (sin, cos) = (spread + random.around_zero(8.0)).to_radians().sin_cos();
            let radius = (root_radius_m + (tip_radius_m - root_radius_m) * t) * 0.62;
            grow_limb(habit, random, limbs, base, parent * cos + side * sin, radius, level + 1);
        }
    }
    limbs.push(Limb { points, root_radius_m, tip_radius_m, level });
}

/// Limbs as closed tubes, with more sides on lower levels.
fn wood(limbs: &[Limb]) -> MeshBuilder {
    const SIDES: [u32; 5] = [14, 9, 6, 4, 3];
    let mut wood = MeshBuilder::new();
    for limb in limbs {
        let last = limb.points.len() - 1;
        wood.tube(&limb.points, SIDES[limb.level], |k| {
            let t = k as f32 / last as f32;
            // The trunk widens into its roots.
            let flare = if limb.level == 0 { 0.6 * (1.0 - t).powi(6) } else { 0.0 };
            limb.root_radius_m + (limb.tip_radius_m - limb.root_radius_m) * t + TRUNK_RADIUS_M * flare
        });
    }
    wood
}

/// A point of a twig and a direction that leaves it, sideways and outwards.
fn leaf_site(twig: &Limb, t: f32, random: &mut Random) -> (Vec3, Vec3) {
    let last = twig.points.len() - 1;
    let along = (t * last as f32).min(last as f32 - 1e-3);
    let (k, fraction) = (along as usize, along.fract());
    let forward = (twig.points[k + 1] - twig.points[k]).normalize();
    let away = (forward * 0.5 + random.direction() * 0.9 - Vec3::Y * 0.15).normalize();
    (twig.points[k].lerp(twig.points[k + 1], fraction), away)
}

/// Normal perpendicular to `along` that faces the sky as far as possible, with some disorder.
fn facing_sky(along: Vec3, random: &mut Random) -> Vec3 {
    let wish = Vec3::Y + random.direction() * 0.7;
    let normal = wish.reject_from_normalized(along);
    if normal.length_squared() > 1e-6 { normal.normalize() } else { along.any_orthonormal_vector() }
}

/// Leaves of four triangles, two on each side of a folded midrib.
fn leaves(limbs: &[Limb], twig_level: usize, leaves_per_twig: usize, length_m: f32, seed: u32) -> MeshBuilder {
    let mut random = Random::new(seed);
    let mut leaves = MeshBuilder::new();
    for twig in limbs.iter().filter(|limb| limb.level == twig_level) {
        for leaf in 0..leaves_per_twig {
            let t = (leaf as f32 + random.unit()) / leaves_per_twig as f32;
            let (base, along) = leaf_site(twig, t, &mut random);
            let normal = facing_sky(along, &mut random);
            let length = length_m * random.range(0.7, 1.15);
            let half_width = 0.28 * length;
            // To the right of the midrib, if the upper side faces the eye and the tip points away from it.
            let right = along.cross(normal);
            let fold = normal * (0.35 * half_width);
            let tip = base + along * length - normal * (0.12 * length);
            let green = random.range(-1.0, 1.0);
            leaves.tint(shade(random.unit(), 0.3) * Vec3::new(1.0 + 0.25 * green, 1.0, 1.0 - 0.2 * green));
            for side in [1.0, -1.0] {
                let out = right * (side * half_width) + fold;
                let near = base + along * (0.3 * length) + out;
                let far = base + along * (0.68 * length) + out * 0.72;
                let corners = if side > 0.0 { [base, near, far, tip] } else { [base, tip, far, near] };
                let half_normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
                leaves.sheet(&corners, half_normal);
            }
        }
    }
    leaves
}

/// Square cards with a spray of leaves each; the stem enters at the middle of the lower edge.
fn cards(limbs: &[Limb], twig_level: usize, cards_per_twig: usize, size_m: f32, seed: u32) -> MeshBuilder {
    let mut random = Random::new(seed);
    let mut cards = MeshBuilder::new();
    for twig in limbs.iter().filter(|limb| limb.level == twig_level) {
        for card in 0..cards_per_twig {
            let t = (card as f32 + random.unit()) / cards_per_twig as f32;
            let (base, along) = leaf_site(twig, t, &mut random);
            let normal = facing_sky(along, &mut random);
            let size = size_m * random.range(0.8, 1.15);
            let right = along.cross(normal) * (0.5 * size);
            let up = along * size;
            let uvs = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO];
            // Not brighter than the image.
            cards.tint(shade(random.unit(), 0.25) / 1.25);
            cards.card_sheet([base - right, base + right, base + right + up, base - right + up], uvs, normal);
        }
    }
    cards
}

/// A stem with opposite pairs of leaves and one at the end.
fn spray_image() -> Image {
    const TEXELS: u32 = 256;
    const PAIRS: usize = 3;
    // In units of the card's side, y up from the lower edge.
    let mut leaves: Vec<(Vec2, Vec2, f32)> = vec![(Vec2::new(0.5, 0.62), Vec2::Y, 0.37)];
    for pair in 0..PAIRS {
        let root = Vec2::new(0.5, 0.12 + 0.18 * pair as f32);
        for side in [-1.0f32, 1.0] {
            let lean = 0.95 - 0.14 * pair as f32;
            leaves.push((root, Vec2::new(side * lean.sin(), lean.cos()), 0.42 - 0.03 * pair as f32));
        }
    }
    let coverage = |p: Vec2| {
        // Signed distance, positive inside, to a lens of half width w(s) = 0.19 · length · sin(π s)^0.8.
        let leaf = |(root, along, length): &(Vec2, Vec2, f32)| {
            let local = Vec2::new((p - root).perp_dot(*along), (p - root).dot(*along)) / *length;
            let profile = if (0.0..1.0).contains(&local.y) { (0.5 * TAU * local.y).sin().powf(0.8) } else { 0.0 };
            (0.19 * profile - local.x.abs()) * *length
        };
        let stem = if p.y < 0.66 { 0.008 - (p.x - 0.5).abs() } else { -1.0 };
        let vein = leaves.iter().map(|l| (leaf(l), (p - l.0).perp_dot(l.1).abs())).max_by(|a, b| a.0.total_cmp(&b.0));
        let (inside, to_midrib) = vein.expect("there are leaves");
        (inside.max(stem), to_midrib)
    };
    let texel = |i: u32| {
        let p = Vec2::new((i % TEXELS) as f32 + 0.5, TEXELS as f32 - (i / TEXELS) as f32 - 0.5) / TEXELS as f32;
        let (inside, to_midrib) = coverage(p);
        let alpha = (0.5 + 0.5 * inside * TEXELS as f32).clamp(0.0, 1.0);
        // The leaf's colour everywhere, so that filtering does not darken edges; a paler midrib.
        let vein = 1.0 + 0.45 * (1.0 - (to_midrib / 0.008).min(1.0));
        let color = [104.0, 152.0, 69.0].map(|c: f32| (c * vein).min(255.0) as u8);
        [color[0], color[1], color[2], (255.0 * alpha).round() as u8]
    };
    Image { width: TEXELS, height: TEXELS, rgba8: (0..TEXELS * TEXELS).map(texel).collect(), wrap: [Wrap::Clamp; 2] }
}

fn leaf_material(name: &str) -> Material {
    Material {
        name: name.into(),
        base_color: palette::LEAF.extend(1.0),
        roughness: 0.6,
        double_sided: true,
        ..Material::default()
    }
}

/// Adds an alpha-tested material with the image of a spray of leaves; returns its index.
fn push_card_material(stage: &mut Stage) -> usize {
    stage.scene.images.push(spray_image());
    stage.push_material(Material {
        base_color: Vec3::ONE.extend(1.0),
        base_color_image: Some(stage.scene.images.len() - 1),
        alpha: AlphaMode::Mask { cutoff: 0.5 },
        ..leaf_material("leaf cards")
    })
}

/// Ground, wood, camera and light of the two single trees.
fn lone_tree(name: &str) -> (Stage, Vec<Limb>) {
    let mut stage = Stage::new(name);
    stage.ground(Vec2::new(0.4, 0.3), Vec2::new(9.0, 7.5), palette::MEADOW);
    let limbs = grow(&OLD_TREE, Vec3::ZERO, 3);
    let bark = stage.material("bark", palette::BARK, 0.9);
    stage.add("wood", bark, wood(&limbs));
    stage.camera(Vec3::new(1.3, 3.7, 7.9), Vec3::new(0.6, 1.98, 0.0), 43.0);
    stage.square_light(0.6, Vec3::new(-2.6, 7.0, 0.6), Vec3::new(0.2, 0.8, 0.0));
    (stage, limbs)
}

/// A broad tree with 15 360 leaves of four triangles.
pub(super) fn tree(arguments: &Arguments) -> Scene {
    let (mut stage, limbs) = lone_tree(arguments.scene);
    let leaf = stage.push_material(leaf_material("leaves"));
    stage.add("leaves", leaf, leaves(&limbs, 4, 16, 0.105, 31));
    stage.scene
}

/// The same limbs with 2 880 masked cards of seven leaves.
pub(super) fn tree_alpha(arguments: &Arguments) -> Scene {
    let (mut stage, limbs) = lone_tree(arguments.scene);
    let leaf = push_card_material(&mut stage);
    stage.add("leaf cards", leaf, cards(&limbs, 4, 3, 0.24, 31));
    stage.scene
}

/// Number of trees along the grove's sides: one in each square of a grid, except for a clearing.
const GROVE_ROWS: i32 = 8;
/// Distance between trees, and their largest offset from the centres of their squares, metres.
const GROVE_STEP_M: f32 = 3.0;
const GROVE_DISORDER_M: f32 = 0.8;

/// Sixty trees with their leaves on masked cards, and a bench in the clearing between them.
pub(super) fn grove(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    let half_m = 0.5 * GROVE_STEP_M * GROVE_ROWS as f32;
    stage.ground(Vec2::ZERO, Vec2::splat(2.0 * half_m + 6.0), palette::MEADOW);
    let limbs = grow(&YOUNG_TREE, Vec3::ZERO, 12);
    let bark = stage.material("bark", palette::BARK, 0.9);
    let leaf = push_card_material(&mut stage);
    let [wood, cards] =
        [stage.mesh("wood", bark, wood(&limbs)), stage.mesh("leaf cards", leaf, cards(&limbs, 2, 22, 0.42, 91))];
    let mut random = Random::new(5);
    for square in 0..GROVE_ROWS * GROVE_ROWS {
        let (row, column) = (square / GROVE_ROWS, square % GROVE_ROWS);
        let middle = |i: i32| (i as f32 + 0.5) * GROVE_STEP_M - half_m;
        let shift = GROVE_DISORDER_M * Vec2::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0));
        let (turn, size) = (random.range(0.0, TAU), random.range(0.8, 1.3));
        // Four squares are a clearing where the camera looks.
        if (2..=3).contains(&column) && (3..=4).contains(&row) {
            continue;
        }
        let at = Vec3::new(middle(column) + shift.x, 0.0, middle(row) + shift.y);
        let place = Affine3A::from_scale_rotation_translation(Vec3::splat(size), Quat::from_rotation_y(turn), at);
        stage.instance(wood, place);
        stage.instance(cards, place);
    }
    let boards = stage.material("bench", palette::PALE_WOOD, 0.6);
    let mut bench = MeshBuilder::new();
    for k in 0..3 {
        let z = 0.4 + 0.13 * k as f32;
        bench.box_between(Vec3::new(-3.8, 0.43, z), Vec3::new(-2.2, 0.46 + 0.0002 * k as f32, z + 0.11));
    }
    for x in [-3.6f32, -2.45] {
        bench.box_between(Vec3::new(x, -0.01, 0.42), Vec3::new(x + 0.07, 0.432, 0.75));
    }
    stage.add("bench", boards, bench);
    stage.camera(Vec3::new(-0.5, 1.85, 3.0), Vec3::new(-3.6, 0.75, -1.2), 60.0);
    let sun = LightShape::Sun { angular_diameter_rad: 0.53f32.to_radians() };
    stage.light(sun, Vec3::ZERO, Vec3::new(0.62, -0.62, 0.3));
    stage.scene
}

/// A slatted bench in the shade of a tree whose crown is some seven times as far from the seat as the seat from the
/// ground.
pub(super) fn bench_under_tree(arguments: &Arguments) -> Scene {
    let mut stage = Stage::new(arguments.scene);
    stage.ground(Vec2::new(0.3, 0.2), Vec2::new(8.5, 7.5), palette::SAND * 0.9);
    let limbs = grow(&TALL_TREE, Vec3::new(-1.3, 0.0, -1.3), 8);
    let bark = stage.material("bark", palette::BARK, 0.9);
    stage.add("wood", bark, wood(&limbs));
    let leaf = stage.push_material(leaf_material("leaves"));
    stage.add("leaves", leaf, leaves(&limbs, 4, 9, 0.14, 81));

    let iron = stage.material("bench frame", palette::IRON, 0.5);
    let slat = stage.material("bench slats", palette::PALE_WOOD, 0.6);
    let mut frame = MeshBuilder::new();
    let mut slats = MeshBuilder::new();
    const HALF_LENGTH_M: f32 = 0.9;
    let middle = Vec3::new(0.35, 0.0, 0.35);
    let at = |x: f32, y: f32, z: f32| middle + Vec3::new(x, y, z);
    for x in [-0.72, 0.72] {
        frame.beam(at(x, -0.005, 0.24), at(x, 0.42, 0.2), 0.05, 0.04, Vec3::Z);
        frame.beam(at(x, -0.005, -0.26), at(x, 0.44, -0.2), 0.05, 0.04, Vec3::Z);
        frame.beam(at(x, 0.4, -0.18), at(x, 0.95, -0.34), 0.048, 0.036, Vec3::Z);
        frame.beam(at(x, 0.405, -0.24), at(x, 0.405, 0.24), 0.046, 0.034, Vec3::Y);
        frame.beam(at(x, 0.62, -0.26), at(x, 0.62, 0.2), 0.052, 0.032, Vec3::Y);
        frame.beam(at(x, 0.41, 0.18), at(x, 0.63, 0.17), 0.044, 0.03, Vec3::Z);
    }
    for k in 0..5 {
        slats.tint(shade(k as f32 * 0.37 % 1.0, 0.2));
        let z = -0.18 + 0.095 * k as f32;
        slats.beam(at(-HALF_LENGTH_M, 0.44, z), at(HALF_LENGTH_M, 0.44, z), 0.075, 0.035, Vec3::Y);
    }
    for k in 0..4 {
        slats.tint(shade(k as f32 * 0.61 % 1.0, 0.2));
        let (y, z) = (0.56 + 0.105 * k as f32, -0.2 - 0.031 * k as f32);
        slats.beam(at(-HALF_LENGTH_M, y, z), at(HALF_LENGTH_M, y, z), 0.08, 0.03, Vec3::new(0.0, 0.28, 0.96));
    }
    stage.add("bench frame", iron, frame);
    stage.add("bench slats", slat, slats);

    stage.camera(Vec3::new(2.5, 1.9, 4.3), Vec3::new(0.25, 0.55, 0.15), 40.0);
    stage.square_light(0.5, Vec3::new(-2.0, 7.6, -1.6), Vec3::new(0.2, 0.5, 0.2));
    stage.scene
}
