//! Prints the cost of trees and rays: `cargo test -p antumbra --lib -- --ignored --nocapture ray_traced::tests::measure`.

use antumbra_light::{Aabb, Light};
use glam::{Mat4, Quat, UVec2, Vec2, Vec3};

use crate::TechniqueKind;
use crate::casters::{Caster, CasterSet, Indices, Instances, Mesh, PositionFormat, Positions};
use crate::gpu::{Gpu, PassTimer, Recorder};
use crate::shadow::{AnyShadow, Casters, Frame};
use crate::testing::{Case, RECTANGLE, View, gpu, read_buffer};

/// Returns a ball with bumps, of 2 `rings`² triangles.
fn ball(rings: u32, bump: f32) -> (Vec<Vec3>, Vec<u32>) {
    let vertex = |i: u32| {
        let (row, column) = (i / (rings + 1), i % (rings + 1));
        let (u, v) = (column as f32 / rings as f32, row as f32 / rings as f32);
        let (across, up) = (std::f32::consts::TAU * u, std::f32::consts::PI * v);
        let radius = 1.0 + bump * (19.0 * across).sin() * (23.0 * up).sin();
        radius * Vec3::new(up.sin() * across.cos(), up.cos(), up.sin() * across.sin())
    };
    let positions = (0..(rings + 1) * (rings + 1)).map(vertex).collect();
    let quad = |i: u32| {
        let a = i / rings * (rings + 1) + i % rings;
        [a, a + 1, a + rings + 1, a + rings + 1, a + 1, a + rings + 2]
    };
    (positions, (0..rings * rings).flat_map(quad).collect())
}

/// Mesh in a caster set, whose vertices may change.
struct InSet {
    positions: wgpu::Buffer,
    indices: wgpu::Buffer,
    vertex_count: u32,
    index_count: u32,
}

impl InSet {
    fn new(gpu: &Gpu, (positions, indices): &(Vec<Vec3>, Vec<u32>)) -> Self {
        let buffer = |bytes: &[u8]| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("test mesh"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue().write_buffer(&buffer, 0, bytes);
            buffer
        };
        Self {
            positions: buffer(bytemuck::cast_slice(positions)),
            indices: buffer(bytemuck::cast_slice(indices)),
            vertex_count: positions.len() as u32,
            index_count: indices.len() as u32,
        }
    }

    fn mesh(&self) -> Mesh<'_> {
        Mesh {
            vertex_count: self.vertex_count,
            positions: Positions { buffer: &self.positions, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
            texture_coordinates: None,
            indices: Some(Indices {
                buffer: &self.indices,
                format: wgpu::IndexFormat::Uint32,
                first_index: 0,
                count: self.index_count,
                base_vertex: 0,
            }),
            topology: wgpu::PrimitiveTopology::TriangleList,
            closed: false,
            bounds: Aabb { min: Vec3::splat(-1.2), max: Vec3::splat(1.2) },
        }
    }
}

/// Draws a frame of a set, and returns its steps' milliseconds.
fn times(
    gpu: &Gpu,
    timer: &mut PassTimer,
    case: &Case,
    set: &CasterSet,
    technique: &mut AnyShadow,
) -> Vec<(&'static str, f64)> {
    case.with_frame(Casters::Set { set, layers: u32::MAX }, |frame: &Frame<'_>| {
        let work = technique.prepare(frame).expect("a good frame");
        timer.reset();
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        work.record(&mut Recorder::new(&mut encoder, Some(timer)));
        timer.resolve(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
        let times = timer.read(&read_buffer(gpu, timer.readback(), timer.readback_bytes()));
        times.into_iter().map(|time| (time.label, time.ms)).collect()
    })
}

fn update(gpu: &Gpu, set: &mut CasterSet) {
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    set.update(&mut Recorder::new(&mut encoder, None)).expect("a good set");
    gpu.queue().submit([encoder.finish()]);
}

fn case(gpu: &Gpu) -> Case {
    let light = Light::new(RECTANGLE, Vec3::new(0.0, 6.0, 0.0), Vec3::ZERO);
    let ground = crate::testing::Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
    Case::new(gpu, light, View::new(Vec3::new(0.5, 3.0, 5.0), Vec3::ZERO), vec![ground])
}

fn poses(count: u32, time: f32) -> Vec<Mat4> {
    let pose = |i: u32| {
        let (x, z) = ((i % 25) as f32 * 0.3 - 3.6, (i / 25) as f32 * 0.3 - 3.0);
        let turn = Quat::from_rotation_y(i as f32 + time);
        Mat4::from_scale_rotation_translation(
            Vec3::splat(0.1),
            turn,
            Vec3::new(x, 1.0 + 0.3 * (i as f32 + time).sin(), z),
        )
    };
    (0..count).map(pose).collect()
}

#[test]
#[ignore = "prints what is not judged"]
fn a_mesh_of_a_million_triangles() {
    let Some(gpu) = gpu() else { return };
    let case = case(gpu);
    let mut timer = PassTimer::new(gpu).expect("timestamps");
    let mesh = InSet::new(gpu, &ball(708, 0.02));
    let triangles = u64::from(mesh.index_count / 3);
    let mut set = CasterSet::new(gpu);
    let id = set.add_mesh(&mesh.mesh()).expect("room");
    let caster =
        set.add(&Caster::new(id, Instances::Matrices(&[Mat4::from_translation(1.5 * Vec3::Y)]))).expect("room");
    update(gpu, &mut set);
    let mut technique = TechniqueKind::RayTraced.create(gpu).expect("any device");
    technique.set("samples", "1").expect("a parameter");
    println!("{triangles} triangles: {:?}", times(gpu, &mut timer, &case, &set, &mut technique));
    let while_made = technique.memory_bytes();
    set.mesh_changed(id, &mesh.mesh()).expect("the same");
    update(gpu, &mut set);
    println!("fitted: {:?}", times(gpu, &mut timer, &case, &set, &mut technique));
    let while_fitted = technique.memory_bytes();
    set.set_layers(caster, 1).expect("there");
    update(gpu, &mut set);
    println!("kept: {:?}", times(gpu, &mut timer, &case, &set, &mut technique));
    let kept = technique.memory_bytes();
    println!(
        "bytes a triangle: {:.1} while made, {:.1} while fitted, {:.1} kept; its corners are 36, positions and indices {:.1}",
        while_made as f64 / triangles as f64,
        while_fitted as f64 / triangles as f64,
        kept as f64 / triangles as f64,
        (12 * u64::from(mesh.vertex_count) + 4 * u64::from(mesh.index_count)) as f64 / triangles as f64,
    );
    assert!(kept < 72 * triangles, "{kept}");
}

#[test]
#[ignore = "prints what is not judged"]
fn a_frame_of_five_hundred_instances_and_a_skinned_mesh() {
    let Some(gpu) = gpu() else { return };
    let case = case(gpu);
    let mut timer = PassTimer::new(gpu).expect("timestamps");
    let small = InSet::new(gpu, &ball(16, 0.1));
    let skinned = InSet::new(gpu, &ball(158, 0.02));
    let mut set = CasterSet::new(gpu);
    let small_id = set.add_mesh(&small.mesh()).expect("room");
    let skinned_id = set.add_mesh(&skinned.mesh()).expect("room");
    let many = set.add(&Caster::new(small_id, Instances::Matrices(&poses(500, 0.0)))).expect("room");
    set.add(&Caster::new(skinned_id, Instances::Matrices(&[Mat4::from_translation(1.5 * Vec3::Y)]))).expect("room");
    let mut rays = TechniqueKind::RayTraced.create(gpu).expect("any device");
    let mut hard = TechniqueKind::Hard.create(gpu).expect("any device");
    for frame in 0..6 {
        set.set_instances(many, Instances::Matrices(&poses(500, 0.1 * frame as f32))).expect("as many");
        let bent = ball(158, 0.02 + 0.01 * frame as f32).0;
        gpu.queue().write_buffer(&skinned.positions, 0, bytemuck::cast_slice(&bent));
        set.mesh_changed(skinned_id, &skinned.mesh()).expect("the same size");
        update(gpu, &mut set);
        let before = gpu.objects_created();
        let of_rays = times(gpu, &mut timer, &case, &set, &mut rays);
        let of_hard = times(gpu, &mut timer, &case, &set, &mut hard);
        println!("frame {frame}: {of_rays:.3?}; hard: {of_hard:.3?}");
        if frame > 3 {
            assert_eq!(gpu.objects_created(), before, "objects made in a steady frame");
        }
    }
}

#[test]
#[ignore = "prints what is not judged"]
fn rays_a_second() {
    let Some(gpu) = gpu() else { return };
    let case = case(gpu);
    let mut timer = PassTimer::new(gpu).expect("timestamps");
    for (name, rings, count) in [("a ball of 50 000", 158, 1), ("500 of 512", 16, 500)] {
        let mesh = InSet::new(gpu, &ball(rings, 0.05));
        let mut set = CasterSet::new(gpu);
        let id = set.add_mesh(&mesh.mesh()).expect("room");
        let one = [Mat4::from_translation(1.5 * Vec3::Y)];
        let many = poses(count, 0.0);
        set.add(&Caster::new(id, Instances::Matrices(if count == 1 { &one } else { &many }))).expect("room");
        update(gpu, &mut set);
        let mut rays = TechniqueKind::RayTraced.create(gpu).expect("any device");
        let size: UVec2 = crate::testing::SIZE;
        for turn in 0..3 {
            // Another seed, so that the frame is not cached.
            rays.set("seed", &turn.to_string()).expect("a parameter");
            let times = times(gpu, &mut timer, &case, &set, &mut rays);
            let ms = times.iter().find(|(label, _)| *label == "trace").expect("traced").1;
            println!("{name}: {:.2} million rays a second", 1e-3 * 64.0 * f64::from(size.element_product()) / ms);
        }
    }
}
