//! Tests of triangles that the light sees edge-on, by every path that gathers fragments. Their planes pass through all depths
//! within a texel, and rasterisers extrapolate.

use antumbra_light::{Light, LightShape};
use glam::{UVec2, Vec2, Vec3};

use super::TestMesh;
use crate::contract::{
    MapSize, Mask, MeshCaster, Opacity, PreparedCasters, PreparedFrame, SurfaceCoverage, SurfaceTexture,
};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::techniques::Technique;
use crate::techniques::multi_layer::{MultiLayer, MultiLayerParams, MultiLayerSamples};
use crate::testing::{Mesh, empty_depth, gpu, read_storage, test_receivers};

fn lamp() -> Light {
    Light::new(LightShape::Rectangle { size_m: Vec2::splat(0.5) }, Vec3::new(0.7, 5.0, 0.4), Vec3::new(0.1, 0.0, -0.1))
}

/// Sheets edge-on to the lamp, on the ground. Their planes pass its centre at some hundredths of a texel, to which rasterisers
/// snap, so that each is a sliver of the map, from near the lamp to near the ground.
fn fins() -> Vec<TestMesh> {
    let ground = TestMesh::boxed(Vec3::new(-3.0, -0.2, -3.0), Vec3::new(3.0, 0.0, 3.0), 1.0);
    let middle = lamp().center;
    let corners = (0..FINS).flat_map(|i| {
        let angle = std::f32::consts::TAU * i as f32 / FINS as f32;
        let (out, aside) = (Vec3::new(angle.cos(), 0.0, angle.sin()), Vec3::new(-angle.sin(), 0.0, angle.cos()));
        // At a tangent and a depth below the lamp; the farther end is offset sideways.
        let at = |tangent: f32, depth: f32| middle + depth * (tangent * out - Vec3::Y);
        let off = 1e-5 * (1 + i % 32) as f32 * aside;
        [at(0.1, 1.0), at(0.4, 1.0), at(0.4, 4.5) + off, at(0.1, 4.5) + off]
    });
    let fins = TestMesh {
        positions: corners.collect(),
        indices: (0..FINS).flat_map(|i| [0, 1, 2, 0, 2, 3].map(|k| 4 * i + k)).collect(),
        closed: false,
        opacity: 1.0,
    };
    vec![ground, fins]
}

/// Number of fins, large enough that some slivers cover the centre of a texel.
const FINS: u32 = 2000;

/// White texture for every caster: an alpha mask without holes.
struct White {
    uvs: wgpu::Buffer,
    view: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl White {
    fn new(gpu: &Gpu) -> Self {
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("test white"),
            size: wgpu::Extent3d::default(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None };
        gpu.queue().write_texture(texture.as_image_copy(), &[255; 4], layout, texture.size());
        Self {
            // Texture coordinates of every corner, all zero.
            uvs: buffer(gpu, 8 * 4 * u64::from(FINS), wgpu::BufferUsages::VERTEX),
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            sampler: gpu.device().create_sampler(&wgpu::SamplerDescriptor::default()),
        }
    }
}

fn buffer(gpu: &Gpu, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("test buffer"),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Returns positions in a buffer that shaders cannot read.
fn without_storage(gpu: &Gpu, mesh: &TestMesh) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(&mesh.positions);
    let positions = buffer(gpu, bytes.len() as u64, wgpu::BufferUsages::VERTEX);
    gpu.queue().write_buffer(&positions, 0, bytes);
    positions
}

/// Calls `test` for each path with the fins as that path draws them, its name, and the number of samples.
fn for_each_path(
    gpu: &Gpu,
    meshes: &[TestMesh],
    on_gpu: &[Mesh],
    test: impl Fn(&str, &[MeshCaster<'_>], MultiLayerSamples),
) {
    let white = White::new(gpu);
    let plain: Vec<_> = meshes.iter().map(|mesh| without_storage(gpu, mesh)).collect();
    let of_opacity = |opacity: Opacity<'static>| -> Vec<MeshCaster<'_>> {
        on_gpu.iter().map(|mesh| MeshCaster { opacity, ..mesh.caster() }).collect()
    };
    let opaque = of_opacity(Opacity::Opaque);
    test("one sample", &opaque, MultiLayerSamples::One);
    let coverage = SurfaceCoverage::Alpha(1.0);
    let blended = Opacity::Translucent { coverage, transmitted: Vec3::ZERO, texture: None };
    test("blended", &of_opacity(blended), MultiLayerSamples::Four);
    let texture = SurfaceTexture { uvs: &white.uvs, view: &white.view, sampler: &white.sampler };
    let masked: Vec<_> = on_gpu
        .iter()
        .map(|mesh| MeshCaster {
            opacity: Opacity::Masked { texture, alpha_factor: 1.0, cutoff: 0.5 },
            ..mesh.caster()
        })
        .collect();
    test("masked", &masked, MultiLayerSamples::Four);
    let unread: Vec<_> =
        opaque.iter().zip(&plain).map(|(caster, positions)| MeshCaster { positions, ..*caster }).collect();
    test("without storage", &unread, MultiLayerSamples::Four);
}

#[test]
fn fragments_lie_between_the_view_s_planes() {
    let Some(gpu) = gpu() else { return };
    let (light, meshes) = (lamp(), fins());
    let on_gpu: Vec<Mesh> = meshes.iter().map(|mesh| Mesh::new(gpu, &mesh.positions, &mesh.indices)).collect();
    let frame = light.frame();
    // Bounds of the casters, to which the view is fitted.
    let corners = on_gpu.iter().flat_map(|mesh| mesh.caster().bounds.corners());
    let (nearest, farthest) = corners
        .map(|corner| (corner - frame.center).dot(frame.axis))
        .fold((f32::INFINITY, 0.0f32), |(low, high), z_m| (low.min(z_m), high.max(z_m)));
    let size = UVec2::splat(16);
    let depth = empty_depth(gpu, size);
    let mask = Mask::new(gpu.device(), size);
    for_each_path(gpu, &meshes, &on_gpu, |path, casters, msaa| {
        let params = MultiLayerParams { map_size: MapSize::Texels(128), msaa, ..MultiLayerParams::default() };
        let mut technique = MultiLayer::new(gpu).expect("default limits");
        let frame = PreparedFrame {
            light: &light,
            casters: PreparedCasters::Draws(casters),
            receivers: test_receivers(size, &depth).into(),
            mask: &mask,
            noisy: None,
        };
        let prepared = technique.prepare(&Stage::at_once(gpu), &frame, &params).expect("a good frame");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        technique.record(&mut Recorder::new(&mut encoder, None), &frame, &prepared);
        gpu.queue().submit([encoder.finish()]);
        let fragments: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists.fragments);
        let lists: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists.lists);
        let base = prepared.levels[0].size.element_product() as usize;
        let depths: Vec<f32> = lists[..base]
            .iter()
            .flat_map(|[first, count]| &fragments[*first as usize..][..*count as usize])
            .map(|[z_m, _]| f32::from_bits(*z_m))
            .collect();
        assert!(depths.len() > 1000, "{path}");
        // The planes are padded by a thousandth, and open surfaces are moved by a fraction of a texel.
        let farthest = 1.002 * farthest * (1.0 + prepared.texel_in_plane);
        let outside = depths.iter().filter(|z_m| !(**z_m > 0.998 * nearest && **z_m < farthest)).count();
        assert_eq!(outside, 0, "{path}: of {} fragments", depths.len());
    });
}
