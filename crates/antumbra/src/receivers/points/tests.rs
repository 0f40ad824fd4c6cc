//! Tests of points against masks at the same positions, against closed forms in space, and of rejected input.

use antumbra_light::{Aabb, Light, LightShape, hash_u32, unit_f32};
use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_at_mat4};
use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use super::size_of_points;
use crate::contract::{
    Denoise, DepthConvention, Mask, MaskChannels, MeshCaster, Opacity, PointBuffer, PointReceivers, PointWidths,
    PreparedCasters, PreparedFrame, Receivers, SurfaceCoverage,
};
use crate::gpu::{Bindings, Gpu, Recorder, Stage, bindings, compute_pipeline};
use crate::receivers::inputs::FrameInputs;
use crate::shadow::{AnyShadow, Casters, Frame, PointFrame};
use crate::testing::{
    Mesh, draw_depth, gpu, gpu_with, half_plane_visibility, instances_at, read_layer, read_storage, run, view_of,
};
use crate::{CasterSet, TechniqueKind, shaders};

bindings! {
    struct Probe = "points probe", COMPUTE, group 1 of [POINTS_PROBE] {
        0 found: ReadWrite,
    }
}

pub(crate) const SIZE: UVec2 = UVec2::new(44, 36);

fn storage<T: bytemuck::NoUninit>(gpu: &Gpu, data: &[T]) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(data);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test points"),
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

/// Runs a technique over points and returns their visibilities.
fn run_points(gpu: &Gpu, shadow: &mut AnyShadow, frame: &PointFrame<'_>) -> Vec<f32> {
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let work = shadow.prepare_points(frame).unwrap_or_else(|error| panic!("{error}"));
    work.record(&mut Recorder::new(&mut encoder, None));
    gpu.queue.submit([encoder.finish()]);
    read_storage(gpu, frame.visibilities)
}

/// Camera and closed casters: a ground, with a board and a post on it.
pub(crate) struct Scene {
    meshes: Vec<Mesh>,
    view_from_world: Mat4,
    clip_from_view: Mat4,
    depth: wgpu::TextureView,
    pub(crate) mask: Mask,
    hull: Vec<Vec3>,
    seen: Vec<Vec3>,
}

fn closed_box(gpu: &Gpu, min: Vec3, max: Vec3) -> Mesh {
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices: Vec<u32> = quads.iter().flat_map(|quad| [0, 1, 2, 0, 2, 3].map(|corner| quad[corner])).collect();
    Mesh::new(gpu, &Aabb { min, max }.corners(), &indices)
}

impl Scene {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let meshes = vec![
            closed_box(gpu, Vec3::new(-2.0, -0.2, -2.0), Vec3::new(2.0, 0.0, 2.0)),
            closed_box(gpu, Vec3::new(-0.7, 0.9, -0.5), Vec3::new(0.7, 1.0, 0.5)),
            closed_box(gpu, Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.9, 0.1)),
        ];
        let view_from_world = look_at_mat4(Vec3::new(1.2, 2.2, 2.4), Vec3::new(0.0, 0.3, 0.0), Vec3::Y);
        let clip_from_view = perspective_infinite_reverse(1.0, SIZE.x as f32 / SIZE.y as f32, 0.1);
        let casters: Vec<_> = meshes.iter().map(Mesh::caster).collect();
        let depth = view_of(&draw_depth(gpu, SIZE, clip_from_view * view_from_world, &casters));
        let hull = Aabb { min: Vec3::new(-2.1, -0.25, -2.1), max: Vec3::new(2.1, 1.1, 2.1) }.corners().to_vec();
        let seen = (0..64).map(|i| Vec3::new((i % 8) as f32 * 0.5 - 1.75, 0.0, (i / 8) as f32 * 0.5 - 1.75)).collect();
        Self { meshes, view_from_world, clip_from_view, depth, mask: Mask::new(gpu.device(), SIZE), hull, seen }
    }

    pub(crate) fn casters(&self) -> Vec<MeshCaster<'_>> {
        self.meshes.iter().map(|mesh| MeshCaster { closed: true, ..mesh.caster() }).collect()
    }

    pub(crate) fn receivers(&self) -> Receivers<'_> {
        Receivers {
            size_px: SIZE,
            origin_px: UVec2::ZERO,
            depth: &self.depth,
            depth_convention: DepthConvention::Reversed,
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            normals: None,
            bounds: Some(self.bounds()),
            hull: &self.hull,
            seen: &self.seen,
            shadow_distance: None,
            version: None,
        }
    }

    fn bounds(&self) -> Aabb {
        Aabb::of(self.hull.iter().copied())
    }

    /// Returns the receiver of each pixel, as passes over a mask load it.
    pub(crate) fn places(&self, gpu: &Gpu) -> Places {
        let light = &lamp(LightShape::Disk { radius_m: 0.1 });
        let casters = PreparedCasters::Draws(&[]);
        let frame = PreparedFrame { light, casters, receivers: self.receivers().into(), mask: &self.mask, noisy: None };
        let found = storage(gpu, &vec![Vec4::ZERO; 3 * SIZE.element_product() as usize]);
        let mut inputs = FrameInputs::new(gpu);
        let prepared = inputs.prepare(&Stage::at_once(gpu), &frame);
        let layout = Probe::layout(gpu);
        let pipeline = compute_pipeline(gpu, "test points", shaders::POINTS_PROBE, &[&inputs.layout, &layout]);
        let group = Probe { found: &found }.cached_group(gpu, &layout);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            prepared.bind(&mut pass);
            pass.set_bind_group(1, &group, &[]);
            prepared.dispatch(&mut pass);
        }
        gpu.queue.submit([encoder.finish()]);
        let found: Vec<[Vec4; 3]> = read_storage(gpu, &found);
        // Background pixels become NaN, which is no point.
        let position = |found: &[Vec4; 3]| if found[0].w == 1.0 { found[0] } else { Vec3::NAN.extend(0.0) };
        let surfaces = found.iter().filter(|found| found[0].w == 1.0).count();
        assert!(surfaces > 900 && surfaces < found.len(), "{surfaces} pixels see a surface");
        Places {
            count: found.len() as u32,
            positions: storage(gpu, &found.iter().map(position).collect::<Vec<_>>()),
            normals: storage(gpu, &found.iter().map(|found| found[1].truncate()).collect::<Vec<_>>()),
            widths: storage(gpu, &found.iter().map(|found| found[2].x).collect::<Vec<_>>()),
        }
    }
}

/// Receivers of an image, as points.
pub(crate) struct Places {
    count: u32,
    pub(crate) positions: wgpu::Buffer,
    pub(crate) normals: wgpu::Buffer,
    widths: wgpu::Buffer,
}

impl Places {
    fn receivers<'a>(&'a self, scene: &'a Scene) -> PointReceivers<'a> {
        PointReceivers {
            normals: Some(PointBuffer::packed(&self.normals)),
            widths: PointWidths::Each(PointBuffer { buffer: &self.widths, offset: 0, stride: 4 }),
            row_length: Some(SIZE.x),
            hull: &scene.hull,
            seen: &scene.seen,
            ..PointReceivers::new(self.count, PointBuffer::padded(&self.positions), scene.bounds())
        }
    }
}

pub(crate) fn lamp(shape: LightShape) -> Light {
    Light::new(shape, Vec3::new(0.6, 4.0, 0.5), Vec3::ZERO)
}

/// Returns a light for each kind of map: perspective, parallel, and several, for an omnidirectional lamp between board and ground.
pub(crate) fn lights() -> [(&'static str, Light); 3] {
    let hung = Vec3::new(1.1, 0.6, 0.9);
    [
        ("rectangle", lamp(LightShape::Rectangle { size_m: Vec2::new(0.8, 0.5) })),
        ("sun", lamp(LightShape::Sun { angular_diameter_rad: 0.1 })),
        ("lamp in parts", Light::new(LightShape::Sphere { radius_m: 0.05 }, hung, hung - Vec3::Y)),
    ]
}

/// Returns a technique with those of the settings that it supports.
pub(crate) fn create(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)]) -> AnyShadow {
    let mut shadow = kind.create(gpu).expect("the device has it");
    for (key, value) in settings {
        if kind.param_specs().iter().any(|spec| spec.key == *key) {
            shadow.set(key, value).expect("in range");
        }
    }
    shadow
}

/// Settings with few samples and texels, and without filters over neighbours or a pixel's footprint.
const ALONE: [(&str, &str); 5] =
    [("smooth", "false"), ("mips", "false"), ("samples", "16"), ("central_scale", "1"), ("map_size", "256")];

/// Techniques that filter by the pixel's footprint, a parallelogram clipped at silhouettes; points have squares.
const BY_FOOTPRINT: [TechniqueKind; 2] = [TechniqueKind::PcssAnisotropic, TechniqueKind::Essm];

#[test]
fn points_where_pixels_are_have_the_pixels_visibilities() {
    hold_to_pixels(&lights()[..1]);
}

#[test]
#[ignore = "long"]
fn points_have_the_pixels_visibilities_under_partitioned_lights() {
    hold_to_pixels(&lights()[1..]);
}

/// Points at pixels' positions have the pixels' visibilities to the bit. If a light has several parts, a mask's maps are fitted to
/// what the camera sees of each, so that some pixels at edges may differ.
fn hold_to_pixels(lights: &[(&'static str, Light)]) {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(gpu);
    let places = scene.places(gpu);
    let casters = scene.casters();
    let casters = Casters::Meshes(&casters);
    let visibilities = &storage(gpu, &vec![0.0f32; places.count as usize]);
    for kind in TechniqueKind::ALL {
        for (name, light) in lights {
            let frame = Frame { light, casters, receivers: scene.receivers(), mask: &scene.mask };
            let mask = run(gpu, &mut create(gpu, *kind, &ALONE), &frame).unwrap_or_else(|error| panic!("{error}"));
            let receivers = places.receivers(&scene);
            let frame = PointFrame { light, casters, receivers, visibilities, channels: MaskChannels::One };
            let points = run_points(gpu, &mut create(gpu, *kind, &ALONE), &frame);
            let differing = mask.iter().zip(&points).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            let rms = rms(&mask, &points);
            let [lit, dark] = [mask.iter().filter(|v| **v > 0.9).count(), mask.iter().filter(|v| **v < 0.1).count()];
            println!("{kind}, {name}: {differing} of {} differ, rms {rms:.5}; {lit} lit, {dark} dark", mask.len());
            assert!(lit > 500 && dark > 10, "{kind}, {name}: {lit} lit, {dark} dark");
            if BY_FOOTPRINT.contains(kind) {
                assert!(rms < 0.02, "{kind}, {name}: rms {rms}");
            } else {
                // `multi_view` also allows for the rounding of a depth buffer, which may decide a pixel at an edge.
                let most = if *name == "lamp in parts" || *kind == TechniqueKind::MultiView { 4 } else { 0 };
                assert!(differing <= most, "{kind}, {name}: {differing} differ");
            }
        }
    }
}

pub(crate) fn rms(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / a.len() as f32).sqrt()
}

/// Returns a random number in [0, 1).
fn random(i: u32, k: u32) -> f32 {
    unit_f32(hash_u32(i.wrapping_mul(193).wrapping_add(k * 7919)))
}

/// Visibility under a half-plane at a height of 1.5 m with its edge at x = 0, and a rectangle light of 1 m at 4 m: the segment to the
/// light point `o` crosses the half-plane's height at x + (o − x) t, and is blocked if that is below 0.
fn visibility_in_space(p: Vec3) -> f32 {
    let t = (1.5 - p.y) / (4.0 - p.y);
    if t <= 0.0 { 1.0 } else { (0.5 + p.x * (1.0 - t) / t).clamp(0.0, 1.0) }
}

/// Techniques whose penumbrae have the width of their occluder's, but are farther from the truth than others'.
const FARTHER: [TechniqueKind; 6] = [
    TechniqueKind::Backprojection,
    TechniqueKind::Savsm,
    TechniqueKind::Vssm,
    TechniqueKind::Cssm,
    TechniqueKind::Evssm,
    TechniqueKind::Mssm,
];

/// Points that face the light, in any order and anywhere below or above an occluder, have no larger error than surfaces there.
#[test]
fn points_anywhere_err_no_more_than_surfaces() {
    let Some(gpu) = gpu() else { return };
    const COUNT: u32 = 1200;
    let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    let occluder = Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 1.5);
    let casters = [ground.caster(), occluder.caster()];
    let light = &Light::new(LightShape::Rectangle { size_m: Vec2::ONE }, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO);
    // The bounds are wider than the points, because maps of `reprojection` hold casters between this box and the light's centre.
    let bounds = Aabb { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::new(5.0, 2.0, 5.0) };
    let place = |i: u32| 2.0 * Vec3::new(random(i, 0) - 0.5, random(i, 1), random(i, 2) - 0.5);
    let in_space: Vec<Vec3> = (0..COUNT).map(place).collect();
    let on_ground: Vec<Vec3> = in_space.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
    for p in &on_ground {
        assert!((visibility_in_space(*p) - half_plane_visibility(p.x, 1.0)).abs() < 1e-5, "{p}");
    }
    let up = storage(gpu, &vec![Vec3::Y; COUNT as usize]);
    let visibilities = &storage(gpu, &vec![0.0f32; COUNT as usize]);
    let error = |kind: TechniqueKind, places: &[Vec3], normals| {
        let positions = storage(gpu, places);
        let receivers =
            PointReceivers { normals, ..PointReceivers::new(COUNT, PointBuffer::packed(&positions), bounds) };
        let casters = Casters::Meshes(&casters);
        let frame = PointFrame { light, casters, receivers, visibilities, channels: MaskChannels::One };
        let settings = [("samples", "64"), ("search_samples", "64"), ("central_scale", "1")];
        let got = run_points(gpu, &mut create(gpu, kind, &settings), &frame);
        assert!(got.iter().all(|v| (0.0..=1.0).contains(v)), "{kind}");
        rms(&got, &places.iter().copied().map(visibility_in_space).collect::<Vec<_>>())
    };
    for kind in TechniqueKind::ALL {
        let space = error(*kind, &in_space, None);
        let [surfaces, ground] =
            [&in_space, &on_ground].map(|places| error(*kind, places, Some(PointBuffer::packed(&up))));
        println!("{kind}: rms {space:.4} in space, {surfaces:.4} on surfaces there, {ground:.4} on the ground");
        assert!(space < 1.25 * surfaces + 0.005, "{kind}: {space} in space, {surfaces} on surfaces there");
        let is_far = kind.facts().occluders.has_fixed_width() || FARTHER.contains(kind);
        let most = if is_far { 0.2 } else { 0.05 };
        assert!(space < most, "{kind}: {space} against {most}: better penumbrae, or its name in `FARTHER`");
    }
}

/// Returns the visibilities of a small scene's points, queried in a given way by a technique without noise.
fn asked(
    gpu: &Gpu,
    kind: TechniqueKind,
    light: &Light,
    casters: Casters<'_>,
    receivers: PointReceivers<'_>,
) -> Vec<f32> {
    let visibilities = &storage(gpu, &vec![-1.0f32; receivers.count as usize]);
    let frame = PointFrame { light, casters, receivers, visibilities, channels: MaskChannels::One };
    run_points(gpu, &mut create(gpu, kind, &[("rotate", "false"), ("samples", "16")]), &frame)
}

/// Techniques of each family, without noise.
const SOME: [TechniqueKind; 6] = [
    TechniqueKind::Pcss,
    TechniqueKind::Vsm,
    TechniqueKind::MultiView,
    TechniqueKind::RayTraced,
    TechniqueKind::AliasFree,
    TechniqueKind::SampleBased,
];

/// The order of points, their layout in buffers, and an invalid position do not change the other points' results.
#[test]
fn points_may_lie_in_any_order_and_anyhow_in_buffers() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(gpu);
    let casters = scene.casters();
    let casters = Casters::Meshes(&casters);
    let light = &lamp(LightShape::Disk { radius_m: 0.3 });
    const COUNT: u32 = 300;
    let place = |i: u32| Vec3::new(3.0 * random(i, 0) - 1.5, 0.0, 3.0 * random(i, 1) - 1.5);
    let places: Vec<Vec3> = (0..COUNT).map(place).collect();
    let packed = storage(gpu, &places);
    let normals = storage(gpu, &vec![2.0 * Vec3::Y; COUNT as usize]);
    // Four floats before the first; then width, position, normal and one unused word.
    let mut words = vec![f32::NAN; 4];
    let shuffled = |i: u32| (i * 101 + 7) % COUNT;
    for i in 0..COUNT {
        let p = if i == 17 { Vec3::new(0.0, f32::NAN, 0.0) } else { places[shuffled(i) as usize] };
        words.extend([f32::INFINITY, p.x, p.y, p.z, 0.0, 1.0, 0.0, f32::NAN]);
    }
    let mixed = storage(gpu, &words);
    let part = |offset| PointBuffer { buffer: &mixed, offset, stride: 32 };
    let plain = PointReceivers {
        normals: Some(PointBuffer::packed(&normals)),
        hull: &scene.hull,
        seen: &scene.seen,
        ..PointReceivers::new(COUNT, PointBuffer::packed(&packed), scene.bounds())
    };
    let other = PointReceivers {
        positions: part(20),
        normals: Some(part(32)),
        widths: PointWidths::Each(part(16)),
        row_length: Some(7),
        ..plain
    };
    for kind in SOME {
        let [a, b] = [plain, other].map(|receivers| asked(gpu, kind, light, casters, receivers));
        assert!(a.iter().any(|v| *v < 0.1) && a.iter().any(|v| *v > 0.9), "{kind}: some are dark, some are lit");
        for i in 0..COUNT {
            let (got, want) = (b[i as usize], if i == 17 { 1.0 } else { a[shuffled(i) as usize] });
            assert!((got - want).abs() < 1e-6, "{kind}, point {i}: {got} and {want}");
        }
    }
}

/// Points inside closed casters are dark, even without normals and with the exact techniques.
#[test]
fn points_within_closed_casters_are_dark() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(gpu);
    let casters = scene.casters();
    let places: Vec<Vec3> =
        (0..64).map(|i| Vec3::new(1.2 * random(i, 0) - 0.6, 0.95, 0.8 * random(i, 1) - 0.4)).collect();
    let positions = storage(gpu, &places);
    let receivers = PointReceivers::new(64, PointBuffer::packed(&positions), Aabb::of(places.iter().copied()));
    for (name, light) in &lights()[..2] {
        for kind in SOME {
            let got = asked(gpu, kind, light, Casters::Meshes(&casters), receivers);
            // Filtered moments leak a ten-thousandth.
            let most = got.iter().copied().fold(0.0, f32::max);
            assert!(most < 1e-3, "{kind}, {name}: {most}");
        }
    }
}

/// Results far from the world's origin, where floats are half a millimetre apart, equal those near it.
#[test]
fn points_far_from_the_origin() {
    let Some(gpu) = gpu() else { return };
    const COUNT: u32 = 500;
    let run_at = |away: Vec3, kind| {
        let mesh = Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.0, 4.0), 1.5);
        let instances = instances_at(gpu, away);
        let bounds = Aabb { min: mesh.bounds.min + away, max: mesh.bounds.max + away };
        let casters = [MeshCaster { instances: &instances, bounds, ..mesh.caster() }];
        let light = lamp(LightShape::Disk { radius_m: 0.3 });
        let light = Light { center: light.center + away, ..light };
        // Positions that are exact floats there, too.
        let place =
            |i: u32| (1024.0 * Vec3::new(2.0 * random(i, 0) - 1.0, random(i, 1), random(i, 2))).round() / 1024.0;
        let positions = storage(gpu, &(0..COUNT).map(|i| place(i) + away).collect::<Vec<_>>());
        let bounds = Aabb { min: away - Vec3::new(1.0, 0.0, 0.0), max: away + Vec3::ONE };
        asked(
            gpu,
            kind,
            &light,
            Casters::Meshes(&casters),
            PointReceivers::new(COUNT, PointBuffer::packed(&positions), bounds),
        )
    };
    for kind in [TechniqueKind::Pcss, TechniqueKind::RayTraced, TechniqueKind::SampleBased] {
        let [here, there] = [Vec3::ZERO, Vec3::new(4096.0, 0.0, -8192.0)].map(|away| run_at(away, kind));
        let rms = rms(&here, &there);
        assert!(rms < 0.01, "{kind}: rms {rms}");
        assert!(here.iter().any(|v| *v < 0.1) && here.iter().any(|v| *v > 0.9), "{kind}");
    }
}

/// Red, green and blue of a point are adjacent, and equal those of a mask.
#[test]
fn points_under_tinted_casters_have_colours() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(gpu);
    let places = scene.places(gpu);
    let transmitted = Vec3::new(0.8, 0.5, 0.1);
    let opacity = Opacity::Translucent { coverage: SurfaceCoverage::Whole, transmitted, texture: None };
    let casters: Vec<_> = scene.casters().into_iter().map(|caster| MeshCaster { opacity, ..caster }).collect();
    let casters = Casters::Meshes(&casters);
    let mask = Mask::with_channels(gpu.device(), SIZE, MaskChannels::Three);
    let light = &lamp(LightShape::Disk { radius_m: 0.2 });
    let visibilities = &storage(gpu, &vec![0.0f32; 3 * places.count as usize]);
    for kind in [TechniqueKind::RayTraced, TechniqueKind::SampleBased, TechniqueKind::MultiLayer, TechniqueKind::Pcss] {
        let frame = Frame { light, casters, receivers: scene.receivers(), mask: &mask };
        run(gpu, &mut create(gpu, kind, &ALONE), &frame).unwrap_or_else(|error| panic!("{error}"));
        let receivers = places.receivers(&scene);
        let frame = PointFrame { light, casters, receivers, visibilities, channels: casters.mask_channels() };
        let got = run_points(gpu, &mut create(gpu, kind, &ALONE), &frame);
        for layer in 0..3 {
            let want: Vec<f32> = bytemuck::pod_collect_to_vec(&read_layer(gpu, mask.texture(), layer as u32));
            let of_layer: Vec<f32> = got.chunks_exact(3).map(|rgb| rgb[layer]).collect();
            // Tinted casters are open: segments from them have a larger ray offset if a depth buffer was rounded.
            let differing = want.iter().zip(&of_layer).filter(|(a, b)| (*a - *b).abs() > 1e-6).count();
            println!("{kind}, layer {layer}: {differing} of {} differ", want.len());
            assert!(differing <= 8, "{kind}, layer {layer}: {differing} differ");
            let mean = of_layer.iter().sum::<f32>() / of_layer.len() as f32;
            assert!((0.5..0.999).contains(&mean), "{kind}, layer {layer}: {mean}");
        }
    }
}

/// Still points are not queried again, and a moving light creates no wgpu resource.
#[test]
fn steady_frames_of_points_make_nothing() {
    // A device of its own, so that only this test's resources are counted.
    let Some(gpu) = gpu_with(|_| wgpu::Limits::default()) else { return };
    let gpu = &gpu;
    let scene = Scene::new(gpu);
    let mut set = CasterSet::new(gpu);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    set.update(&mut Recorder::new(&mut encoder, None)).expect("an empty set");
    gpu.queue.submit([encoder.finish()]);
    let casters = scene.casters();
    let places = scene.places(gpu);
    let visibilities = &storage(gpu, &vec![0.0f32; places.count as usize]);
    let passes_of = |shadow: &mut AnyShadow, casters, light: &Light| {
        let receivers = PointReceivers { version: Some(1), ..places.receivers(&scene) };
        let frame = PointFrame { light, casters, receivers, visibilities, channels: MaskChannels::One };
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::new(&mut encoder, None);
        shadow.prepare_points(&frame).expect("a good frame").record(&mut recorder);
        let passes = recorder.passes().len();
        gpu.queue.submit([encoder.finish()]);
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
        passes
    };
    for kind in [TechniqueKind::Pcss, TechniqueKind::RayTraced] {
        let mut shadow = create(gpu, kind, &ALONE);
        let mut before = 0;
        for i in 0..8 {
            let mut light = lamp(LightShape::Disk { radius_m: 0.2 });
            light.center.x += 0.01 * i as f32;
            assert!(passes_of(&mut shadow, Casters::Meshes(&casters), &light) >= 3);
            if i == 3 {
                before = gpu.objects_created().total();
            }
        }
        assert_eq!(gpu.objects_created().total(), before, "{kind} makes nothing while a light moves");
        let still = Casters::Set { set: &set, layers: u32::MAX };
        let light = lamp(LightShape::Disk { radius_m: 0.2 });
        let passes: Vec<_> = (0..4).map(|_| passes_of(&mut shadow, still, &light)).collect();
        assert!(passes[0] >= 3 && passes[3] == 0, "{kind}: {passes:?}");
    }
}

/// Invalid input is rejected with one line that states what is valid.
#[test]
fn bad_points_are_refused() {
    let Some(gpu) = gpu() else { return };
    let positions = storage(gpu, &[Vec3::ZERO; 4]);
    let visibilities = storage(gpu, &[0.0f32; 4]);
    let unusable = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test points"),
        size: 48,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    let good = PointReceivers::new(4, PointBuffer::packed(&positions), bounds);
    let light = lamp(LightShape::Disk { radius_m: 0.2 });
    let refuse = |receivers: PointReceivers<'_>, visibilities: &wgpu::Buffer, channels, words: &[&str]| {
        let frame = PointFrame { light: &light, casters: Casters::Meshes(&[]), receivers, visibilities, channels };
        let error = create(gpu, TechniqueKind::Hard, &[]).prepare_points(&frame).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)) && !error.contains('\n'), "{error}");
    };
    let bad = |receivers, words: &[&str]| refuse(receivers, &visibilities, MaskChannels::One, words);
    bad(PointReceivers { count: 0, ..good }, &["number of points", "at least 1"]);
    bad(PointReceivers { count: 5, ..good }, &["positions", "48 bytes long", "at least 60"]);
    bad(PointReceivers { row_length: Some(0), ..good }, &["row_length"]);
    bad(PointReceivers { row_length: Some(100_000), ..good }, &["rows of 100000", "rows of 8192"]);
    bad(PointReceivers { positions: PointBuffer::packed(&unusable), ..good }, &["positions", "STORAGE"]);
    bad(PointReceivers { normals: Some(PointBuffer::packed(&unusable)), ..good }, &["normals", "STORAGE"]);
    bad(
        PointReceivers { normals: Some(PointBuffer { offset: 2, ..good.positions }), ..good },
        &["normals", "multiples of 4"],
    );
    bad(
        PointReceivers { positions: PointBuffer { stride: 8, ..good.positions }, ..good },
        &["positions", "stride of at least 12"],
    );
    bad(PointReceivers { positions: PointBuffer::packed(&visibilities), count: 1, ..good }, &["another buffer"]);
    bad(PointReceivers { widths: PointWidths::Same(-1.0), ..good }, &["width", "at least 0"]);
    bad(PointReceivers { widths: PointWidths::Same(f32::NAN), ..good }, &["width", "at least 0"]);
    bad(PointReceivers { widths: PointWidths::Each(PointBuffer::packed(&unusable)), ..good }, &["widths", "STORAGE"]);
    bad(PointReceivers { bounds: Aabb { min: Vec3::NAN, max: Vec3::ONE }, ..good }, &["box", "not a number"]);
    bad(PointReceivers { bounds: Aabb::EMPTY, ..good }, &["box", "empty"]);
    bad(PointReceivers { hull: &[Vec3::ZERO, Vec3::NAN], ..good }, &["`hull`", "point 1"]);
    bad(PointReceivers { seen: &[Vec3::INFINITY], ..good }, &["`seen`", "point 0"]);
    refuse(good, &unusable, MaskChannels::One, &["visibilities", "STORAGE"]);
    refuse(good, &visibilities, MaskChannels::Three, &["visibilities", "16 bytes long", "at least 48"]);

    let mut shadow = create(gpu, TechniqueKind::Pcss, &[]);
    shadow.set_denoise(Some(Denoise::default()));
    let casters = Casters::Meshes(&[]);
    let frame = PointFrame {
        light: &light,
        casters,
        receivers: good,
        visibilities: &visibilities,
        channels: MaskChannels::One,
    };
    let error = shadow.prepare_points(&frame).unwrap_err().to_string();
    assert!(error.contains("`denoise`") && error.contains("no neighbouring pixels"), "{error}");
    shadow.set_denoise(None);
    shadow.prepare_points(&frame).expect("a good frame").record(&mut Recorder::new(
        &mut gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default()),
        None,
    ));
}

/// wgpu does not expose a buffer's device, and detects devices of one instance only on use.
#[test]
fn points_of_another_device_are_refused() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions::default();
    if gpu().is_none() {
        return;
    }
    let adapter = pollster::block_on(instance.request_adapter(&options)).expect("there is one");
    let [ours, other] = [(); 2].map(|()| {
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("it gives a device");
        Gpu::new(&device, &queue)
    });
    let positions = storage(&other, &[Vec3::ZERO; 4]);
    let visibilities = &storage(&ours, &[0.0f32; 4]);
    let receivers = PointReceivers::new(4, PointBuffer::packed(&positions), Aabb { min: Vec3::ZERO, max: Vec3::ONE });
    let light = &lamp(LightShape::Disk { radius_m: 0.2 });
    let casters = Casters::Meshes(&[]);
    let frame = PointFrame { light, casters, receivers, visibilities, channels: MaskChannels::One };
    let error = create(&ours, TechniqueKind::Hard, &[]).prepare_points(&frame).unwrap_err().to_string();
    assert!(error.contains("positions") && error.contains("of the light's device") && !error.contains('\n'), "{error}");
}

/// Each point has a texel, and as few texels are unused as tiles allow.
#[test]
fn points_fit_their_texels() {
    for count in [1, 63, 64, 65, 1000, 65_536, 1_000_003] {
        let size = size_of_points(count, None);
        let texels = size.element_product();
        assert!(texels >= count && texels - count < 64 * (size.x / 8) && size % 8 == UVec2::ZERO, "{count}: {size}");
    }
    assert_eq!(size_of_points(13, Some(5)), UVec2::new(5, 3));
}
