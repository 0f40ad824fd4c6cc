//! Tests of trees against their CPU reference, then of masks against closed forms and brute force.

mod irradiance;
mod measure;

use antumbra_light::{Aabb, Light, LightShape, SampleSet, hash_u32};
use glam::{DVec3, EulerRot, Mat4, Quat, UVec2, Vec2, Vec3};

use super::cpu::{Box3, Node, Tree};
use super::mesh::{MeshPlace, Meshes};
use super::textures::MAX_TEXTURES;
use super::tree::TreePrograms;
use crate::TechniqueKind;
use crate::contract::{MeshCaster, MeshVersion, Opacity, SurfaceCoverage, SurfaceTexture};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::shadow::{AnyShadow, Casters};
use crate::testing::{
    Case, Mesh, RECTANGLE, View, gpu, is_software, read_storage, run, test_ground, texture_of, view_of,
};

/// Returns a random number in [0, 1).
fn random(seed: u32) -> f32 {
    (hash_u32(seed) >> 8) as f32 / 16_777_216.0
}

fn random_point(seed: u32) -> Vec3 {
    [0, 1, 2].map(|axis| random(hash_u32(seed) ^ axis)).into()
}

/// Triangles of a mesh, each with corners of its own.
#[derive(Clone, Debug)]
struct Soup {
    name: &'static str,
    corners: Vec<[Vec3; 3]>,
}

impl Soup {
    /// Small triangles at random positions.
    fn anywhere(count: u32, seed: u32) -> Self {
        let triangle = |i: u32| {
            let place = 10.0 * random_point(hash_u32(seed) ^ (4 * i)) - Vec3::new(3.0, 0.0, 40.0);
            [1, 2, 3].map(|k| place + 0.3 * random_point(hash_u32(seed) ^ (4 * i + k)))
        };
        Self { name: "anywhere", corners: (0..count).map(triangle).collect() }
    }

    /// Triangles at one place, whose codes are equal.
    fn at_one_place(count: u32) -> Self {
        Self { name: "at one place", corners: vec![[Vec3::X, Vec3::Y, Vec3::Z]; count as usize] }
    }

    /// Triangles without area, and some that are invalid.
    fn degenerate(count: u32) -> Self {
        let mut soup = Self::anywhere(count, 5);
        for (i, corners) in soup.corners.iter_mut().enumerate() {
            match i % 5 {
                0 => corners[1] = corners[0],
                1 => *corners = [corners[0]; 3],
                2 => corners[2].y = f32::NAN,
                3 => corners[0].x = f32::INFINITY,
                _ => {}
            }
        }
        Self { name: "degenerate", ..soup }
    }

    /// Triangles ever nearer to a corner, so that each node splits off one.
    fn uneven(turns: u32) -> Self {
        let triangle = |i: u32| {
            let middle = Vec3::splat(0.5f32.powi((i % 10) as i32)) + Vec3::new(0.0, 0.0, 2.0 * (i / 10) as f32);
            [middle, middle + 1e-5 * Vec3::X, middle + 1e-5 * Vec3::Y]
        };
        Self { name: "uneven", corners: (0..10 * turns).map(triangle).collect() }
    }

    fn boxes(&self) -> Vec<Box3> {
        self.corners.iter().copied().map(Box3::of).collect()
    }

    fn positions(&self) -> Vec<Vec3> {
        self.corners.iter().flatten().copied().collect()
    }

    fn on_gpu(&self, gpu: &Gpu) -> Mesh {
        let positions = self.positions();
        Mesh::new(gpu, &positions, &(0..positions.len() as u32).collect::<Vec<_>>())
    }

    /// Returns the mesh with each triangle moved separately.
    fn moved(&self) -> Self {
        let move_one = |(i, corners): (usize, &[Vec3; 3])| {
            let by = 2.0 * random_point(77 + i as u32) - Vec3::Y;
            corners.map(|corner| 0.7 * corner + by)
        };
        Self { name: self.name, corners: self.corners.iter().enumerate().map(move_one).collect() }
    }
}

/// Meshes' trees on the device.
struct Trees<'a> {
    gpu: &'a Gpu,
    programs: TreePrograms,
    meshes: Meshes,
}

impl<'a> Trees<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        Self { gpu, programs: TreePrograms::new(gpu), meshes: Meshes::new(gpu) }
    }

    fn bring(&mut self, casters: &[MeshCaster<'_>]) -> Vec<MeshPlace> {
        let casters: Vec<_> = casters.iter().collect();
        let stage = Stage::at_once(self.gpu);
        let places = self.meshes.prepare(&stage, &self.programs, "test", &casters).expect("room for a few");
        let mut encoder = self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.meshes.record(&mut Recorder::new(&mut encoder, None), &self.programs);
        self.gpu.queue().submit([encoder.finish()]);
        places
    }

    /// Returns a mesh's stored box, nodes and order.
    fn read(&self, place: MeshPlace, count: usize) -> Tree {
        let nodes: Vec<[u32; 4]> = read_storage(self.gpu, self.meshes.nodes());
        let triangles: Vec<[u32; 4]> = read_storage(self.gpu, self.meshes.triangles());
        let floats =
            |words: [u32; 4]| Vec3::new(f32::from_bits(words[0]), f32::from_bits(words[1]), f32::from_bits(words[2]));
        let own = &nodes[place.first_node as usize..];
        let frame = Box3 { low: floats(own[0]), high: floats(own[1]) };
        let step = step_of(frame);
        let own = &own[2..];
        let node = |[x, y, z, word]: [u32; 4]| {
            let low = Vec3::new((x & 0xffff) as f32, (x >> 16) as f32, (y & 0xffff) as f32);
            let high = Vec3::new((y >> 16) as f32, (z & 0xffff) as f32, (z >> 16) as f32);
            let bounds = Box3 { low: frame.low + step * low, high: frame.low + step * high };
            let is_leaf = word >> 31 == 1;
            let (first, count) = if is_leaf { (word & 0x1ff_ffff, (word >> 25 & 63) + 1) } else { (0, 0) };
            Node { first, count, skip: (!is_leaf).then_some(word), bounds }
        };
        let node_count = node(own[0]).skip.unwrap_or(1);
        let own_triangles = &triangles[place.first_triangle as usize..][..place.triangle_stride as usize * count];
        Tree {
            frame,
            order: own_triangles.chunks(place.triangle_stride as usize).map(|vectors| vectors[0][3]).collect(),
            nodes: own[..node_count as usize].iter().copied().map(node).collect(),
        }
    }
}

fn step_of(frame: Box3) -> Vec3 {
    let largest = frame.low.abs().max(frame.high.abs()).max_element();
    (frame.high - frame.low).max(Vec3::splat((1e-6 * largest).max(1e-30))) / 65535.0
}

/// Checks that a tree has each item once, that skip links pass each subtree, and that boxes contain their items and little more.
fn assert_is_right(soup: &Soup, tree: &Tree) {
    let (name, boxes) = (soup.name, soup.boxes());
    let mut order = tree.order.clone();
    order.sort_unstable();
    assert!(order.into_iter().eq(0..boxes.len() as u32), "{name}: each item once");
    let mut next = 0;
    let step = step_of(tree.frame);
    // Ends of the nodes' item ranges, from the last node to the first.
    let mut runs = vec![(0, 0); tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate() {
        if node.skip.is_none() {
            assert_eq!(node.first, next, "{name}: leaf {i}");
            next += node.count;
            runs[i] = (node.first, node.first + node.count);
        }
    }
    assert_eq!(next as usize, boxes.len(), "{name}: leaves hold all");
    for (i, node) in tree.nodes.iter().enumerate().rev() {
        if let Some(skip) = node.skip {
            let skip = skip as usize;
            assert!(skip > i + 2 && skip <= tree.nodes.len(), "{name}: node {i} leads to {skip}");
            runs[i] = (runs[i + 1].0, runs[skip - 1].1);
            let second = tree.nodes[i + 1].skip.map_or(i + 2, |skip| skip as usize);
            assert!(second < skip, "{name}: node {i} has two children");
            assert_eq!(tree.nodes[second].skip.map_or(second + 1, |skip| skip as usize), skip, "{name}: node {i}");
        }
        let (first, end) = runs[i];
        let held = tree.bounds_of(&boxes, first as usize, end as usize);
        if !held.is_empty() {
            let rounding =
                1e-6 * (held.low.abs().max(held.high.abs()) + tree.frame.low.abs().max(tree.frame.high.abs()));
            let (low, high) = (held.low - node.bounds.low, node.bounds.high - held.high);
            assert!(
                low.cmpge(-rounding).all() && high.cmpge(-rounding).all(),
                "{name}: node {i} misses its items: {node:?} {held:?}"
            );
            let most = 1.5 * step + rounding;
            assert!(
                low.cmple(most).all() && high.cmple(most).all(),
                "{name}: node {i} is too large: {node:?} {held:?}"
            );
        }
    }
}

fn soups() -> Vec<Soup> {
    let mut soups: Vec<Soup> =
        [1, 2, 3, 4, 5, 6, 8, 9, 17, 64, 100, 2047, 2048, 2049, 5000].map(|count| Soup::anywhere(count, count)).into();
    soups.extend([1, 4, 5, 700].map(Soup::at_one_place));
    soups.extend([1, 9, 300].map(Soup::degenerate));
    soups.extend([1, 3, 40].map(Soup::uneven));
    soups
}

#[test]
fn cpu_reference_is_right() {
    soups().iter().for_each(|soup| assert_is_right(soup, &Tree::new(&soup.boxes())));
}

#[test]
fn trees_are_those_of_their_cpu_reference() {
    let Some(gpu) = gpu() else { return };
    let soups = soups();
    let meshes: Vec<Mesh> = soups.iter().map(|soup| soup.on_gpu(gpu)).collect();
    let casters: Vec<_> = meshes.iter().map(Mesh::caster).collect();
    let mut trees = Trees::new(gpu);
    let places = trees.bring(&casters);
    for (soup, place) in soups.iter().zip(places) {
        let (had, want) = (trees.read(place, soup.corners.len()), Tree::new(&soup.boxes()));
        assert_is_right(soup, &had);
        // Other devices round divisions differently, and hence codes.
        if is_software(gpu) {
            assert_eq!(had.order, want.order, "{} of {}", soup.name, soup.corners.len());
            let forms = |tree: &Tree| {
                tree.nodes
                    .iter()
                    .map(|node| (node.skip, (node.skip.is_none()).then_some((node.first, node.count))))
                    .collect::<Vec<_>>()
            };
            assert_eq!(forms(&had), forms(&want), "{} of {}", soup.name, soup.corners.len());
        }
    }
}

#[test]
fn moved_meshes_are_fitted_and_keep_their_order() {
    let Some(gpu) = gpu() else { return };
    let (still, soup) = (Soup::anywhere(500, 3), Soup::anywhere(3000, 4));
    let (still_mesh, mesh) = (still.on_gpu(gpu), soup.on_gpu(gpu));
    let with = |mesh, of_mesh, vertices| MeshCaster {
        version: Some(MeshVersion { mesh: of_mesh, vertices }),
        ..Mesh::caster(mesh)
    };
    let mut trees = Trees::new(gpu);
    let places = trees.bring(&[with(&still_mesh, 1, 0), with(&mesh, 2, 0)]);
    let before = trees.read(places[1], soup.corners.len());
    assert_eq!(trees.bring(&[with(&still_mesh, 1, 0), with(&mesh, 2, 0)]), places);
    assert!(trees.meshes.is_idle(), "nothing changed");

    let moved = soup.moved();
    gpu.queue().write_buffer(&mesh.positions, 0, bytemuck::cast_slice(&moved.positions()));
    assert_eq!(trees.bring(&[with(&still_mesh, 1, 0), with(&mesh, 2, 1)]), places);
    let after = trees.read(places[1], soup.corners.len());
    assert_is_right(&moved, &after);
    assert_eq!(after.order, before.order);
    assert_is_right(&still, &trees.read(places[0], still.corners.len()));
}

#[test]
fn meshes_without_a_version_are_fitted_in_each_frame() {
    let Some(gpu) = gpu() else { return };
    let soup = Soup::anywhere(300, 6);
    let mesh = soup.on_gpu(gpu);
    let mut trees = Trees::new(gpu);
    trees.bring(&[mesh.caster()]);
    let moved = soup.moved();
    gpu.queue().write_buffer(&mesh.positions, 0, bytemuck::cast_slice(&moved.positions()));
    let place = trees.bring(&[mesh.caster()])[0];
    assert_is_right(&moved, &trees.read(place, soup.corners.len()));
}

#[test]
fn meshes_come_and_go() {
    let Some(gpu) = gpu() else { return };
    let soups: Vec<Soup> = (1..8).map(|i| Soup::anywhere(37 * i, i)).collect();
    let meshes: Vec<Mesh> = soups.iter().map(|soup| soup.on_gpu(gpu)).collect();
    let mut trees = Trees::new(gpu);
    for frame in [&[0, 1, 2][..], &[2, 5], &[], &[6, 0, 3, 4], &[1, 2, 3, 4, 5, 6], &[3, 0]] {
        let caster = |i: &usize| MeshCaster {
            version: Some(MeshVersion { mesh: *i as u64, vertices: 0 }),
            ..meshes[*i].caster()
        };
        let casters: Vec<_> = frame.iter().map(caster).collect();
        let places = trees.bring(&casters);
        for (i, place) in frame.iter().zip(places) {
            assert_is_right(&soups[*i], &trees.read(place, soups[*i].corners.len()));
        }
    }
}

/// Reference for masks: brute force over all triangles, in double precision.
struct Truth<'a> {
    light: &'a Light,
    points: Vec<Vec3>,
    /// Corners in the world, and transmittance.
    triangles: Vec<([DVec3; 3], f32)>,
}

impl Truth<'_> {
    fn visibility(&self, receiver: Vec3) -> f32 {
        let frame = self.light.frame();
        let start = receiver.as_dvec3() + 1e-5 * DVec3::Y;
        let seen = |u: &Vec3| {
            let point = self.light.point(&frame, *u, receiver);
            let along = point.xyz.as_dvec3() - f64::from(point.w) * start;
            let end = if point.w == 0.0 { f64::INFINITY } else { 1.0 };
            let meets = |corners: &[DVec3; 3]| {
                let [a, b, c] = corners.map(|corner| corner - start);
                let sides = [b.cross(c).dot(along), c.cross(a).dot(along), a.cross(b).dot(along)];
                let fall = (b - a).cross(c - a).dot(along);
                let t = a.dot((b - a).cross(c - a)) / fall;
                fall != 0.0 && sides.iter().all(|side| side * fall >= 0.0) && t > 0.0 && t < end
            };
            let met = self.triangles.iter().filter(|(corners, _)| meets(corners));
            met.map(|(_, passes)| *passes).product::<f32>()
        };
        self.points.iter().map(seen).sum::<f32>() / self.points.len() as f32
    }
}

/// Returns matrices of all kinds: rotated, of uneven scale, mirrored, flattened, of zero extent.
fn poses(count: u32) -> Vec<Mat4> {
    let pose = |i: u32| {
        let place =
            Vec3::new(6.0 * random(i ^ 0x51) - 3.0, 1.0 + 1.5 * random(i ^ 0x1_52), 4.0 * random(i ^ 0x2_53) - 2.0);
        let turn = Quat::from_euler(EulerRot::XYZ, 6.0 * random(i ^ 0x3_54), 6.0 * random(i ^ 0x4_55), 0.3);
        let scale = match i % 6 {
            0 => Vec3::splat(0.1),
            1 => Vec3::new(0.3, 0.02, 0.1),
            2 => Vec3::new(-0.1, 0.1, 0.1),
            3 => Vec3::new(0.1, 0.0, 0.1),
            4 => Vec3::new(0.15, 0.1, 1e-6),
            _ => Vec3::new(0.05, 0.2, 0.1),
        };
        let scale = if i == 11 { Vec3::ZERO } else { scale };
        Mat4::from_scale_rotation_translation(2.5 * scale, turn, place)
    };
    (0..count).map(pose).collect()
}

/// Ground under instances of a mesh.
struct Under<'a> {
    gpu: &'a Gpu,
    case: Case,
    mesh: Mesh,
}

impl<'a> Under<'a> {
    fn new(gpu: &'a Gpu, shape: LightShape, soup: &Soup, poses: &[Mat4]) -> Self {
        let light = Light::new(shape, Vec3::new(0.5, 4.0, 0.3), Vec3::ZERO);
        let view = View::new(Vec3::new(0.5, 2.5, 5.0), Vec3::new(0.0, 0.0, 0.0));
        let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
        let mut mesh = soup.on_gpu(gpu);
        mesh.instances = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test instances"),
            size: size_of_val(poses) as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        // Only the ground is visible.
        Self { gpu, case: Case::new(gpu, light, view, vec![ground]), mesh }
    }

    fn technique(&self) -> AnyShadow {
        let mut technique = TechniqueKind::RayTraced.create(self.gpu).expect("any device");
        for (key, value) in [("samples", "16"), ("rotate", "false")] {
            technique.set(key, value).expect("a parameter");
        }
        technique
    }

    /// Returns the error of a frame's mask against brute force. `passes` is the surface's transmittance.
    fn error(
        &self,
        technique: &mut AnyShadow,
        (soup, poses): (&Soup, &[Mat4]),
        version: Option<MeshVersion>,
        (opacity, passes): (Opacity<'_>, f32),
    ) -> f32 {
        let queue = self.gpu.queue();
        queue.write_buffer(&self.mesh.positions, 0, bytemuck::cast_slice(&soup.positions()));
        queue.write_buffer(&self.mesh.instances, 0, bytemuck::cast_slice(poses));
        let instance_count = poses.len() as u32;
        let casters = [
            self.case.meshes[0].caster(),
            MeshCaster { instance_count, bounds: Aabb::EVERYTHING, opacity, version, ..self.mesh.caster() },
        ];
        let mask = self
            .case
            .with_frame(Casters::Meshes(&casters), |frame| run(self.gpu, technique, frame).expect("a good frame"));
        assert!(mask.iter().all(|v| (0.0..=1.0).contains(v)), "{}: out of range", soup.name);
        let in_world = |pose: &Mat4| {
            let pose = pose.as_dmat4();
            let placed = move |corners: &[Vec3; 3]| corners.map(|corner| pose.transform_point3(corner.as_dvec3()));
            soup.corners.iter().map(placed)
        };
        let triangles = poses.iter().flat_map(in_world).filter(|corners| corners.iter().all(|c| c.is_finite()));
        let triangles = triangles.map(|corners| (corners, passes)).collect();
        let truth = Truth { light: &self.case.light, points: SampleSet::Sobol.points(16, 1), triangles };
        let pixels = self.case.ground_pixels(|p| p.x.abs() < 3.0 && p.z.abs() < 3.0);
        let some = || pixels.iter().skip(3).step_by(11);
        let squares: Vec<f32> = some().map(|(i, p)| (mask[*i] - truth.visibility(*p)).powi(2)).collect();
        let dark: f32 = some().map(|(i, _)| 1.0 - mask[*i]).sum();
        let rmse = (squares.iter().sum::<f32>() / squares.len() as f32).sqrt();
        let (name, count) = (soup.name, soup.corners.len());
        println!(
            "{name}, {count} × {instance_count}: rmse {rmse:.5} over {} pixels, {dark:.0} of them dark",
            squares.len()
        );
        rmse
    }
}

fn error_of(gpu: &Gpu, shape: LightShape, soup: &Soup, poses: &[Mat4], surface: (Opacity<'_>, f32)) -> f32 {
    let under = Under::new(gpu, shape, soup, poses);
    under.error(&mut under.technique(), (soup, poses), None, surface)
}

const OPAQUE: (Opacity<'_>, f32) = (Opacity::Opaque, 0.0);

/// Returns the mesh centred on its origin.
fn centred(soup: &Soup) -> Soup {
    let corners = soup.corners.iter().map(|corners| corners.map(|corner| corner + Vec3::new(-2.0, -5.0, 35.0)));
    Soup { name: soup.name, corners: corners.collect() }
}

/// Error of five rays of the 9248 that are compared with brute force: rounding may move a ray across an edge.
const ROUNDED_RAYS: f32 = 0.006;

const DISK: LightShape = LightShape::Disk { radius_m: 0.4 };

#[test]
fn masks_are_those_of_brute_force() {
    let Some(gpu) = gpu() else { return };
    let triangle = Soup {
        name: "one",
        corners: vec![[Vec3::new(-0.2, 0.0, -0.2), Vec3::new(0.2, 0.05, -0.2), Vec3::new(0.0, 0.0, 0.2)]],
    };
    for (soup, count) in [
        (centred(&Soup::anywhere(150, 9)), 18),
        (triangle.clone(), 1),
        (triangle.clone(), 2000),
        (Soup::at_one_place(50), 12),
        (centred(&Soup::degenerate(200)), 12),
    ] {
        let error = error_of(gpu, DISK, &soup, &poses(count), OPAQUE);
        assert!(error < ROUNDED_RAYS, "{} × {count}: {error}", soup.name);
    }
    for shape in [
        RECTANGLE,
        LightShape::Sphere { radius_m: 0.3 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.2, 0.5, 0.3) },
        LightShape::Sun { angular_diameter_rad: 0.1 },
        LightShape::Disk { radius_m: 0.0 },
    ] {
        let error = error_of(gpu, shape.clone(), &centred(&Soup::anywhere(60, 2)), &poses(12), OPAQUE);
        assert!(error < ROUNDED_RAYS, "{shape:?}: {error}");
    }
}

/// Transmittances of several panes multiply along each ray.
#[test]
fn panes_multiply_along_each_ray() {
    let Some(gpu) = gpu() else { return };
    let pane = Opacity::Translucent { coverage: SurfaceCoverage::Whole, transmitted: Vec3::splat(0.7), texture: None };
    let error = error_of(gpu, DISK, &centred(&Soup::anywhere(150, 9)), &poses(18), (pane, 0.7));
    assert!(error < ROUNDED_RAYS, "{error}");
}

/// Everything is lit without casters, and with casters of zero extent.
#[test]
fn without_casters_all_is_lit() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let lost = case.meshes[1].caster();
    gpu.queue().write_buffer(&case.meshes[1].instances, 0, bytemuck::bytes_of(&Mat4::from_cols_array(&[f32::NAN; 16])));
    for casters in
        [&[][..], &[MeshCaster { instance_count: 0, ..lost }], &[MeshCaster { index_count: 0, ..lost }], &[lost]]
    {
        let mask = case.run_with(gpu, TechniqueKind::RayTraced, &[], Casters::Meshes(casters)).expect("a good frame");
        let pixels = case.ground_pixels(test_ground);
        assert!(pixels.iter().all(|(i, _)| mask[*i] == 1.0), "{} casters", casters.len());
    }
}

/// A mesh of ten kilometres beside one of a metre, also far from its origin, casts the correct shadow.
#[test]
fn far_and_wide_casters_cast_as_near_ones() {
    let Some(gpu) = gpu() else { return };
    let away = Vec3::new(3000.0, -20.0, 500.0);
    let soup = centred(&Soup::anywhere(60, 2));
    let shifted = Soup { name: "far from itself", corners: soup.corners.iter().map(|c| c.map(|c| c + away)).collect() };
    let poses: Vec<Mat4> = poses(6)
        .iter()
        .filter(|pose| pose.determinant() != 0.0)
        .map(|pose| *pose * Mat4::from_translation(-away))
        .collect();
    let error = error_of(gpu, DISK, &shifted, &poses, OPAQUE);
    assert!(error < 0.02, "{error}");
}

/// Sheets one above another, each with its own texture: transmittances multiply across any number of passes.
#[test]
fn more_textures_than_a_pass_binds() {
    let Some(gpu) = gpu() else { return };
    const SHEETS: u32 = 2 * MAX_TEXTURES + 3;
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ZERO });
    let sheets: Vec<Mesh> = (0..SHEETS)
        .map(|i| Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 0.5 + 0.05 * i as f32))
        .collect();
    let alphas: Vec<u8> = (0..SHEETS).map(|i| 5 + 7 * (i % 4) as u8).collect();
    let views: Vec<_> = alphas
        .iter()
        .map(|alpha| view_of(&texture_of(gpu, UVec2::ONE, wgpu::TextureFormat::Rgba8Unorm, &[[0, 0, 0, *alpha]])))
        .collect();
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor::default());
    let casters: Vec<_> = sheets
        .iter()
        .zip(&views)
        .map(|(sheet, view)| {
            // Texture coordinates are arbitrary here.
            let texture = Some(SurfaceTexture { uvs: &sheet.positions, view, sampler: &sampler });
            let coverage = SurfaceCoverage::Alpha(1.0);
            let opacity = Opacity::Translucent { coverage, transmitted: Vec3::ZERO, texture };
            MeshCaster { opacity, ..sheet.caster() }
        })
        .collect();
    let mask = case.run_with(gpu, TechniqueKind::RayTraced, &[], Casters::Meshes(&casters)).expect("a good frame");
    let passes: f32 = alphas.iter().map(|alpha| 1.0 - f32::from(*alpha) / 255.0).product();
    for (i, p) in case.ground_pixels(|p| test_ground(p) && p.x.abs() > 0.05) {
        let want = if p.x < 0.0 { passes } else { 1.0 };
        assert!((mask[i] - want).abs() < 0.003, "at {p}: {} for {want}", mask[i]);
    }
}

/// Vertices deform and instances move between frames, for a mesh with a version and one without.
#[test]
fn bent_and_moved_casters_cast_as_they_are_now() {
    let Some(gpu) = gpu() else { return };
    for tells in [true, false] {
        let mut soup = centred(&Soup::anywhere(150, 9));
        let under = Under::new(gpu, DISK, &soup, &poses(18));
        let mut technique = under.technique();
        for frame in 0..4 {
            let turn = Mat4::from_rotation_y(0.4 * frame as f32);
            let moved: Vec<Mat4> = poses(18).into_iter().map(|pose| turn * pose).collect();
            let version = tells.then_some(MeshVersion { mesh: 1, vertices: frame });
            let error = under.error(&mut technique, (&soup, &moved), version, OPAQUE);
            assert!(error < ROUNDED_RAYS, "frame {frame}: {error}");
            soup = soup.moved();
        }
    }
}
