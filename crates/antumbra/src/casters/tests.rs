use antumbra_light::LightShape;
use glam::{Affine2, Vec2, Vec3};

use super::*;
use crate::TechniqueKind;
use crate::gpu::Recorder;
use crate::shadow::{AnyShadow, Casters};
use crate::testing::{Case, Mesh as TestMesh, gpu, read_storage, run};

const RECTANGLE: LightShape = LightShape::Rectangle { size_m: Vec2::new(1.0, 0.6) };

fn host_buffer(gpu: &Gpu, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test host buffer"),
        size: bytes.len().next_multiple_of(4) as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut padded = bytes.to_vec();
    padded.resize(bytes.len().next_multiple_of(4), 0);
    gpu.queue.write_buffer(&buffer, 0, &padded);
    buffer
}

pub(crate) fn update(gpu: &Gpu, set: &mut CasterSet) {
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    set.update(&mut Recorder::new(&mut encoder, None)).expect("a good set");
    gpu.queue.submit([encoder.finish()]);
}

const POSITIONS: [Vec3; 5] = [
    Vec3::new(-1.0, 0.5, 0.25),
    Vec3::new(1.0, -0.5, 0.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(0.75, 0.125, 0.5),
    Vec3::new(-0.5, -1.0, 1.0),
];
const TRIANGLES: [u32; 6] = [0, 1, 2, 2, 3, 4];

fn bounds() -> Aabb {
    Aabb::of(POSITIONS)
}

/// Positions and texture coordinates that a set has packed, in the order of its indices.
fn packed(gpu: &Gpu, set: &CasterSet, id: MeshId) -> (Vec<Vec3>, Vec<Vec2>) {
    let mesh = &set.meshes[id];
    let arena = &set.vertices[usize::from(mesh.source.has_uvs())];
    let positions: Vec<f32> = read_storage(gpu, arena.buffer().expect("packed"));
    let uvs: Vec<f32> = arena.column(1).map_or_else(Vec::new, |uvs| read_storage(gpu, uvs));
    let indices: Vec<u32> = read_storage(gpu, set.indices.buffer().expect("packed"));
    let first = 3 * mesh.indices.start as usize;
    let indices = &indices[first..first + mesh.source.index_count() as usize];
    let uv = |i: u32| Vec2::from_slice(&uvs[2 * i as usize..]);
    (
        indices.iter().map(|i| Vec3::from_slice(&positions[3 * *i as usize..])).collect(),
        if uvs.is_empty() { Vec::new() } else { indices.iter().map(|i| uv(*i)).collect() },
    )
}

/// Mesh of a set, with its expected packed content and tolerance.
struct Packed {
    id: MeshId,
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    tolerance: f32,
}

impl Packed {
    fn is_held(&self, gpu: &Gpu, set: &CasterSet, i: usize) {
        let (had, had_uvs) = packed(gpu, set, self.id);
        assert_eq!(had.len(), self.positions.len(), "mesh {i}");
        assert!(had.iter().zip(&self.positions).all(|(a, b)| a.abs_diff_eq(*b, self.tolerance)), "mesh {i}: {had:?}");
        assert_eq!(had_uvs.len(), self.uvs.len(), "mesh {i}");
        assert!(had_uvs.iter().zip(&self.uvs).all(|(a, b)| a.abs_diff_eq(*b, 1e-6)), "mesh {i}: {had_uvs:?}");
    }
}

fn expected() -> Vec<Vec3> {
    TRIANGLES.iter().map(|i| POSITIONS[*i as usize]).collect()
}

/// Adds a mesh of interleaved vertices (twelve unused bytes, position, texture coordinates), with 16-bit indices that start
/// at index 3 and count vertices from 100.
fn add_interleaved(gpu: &Gpu, set: &mut CasterSet, usage: wgpu::BufferUsages) -> Packed {
    let interleaved: Vec<f32> = POSITIONS
        .iter()
        .enumerate()
        .flat_map(|(i, p)| [7.0, 7.0, 7.0, p.x, p.y, p.z, 0.1 * i as f32, 1.0 - 0.1 * i as f32])
        .collect();
    let interleaved = host_buffer(gpu, bytemuck::cast_slice(&interleaved), usage);
    let indices: Vec<u16> = [9, 9, 9].into_iter().chain(TRIANGLES.iter().map(|i| *i as u16 + 100)).collect();
    let indices = host_buffer(gpu, bytemuck::cast_slice(&indices), usage);
    let mesh = Mesh {
        vertex_count: 5,
        positions: Positions { buffer: &interleaved, offset: 12, stride: 32, format: PositionFormat::Float32x3 },
        texture_coordinates: Some(TextureCoordinates {
            buffer: &interleaved,
            offset: 24,
            stride: 32,
            format: TextureCoordinateFormat::Float32x2,
            transform: Affine2::from_scale_angle_translation(Vec2::new(2.0, 3.0), 0.0, Vec2::new(0.5, 0.0)),
        }),
        indices: Some(Indices {
            buffer: &indices,
            format: wgpu::IndexFormat::Uint16,
            first_index: 3,
            count: 6,
            base_vertex: -100,
        }),
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed: false,
        bounds: bounds(),
    };
    let uvs = TRIANGLES.iter().map(|i| Vec2::new(2.0 * 0.1 * *i as f32 + 0.5, 3.0 * (1.0 - 0.1 * *i as f32))).collect();
    Packed { id: set.add_mesh(&mesh).expect("a good mesh"), positions: expected(), uvs, tolerance: 0.0 }
}

/// Adds meshes of both integer formats, with 32-bit indices.
fn add_integers(gpu: &Gpu, set: &mut CasterSet, usage: wgpu::BufferUsages) -> [Packed; 2] {
    let (scale, offset) = (Vec3::new(2.0, 1.0, 4.0), Vec3::new(0.25, 0.0, -1.0));
    let components = || POSITIONS.iter().flat_map(|p| [p.x, p.y, p.z, 0.0]);
    let snorm: Vec<i16> = components().map(|v| (v * 32767.0) as i16).collect();
    let unorm: Vec<u16> = components().map(|v| ((0.5 * v + 0.5) * 65535.0) as u16).collect();
    let wide = host_buffer(gpu, bytemuck::cast_slice(&TRIANGLES), usage);
    [
        (bytemuck::cast_slice(&snorm), PositionFormat::Snorm16x4 { scale, offset }),
        (bytemuck::cast_slice(&unorm), PositionFormat::Unorm16x4 { scale: 2.0 * scale, offset: offset - scale }),
    ]
    .map(|(bytes, format)| {
        let mesh = Mesh {
            vertex_count: 5,
            positions: Positions { buffer: &host_buffer(gpu, bytes, usage), offset: 0, stride: 8, format },
            texture_coordinates: None,
            indices: Some(Indices {
                buffer: &wide,
                format: wgpu::IndexFormat::Uint32,
                first_index: 0,
                count: 6,
                base_vertex: 0,
            }),
            topology: wgpu::PrimitiveTopology::TriangleList,
            closed: false,
            bounds: bounds(),
        };
        let positions = expected().iter().map(|p| *p * scale + offset).collect();
        Packed { id: set.add_mesh(&mesh).expect("a good mesh"), positions, uvs: Vec::new(), tolerance: 2e-4 }
    })
}

/// Adds a mesh without indices: every three vertices are a triangle.
fn add_soup(gpu: &Gpu, set: &mut CasterSet, usage: wgpu::BufferUsages) -> Packed {
    let triangles: Vec<f32> = expected().iter().flat_map(|p| p.to_array()).collect();
    let soup = host_buffer(gpu, bytemuck::cast_slice(&triangles), usage);
    let mesh = Mesh {
        vertex_count: 6,
        positions: Positions { buffer: &soup, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
        texture_coordinates: None,
        indices: None,
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed: false,
        bounds: bounds(),
    };
    let id = set.add_mesh(&mesh).expect("a good mesh");
    Packed { id, positions: expected(), uvs: Vec::new(), tolerance: 0.0 }
}

/// Interleaved and separate, 32 and 16 bits, with and without indices, at any offset, in buffers that shaders can read and in
/// others: all are packed to the same triangles.
#[test]
fn every_format_is_packed_alike() {
    let Some(gpu) = gpu() else { return };
    let mut set = CasterSet::new(gpu);
    let mut meshes = Vec::new();
    for readable_by in [wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::COPY_SRC] {
        let usage = readable_by | wgpu::BufferUsages::VERTEX;
        meshes.push(add_interleaved(gpu, &mut set, usage));
        meshes.extend(add_integers(gpu, &mut set, usage));
        meshes.push(add_soup(gpu, &mut set, usage));
        update(gpu, &mut set);
    }
    meshes.iter().enumerate().for_each(|(i, mesh)| mesh.is_held(gpu, &set, i));
}

/// Returns the meshes of a test case in a set.
pub(crate) fn set_of(gpu: &Gpu, case: &Case) -> (CasterSet, Vec<CasterId>) {
    let mut set = CasterSet::new(gpu);
    let ids = case.meshes.iter().map(|mesh| {
        let id = set.add_mesh(&mesh_of(mesh)).expect("a good mesh");
        set.add(&Caster::new(id, Instances::Matrices(&[Mat4::IDENTITY]))).expect("a good caster")
    });
    let ids = ids.collect();
    (set, ids)
}

fn mesh_of(mesh: &TestMesh) -> Mesh<'_> {
    Mesh {
        vertex_count: (mesh.positions.size() / 12) as u32,
        positions: Positions { buffer: &mesh.positions, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
        texture_coordinates: None,
        indices: Some(Indices {
            buffer: &mesh.indices,
            format: wgpu::IndexFormat::Uint32,
            first_index: 0,
            count: mesh.index_count,
            base_vertex: 0,
        }),
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed: false,
        bounds: mesh.bounds,
    }
}

fn shadow(gpu: &Gpu, kind: TechniqueKind) -> AnyShadow {
    let mut shadow = kind.create(gpu).expect("any device");
    for (key, value) in [("map_size", "128"), ("view_size", "64"), ("samples", "8"), ("search_samples", "8")] {
        if kind.param_specs().iter().any(|spec| spec.key == key) {
            shadow.set(key, value).expect("in range");
        }
    }
    shadow
}

/// A set gives bit-identical masks to those from the host's own buffers.
#[test]
fn a_set_casts_as_its_meshes_do() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let (mut set, _) = set_of(gpu, &case);
    update(gpu, &mut set);
    let meshes: Vec<_> = case.meshes.iter().map(TestMesh::caster).collect();
    let kinds = [
        TechniqueKind::Hard,
        TechniqueKind::Pcss,
        TechniqueKind::Essm,
        TechniqueKind::Moment,
        TechniqueKind::MultiView,
        TechniqueKind::MultiLayer,
        TechniqueKind::ReprojectionLayered,
        TechniqueKind::AliasFree,
        TechniqueKind::SampleBased,
    ];
    for kind in kinds {
        let of =
            |casters| case.with_frame(casters, |frame| run(gpu, &mut shadow(gpu, kind), frame).expect("a good frame"));
        let (own, kept) = (of(Casters::Meshes(&meshes)), of(Casters::Set { set: &set, layers: u32::MAX }));
        assert!(own.iter().any(|v| *v < 0.1) && own.iter().any(|v| *v > 0.9), "{kind}: nothing to tell");
        assert!(own == kept, "{kind}");
    }
}

#[test]
fn casters_move_leave_and_hide() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let (mut set, ids) = set_of(gpu, &case);
    update(gpu, &mut set);
    let mut pcf = shadow(gpu, TechniqueKind::Pcf);
    let mut mask = |set: &CasterSet, layers| {
        case.with_frame(Casters::Set { set, layers }, |frame| run(gpu, &mut pcf, frame).expect("a good frame"))
    };
    let whole = mask(&set, u32::MAX);
    let ground = [case.meshes[0].caster()];
    let without = case.with_frame(Casters::Meshes(&ground), |frame| {
        run(gpu, &mut shadow(gpu, TechniqueKind::Pcf), frame).expect("a good frame")
    });
    assert_ne!(whole, without, "nothing to tell");
    // Put the occluder in a layer that the light does not see.
    set.set_layers(ids[0], 1).expect("there");
    set.set_layers(ids[1], 2).expect("there");
    update(gpu, &mut set);
    assert!(mask(&set, 1) == without);
    assert!(mask(&set, 3) == whole);
    // Move away, move back, remove.
    let away = [Mat4::from_translation(Vec3::new(100.0, 0.0, 0.0))];
    set.set_instances(ids[1], Instances::Matrices(&away)).expect("there");
    update(gpu, &mut set);
    assert!(mask(&set, u32::MAX) == without);
    set.set_instances(ids[1], Instances::Matrices(&[Mat4::IDENTITY])).expect("there");
    update(gpu, &mut set);
    assert!(mask(&set, u32::MAX) == whole);
    set.remove(ids[1]).expect("there");
    update(gpu, &mut set);
    assert!(mask(&set, u32::MAX) == without);
    assert!(set.set_layers(ids[1], 1).unwrap_err().to_string().contains("the caster is not in this set"));
}

/// Matrices from the CPU and from a host's buffer, as columns and as rows, are packed alike.
#[test]
fn instances_of_every_layout_are_alike() {
    let Some(gpu) = gpu() else { return };
    let matrices =
        [0.3f32, 1.7].map(|turn| Mat4::from_rotation_y(turn) * Mat4::from_translation(Vec3::new(turn, 2.0, 3.0)));
    let columns: Vec<f32> = matrices.iter().flat_map(|m| m.to_cols_array()).collect();
    let rows: Vec<f32> = matrices.iter().flat_map(|m| m.transpose().to_cols_array()[..12].to_vec()).collect();
    let behind = |floats: &[f32]| [&[0.0f32; 5], floats].concat();
    let mut set = CasterSet::new(gpu);
    let mesh = TestMesh::new(gpu, &POSITIONS, &TRIANGLES);
    let mesh = set.add_mesh(&mesh_of(&mesh)).expect("a good mesh");
    let mut ids = vec![set.add(&Caster::new(mesh, Instances::Matrices(&matrices))).expect("good")];
    for usage in [wgpu::BufferUsages::STORAGE, wgpu::BufferUsages::COPY_SRC] {
        for (floats, layout, stride) in
            [(&columns, InstanceLayout::Columns4x4, 64), (&rows, InstanceLayout::Rows3x4, 48)]
        {
            let buffer = host_buffer(gpu, bytemuck::cast_slice(&behind(floats)), usage);
            let instances =
                InstanceBuffer { buffer: &buffer, offset: 20, stride, layout, count: 2, bounds: Some(bounds()) };
            ids.push(set.add(&Caster::new(mesh, Instances::Buffer(instances))).expect("good"));
        }
    }
    update(gpu, &mut set);
    let packed: Vec<Mat4> = read_storage(gpu, set.instances.buffer().expect("packed"));
    for id in ids {
        let places = &set.casters[id].places;
        assert_eq!(packed[places.start as usize..places.end as usize], matrices, "{id:?}");
    }
}

#[test]
fn what_is_wrong_is_said() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let (mut set, ids) = set_of(gpu, &case);
    let error = case.with_frame(Casters::Set { set: &set, layers: u32::MAX }, |frame| {
        shadow(gpu, TechniqueKind::Pcf).prepare(frame).map(drop).unwrap_err()
    });
    assert!(error.to_string().contains("CasterSet::update"), "{error}");
    let mesh = &case.meshes[0];
    let good = mesh_of(mesh);
    let unread = host_buffer(gpu, &[0; 48], wgpu::BufferUsages::VERTEX);
    let of = |positions| Mesh { positions, ..good };
    let bad_meshes = [
        (of(Positions { buffer: &unread, ..good.positions }), "COPY_SRC"),
        (of(Positions { stride: 8, ..good.positions }), "a stride of at least 12"),
        (of(Positions { offset: 2, ..good.positions }), "multiples of 4"),
        (Mesh { vertex_count: 5, ..good }, "within the buffer"),
    ];
    for (mesh, needed) in bad_meshes {
        let error = set.add_mesh(&mesh).unwrap_err().to_string();
        assert!(error.contains(needed), "{error}");
    }
    let id = set.add_mesh(&good).expect("a good mesh");
    let nan = [Mat4::from_translation(Vec3::splat(f32::NAN))];
    assert!(set.add(&Caster::new(id, Instances::Matrices(&nan))).unwrap_err().to_string().contains("finite"));
    let used = set.casters[ids[0]].mesh;
    assert!(set.remove_mesh(used).unwrap_err().to_string().contains("remove these casters first"));
    set.remove_mesh(id).expect("nobody has it");
    assert!(set.remove_mesh(id).unwrap_err().to_string().contains("not in this set"));
}
