//! CPU cost of steady frames: eight lights of all shapes and five hundred casters, with moving lights, camera and some moving casters.
//!
//! `steady_frames_make_nothing` counts wgpu resources and heap bytes with small maps and images. `processor_time` prints
//! the time of preparing and recording with the techniques' default map sizes:
//! `cargo test --workspace --test steady_frames -- --ignored --nocapture`.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use antumbra::casters::{
    Caster, CasterId, CasterSet, Indices, Instances, Mesh, PositionFormat, Positions, Surface, Texture,
    TextureCoordinateFormat, TextureCoordinates,
};
use antumbra::{AnyShadow, Casters, Frame, Gpu, Mask, Receivers, Recorder, TechniqueKind};
use antumbra_lab::device::{DeviceError, DeviceOptions, LabDevice};
use antumbra_lab::gpu_scene::GpuScene;
use antumbra_lab::receivers::{Layer, ReceiverImages, ReceiverPass};
use antumbra_lab::technique_run::TechniqueChoice;
use antumbra_lab::view::View;
use antumbra_light::{EmissionTexture, Light, LightShape};
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::{Affine2, Mat4, UVec2, Vec2, Vec3};

/// The system's allocator with a count of the allocated bytes.
struct Counting;

static HELD_BYTES: AtomicI64 = AtomicI64::new(0);

/// Serialises the tests that count.
static COUNTING: Mutex<()> = Mutex::new(());

#[allow(unsafe_code, reason = "implementing GlobalAlloc requires unsafe code")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        HELD_BYTES.fetch_add(layout.size() as i64, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD_BYTES.fetch_sub(layout.size() as i64, Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const CASTERS: usize = 500;
const CUTOUTS: usize = 20;

fn device() -> Option<LabDevice> {
    match LabDevice::new(&DeviceOptions { adapter: None, wanted_features: Gpu::WANTED_FEATURES }) {
        Ok(lab) => Some(lab),
        Err(DeviceError::NoAdapter) => {
            antumbra_testing::skip_without_adapter();
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Five hundred objects of a street, some alpha-tested, and eight lights above.
struct Street {
    set: CasterSet,
    casters: Vec<(CasterId, Mat4)>,
    lights: Vec<Light>,
    images: ReceiverImages,
    view_from_world: Mat4,
    /// Source buffers of the set's meshes.
    _buffers: Vec<wgpu::Buffer>,
}

impl Street {
    fn new(lab: &LabDevice, gpu: &Gpu, size: UVec2) -> Self {
        let scene = load("builtin:street", &LoadOptions::default()).expect("a built-in scene");
        let setup = Setup::for_scene(&scene);
        let images = ReceiverPass::new(lab)
            .render(lab, &GpuScene::upload(lab, &scene), &setup.camera, size, Layer::FirstHits)
            .expect("a scene that can be seen");
        let mut set = CasterSet::new(gpu);
        let mut buffers = Vec::new();
        let mut upload = |bytes: &[u8]| {
            let buffer = lab.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("host's buffer"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::VERTEX,
                mapped_at_creation: false,
            });
            lab.queue.write_buffer(&buffer, 0, bytes);
            buffers.push(buffer.clone());
            buffer
        };
        let texture = white(lab);
        let mut casters = Vec::new();
        for (i, Object { positions, indices, matrix }) in objects(&scene).into_iter().enumerate() {
            let has_holes = i % (CASTERS / CUTOUTS) == 0;
            let bounds = antumbra_light::Aabb::of(positions.iter().copied());
            let (vertex_count, index_count) = (positions.len() as u32, indices.len() as u32);
            let uvs = upload(bytemuck::cast_slice(&vec![Vec2::ZERO; positions.len()]));
            let positions = upload(bytemuck::cast_slice(&positions));
            let indices = upload(bytemuck::cast_slice(&indices));
            let id = set
                .add_mesh(&Mesh {
                    vertex_count,
                    positions: Positions {
                        buffer: &positions,
                        offset: 0,
                        stride: 12,
                        format: PositionFormat::Float32x3,
                    },
                    texture_coordinates: has_holes.then_some(TextureCoordinates {
                        buffer: &uvs,
                        offset: 0,
                        stride: 8,
                        format: TextureCoordinateFormat::Float32x2,
                        transform: Affine2::IDENTITY,
                    }),
                    indices: Some(Indices {
                        buffer: &indices,
                        format: wgpu::IndexFormat::Uint32,
                        first_index: 0,
                        count: index_count,
                        base_vertex: 0,
                    }),
                    topology: wgpu::PrimitiveTopology::TriangleList,
                    closed: false,
                    bounds,
                })
                .expect("a good mesh");
            let surface = if has_holes {
                Surface::Masked { texture: texture.clone(), alpha_factor: 1.0, cutoff: 0.5 }
            } else {
                Surface::Opaque
            };
            let matrices = [matrix];
            let caster = Caster { surface, ..Caster::new(id, Instances::Matrices(&matrices)) };
            casters.push((set.add(&caster).expect("a good caster"), matrix));
        }
        let lights = lights(&setup.lights[0]);
        let view_from_world = images.receivers().view_from_world;
        Self { set, casters, lights, images, view_from_world, _buffers: buffers }
    }

    /// Moves every tenth caster, every light and the camera, and uploads the casters.
    fn step(&mut self, frame: u32, recorder: &mut Recorder<'_>) {
        let turn = 0.01 * frame as f32;
        for (id, matrix) in self.casters.iter().step_by(10) {
            let moved = [Mat4::from_translation(Vec3::new(turn.sin() * 0.05, 0.0, turn.cos() * 0.05)) * *matrix];
            self.set.set_instances(*id, Instances::Matrices(&moved)).expect("a good matrix");
        }
        for light in &mut self.lights {
            light.center.x += 0.002;
        }
        self.view_from_world *= Mat4::from_translation(Vec3::new(0.001, 0.0, 0.0));
        self.set.update(recorder).expect("a good set");
    }

    fn receivers(&self) -> Receivers<'_> {
        let mut receivers = self.images.receivers();
        receivers.view_from_world = self.view_from_world;
        receivers
    }
}

/// A part of the street with vertices of its own, as in hosts whose casters share none.
struct Object {
    positions: Vec<Vec3>,
    indices: Vec<u32>,
    matrix: Mat4,
}

/// Triangles per object. CPU time depends on the number of objects; few triangles keep the GPU fast.
const OBJECT_TRIANGLES: usize = 12;

/// Returns five hundred parts from all over the street.
fn objects(scene: &Scene) -> Vec<Object> {
    let placed = scene.instances.iter().map(|instance| (&scene.meshes[instance.mesh], instance.world_from_object));
    let parts: Vec<(&antumbra_scene::Mesh, &[u32], Mat4)> = placed
        .flat_map(|(mesh, matrix)| mesh.indices.chunks(3 * OBJECT_TRIANGLES).map(move |part| (mesh, part, matrix)))
        .collect();
    assert!(parts.len() >= CASTERS, "{} parts", parts.len());
    let part = |i: usize| {
        let (mesh, indices, matrix) = parts[i * parts.len() / CASTERS];
        Object {
            positions: indices.iter().map(|i| mesh.positions[*i as usize]).collect(),
            indices: (0..indices.len() as u32).collect(),
            matrix,
        }
    };
    (0..CASTERS).map(part).collect()
}

/// Eight lights of all shapes around the given one.
fn lights(first: &Light) -> Vec<Light> {
    let at = |i: usize| first.center + Vec3::new(0.4 * i as f32 - 1.4, 0.1 * i as f32, 0.0);
    let of = |i: usize, shape: LightShape| Light { shape, center: at(i), ..first.clone() };
    let positions_m = (0..6).map(|i| at(5) + 0.1 * i as f32 * Vec3::X).collect();
    let checks = EmissionTexture::gray(2, 2, vec![1.0, 0.25, 0.25, 1.0]);
    vec![
        of(0, LightShape::Rectangle { size_m: Vec2::new(1.0, 0.5) }),
        of(1, LightShape::Disk { radius_m: 0.4 }),
        of(2, LightShape::Sphere { radius_m: 0.3 }),
        of(3, LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.2, 0.3) }),
        of(4, LightShape::Sun { angular_diameter_rad: 0.02 }),
        of(5, LightShape::Points { positions_m }),
        Light { emission: Some(checks), ..of(6, LightShape::Rectangle { size_m: Vec2::splat(0.6) }) },
        of(7, LightShape::Sphere { radius_m: 0.05 }),
    ]
}

fn white(lab: &LabDevice) -> Texture {
    let texture = lab.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("white"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None };
    lab.queue.write_texture(texture.as_image_copy(), &[255; 4], layout, texture.size());
    Texture {
        view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
        sampler: lab.device.create_sampler(&wgpu::SamplerDescriptor::default()),
    }
}

/// Draws one frame of every light. Returns milliseconds for updating casters, preparing and recording.
fn frame(lab: &LabDevice, street: &mut Street, shadows: &mut [AnyShadow], masks: &[Mask], i: u32) -> [f64; 3] {
    let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut recorder = Recorder::new(&mut encoder, None);
    let ms_since = |began: Instant| began.elapsed().as_secs_f64() * 1e3;
    let began = Instant::now();
    street.step(i, &mut recorder);
    let casters_ms = ms_since(began);
    let (mut prepare_ms, mut record_ms) = (0.0, 0.0);
    let casters = Casters::Set { set: &street.set, layers: u32::MAX };
    let receivers = street.receivers();
    for ((shadow, light), mask) in shadows.iter_mut().zip(&street.lights).zip(masks) {
        let began = Instant::now();
        let work = shadow.prepare(&Frame { light, casters, receivers, mask }).expect("a good frame");
        prepare_ms += ms_since(began);
        let began = Instant::now();
        work.record(&mut recorder);
        record_ms += ms_since(began);
    }
    lab.queue.submit([encoder.finish()]);
    lab.check().expect("no error");
    [casters_ms, prepare_ms, record_ms]
}

fn shadows(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)], count: usize) -> Vec<AnyShadow> {
    let of_kind = settings.iter().filter(|(key, _)| kind.param_specs().iter().any(|spec| spec.key == *key));
    let make = |_| {
        let mut shadow = kind.create(gpu).expect("any device");
        of_kind.clone().for_each(|(key, value)| shadow.set(key, value).expect("in range"));
        shadow
    };
    (0..count).map(make).collect()
}

const KINDS: [TechniqueKind; 5] = [
    TechniqueKind::Pcss,
    TechniqueKind::Essm,
    TechniqueKind::MultiLayer,
    TechniqueKind::RayTraced,
    TechniqueKind::SampleBased,
];

#[test]
fn steady_frames_make_nothing() {
    let _alone = COUNTING.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(lab) = device() else { return };
    let size = UVec2::splat(32);
    let small = [("map_size", "64"), ("samples", "4"), ("search_samples", "4")];
    for kind in KINDS {
        let gpu = Gpu::new(&lab.device, &lab.queue);
        let mut street = Street::new(&lab, &gpu, size);
        let mut shadows = shadows(&gpu, kind, &small, street.lights.len());
        let masks: Vec<Mask> = street.lights.iter().map(|_| Mask::new(&lab.device, size)).collect();
        let mut counts = gpu.objects_created();
        let mut held = Vec::new();
        for i in 0..10 {
            frame(&lab, &mut street, &mut shadows, &masks, i);
            if i == 5 {
                counts = gpu.objects_created();
            }
            if i >= 5 {
                held.push(HELD_BYTES.load(Ordering::Relaxed));
            }
        }
        assert_eq!(gpu.objects_created(), counts, "{kind}");
        // Hash maps may grow occasionally, but not in every frame.
        let grown = held[held.len() - 1] - held[0];
        assert!(grown < 64 << 10, "{kind}: the heap grew by {grown} bytes over {} frames: {held:?}", held.len() - 1);
    }
}

/// Repeatedly creating, using and dropping a technique, as a parameter search does, leaves nothing on the heap.
#[test]
fn techniques_that_go_leave_nothing() {
    let _alone = COUNTING.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(lab) = device() else { return };
    let scene = antumbra_scene::builtin::build("overlap").unwrap();
    let setup = Setup::for_scene(&scene);
    let view = View::new(&lab, &scene, &setup, UVec2::splat(64)).unwrap();
    for kind in [TechniqueKind::Pcf, TechniqueKind::Pcss, TechniqueKind::Vsm, TechniqueKind::MultiLayer] {
        let mut held = Vec::new();
        for round in 0..6 {
            let settings = vec![("map_size".into(), (64 + 16 * (round % 2)).to_string())];
            let choice = TechniqueChoice::with_settings(kind, settings);
            view.draw(&mut view.create(&choice).unwrap(), 0, 1).unwrap();
            lab.check().unwrap();
            held.push(HELD_BYTES.load(Ordering::Relaxed));
        }
        let grown = held[5] - held[1];
        println!("{}: {grown} bytes more after four more", kind.name());
        assert!(grown < 16 << 10, "{}: {held:?}", kind.name());
    }
}

#[test]
#[ignore = "prints times, and takes minutes on software adapters"]
fn processor_time() {
    let Some(lab) = device() else { return };
    let size = UVec2::splat(64);
    for kind in KINDS {
        let gpu = Gpu::new(&lab.device, &lab.queue);
        let mut street = Street::new(&lab, &gpu, size);
        let mut shadows = shadows(&gpu, kind, &[], street.lights.len());
        let masks: Vec<Mask> = street.lights.iter().map(|_| Mask::new(&lab.device, size)).collect();
        let mut times: Vec<[f64; 3]> =
            (0..15).map(|i| frame(&lab, &mut street, &mut shadows, &masks, i)).skip(6).collect();
        let mut median = |of: fn(&[f64; 3]) -> f64| {
            times.sort_by(|a, b| of(a).total_cmp(&of(b)));
            of(&times[times.len() / 2])
        };
        println!(
            "{kind}: prepare + record {:.2} ms (prepare {:.2}, record {:.2}) for 8 lights and {CASTERS} casters; \
             casters' update {:.2} ms; {}",
            median(|t| t[1] + t[2]),
            median(|t| t[1]),
            median(|t| t[2]),
            median(|t| t[0]),
            lab.adapter.name
        );
    }
}
