//! The CPU reference against results known by hand, then the GPU against the CPU reference, fragment for fragment.

use antumbra_light::{Aabb, Light, LightShape, hash_u32, unit_f32};
use glam::{UVec2, Vec2, Vec3};

use super::TexelLists;
use super::cpu::{ReferenceFragment, ReferenceMesh, covered_lists, lists};
use super::options::{Accumulation, DepthTolerance, Gather, ListOptions};
use crate::contract::{MeshCaster, Opacity, SurfaceCoverage, SurfaceTexture};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::central_view::fit_light_view;
use crate::light_map::light_view::LightView;
use crate::testing::{Mesh, gpu, read_storage};

const MAP_SIZE: UVec2 = UVec2::new(96, 72);

/// Index of the middle texel's list.
const MIDDLE: usize = ((MAP_SIZE.y / 2) * MAP_SIZE.x + MAP_SIZE.x / 2) as usize;

/// Geometry of one surface, for CPU reference and GPU.
pub(crate) struct TestMesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<u32>,
    pub(crate) closed: bool,
    /// Coverage of the surface; blue light passes in any case, so that lists are coloured.
    pub(crate) opacity: f32,
}

impl TestMesh {
    pub(crate) fn cpu_reference(&self) -> ReferenceMesh<'_> {
        ReferenceMesh {
            positions: &self.positions,
            indices: &self.indices,
            closed: self.closed && self.opacity == 1.0,
            opacity: self.opacity,
        }
    }

    pub(crate) fn caster<'a>(&self, mesh: &'a Mesh) -> MeshCaster<'a> {
        let opacity = if self.opacity == 1.0 {
            Opacity::Opaque
        } else {
            let coverage = SurfaceCoverage::Alpha(self.opacity);
            Opacity::Translucent { coverage, transmitted: Vec3::Z, texture: None }
        };
        MeshCaster { closed: self.closed, opacity, ..mesh.caster() }
    }

    /// A box, wound counter-clockwise from outside.
    pub(crate) fn boxed(low: Vec3, high: Vec3, opacity: f32) -> Self {
        let positions = Aabb { min: low, max: high }.corners().to_vec();
        // Corner i has the high x, y, z where its bits 0, 1, 2 are set.
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let indices = quads.iter().flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]]).collect();
        Self { positions, indices, closed: true, opacity }
    }

    /// Horizontal squares over one another, slightly apart.
    fn sheets(count: u32, half: f32, lowest: f32, gap: f32) -> Self {
        let positions = (0..count).flat_map(|i| {
            let y = lowest + gap * i as f32;
            [(-half, -half), (-half, half), (half, half), (half, -half)].map(|(x, z)| Vec3::new(x, y, z))
        });
        let indices = (0..count).flat_map(|i| [0, 1, 2, 0, 2, 3].map(|k| 4 * i + k));
        Self { positions: positions.collect(), indices: indices.collect(), closed: false, opacity: 1.0 }
    }

    /// Random triangles in a box.
    fn soup(count: u32) -> Self {
        let unit = |i| unit_f32(hash_u32(i));
        let at =
            |i: u32| Vec3::new(4.0 * unit(i) - 2.0, 0.2 + 2.5 * unit(i ^ 0x9e37_79b9), 4.0 * unit(i ^ 0x51ed) - 2.0);
        Self {
            positions: (0..3 * count).map(at).collect(),
            indices: (0..3 * count).collect(),
            closed: false,
            opacity: 1.0,
        }
    }
}

/// Three scenes: boxes and a half-transparent one in a perspective view, random triangles, and towers of 16 and of 300
/// sheets in an orthographic view.
pub(crate) fn scenes() -> Vec<(&'static str, Light, Vec<TestMesh>)> {
    let lamp = Light::new(
        LightShape::Rectangle { size_m: glam::Vec2::splat(0.5) },
        Vec3::new(0.7, 5.0, 0.4),
        Vec3::new(0.1, 0.0, -0.1),
    );
    let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.05 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
    let ground = || TestMesh::boxed(Vec3::new(-3.0, -0.2, -3.0), Vec3::new(3.0, 0.0, 3.0), 1.0);
    vec![
        (
            "boxes",
            lamp.clone(),
            vec![
                ground(),
                TestMesh::boxed(Vec3::new(-1.0, 0.5, -0.5), Vec3::new(0.3, 1.1, 0.6), 1.0),
                TestMesh::boxed(Vec3::new(-0.2, 1.5, -0.9), Vec3::new(1.2, 1.6, 0.1), 0.5),
            ],
        ),
        ("soup", lamp, vec![ground(), TestMesh::soup(150)]),
        ("towers", sun, vec![ground(), TestMesh::sheets(300, 0.31, 0.5, 0.004), TestMesh::sheets(16, 1.13, 2.0, 0.05)]),
    ]
}

pub(crate) fn view_of(light: &Light, meshes: &[TestMesh]) -> LightView {
    let bounds: Vec<Aabb> = meshes.iter().map(|mesh| Aabb::of(mesh.positions.iter().copied())).collect();
    fit_light_view(light, &bounds, &[])
}

/// Unpacks a list read back from the GPU, of one channel or of three equal ones.
pub(crate) fn unpack(fragments: &[[u32; 2]], list: [u32; 2], colored: bool) -> Vec<ReferenceFragment> {
    let fragments = &fragments[list[0] as usize..(list[0] + list[1]) as usize];
    let of = |[z_m, bits]: &[u32; 2]| {
        let (opacity, behind) = if colored {
            (rgb8e4(*bits)[0], (bits >> 28) as f32 / 14.0)
        } else {
            (f32::from_bits(bits & !0xfff), (bits & 0xfff) as f32 / 4094.0)
        };
        ReferenceFragment { z_m: f32::from_bits(*z_m), opacity, overlap: behind / (1.0 - behind).max(1.0 / 4094.0) }
    };
    fragments.iter().map(of).collect()
}

/// Three opacities of 8 bits and a shared exponent.
fn rgb8e4(bits: u32) -> [f32; 3] {
    [0, 8, 16].map(|at| (bits >> at & 255) as f32 * ((bits >> 24 & 15) as f32 - 22.0).exp2())
}

/// Whether two lists hold the same fragments, up to rounding; overlaps have four bits, and matter less for small opacities.
pub(crate) fn agree(a: &[ReferenceFragment], b: &[ReferenceFragment], tolerance: f32) -> bool {
    let behind = |fragment: &ReferenceFragment| fragment.overlap / (1.0 + fragment.overlap);
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| {
            (a.z_m - b.z_m).abs() <= tolerance * b.z_m.abs().max(1.0)
                && (a.opacity - b.opacity).abs() <= tolerance
                && (behind(a) - behind(b)).abs() * b.opacity.min(0.5) <= 0.02 + tolerance
        })
}

fn gpu_lists(light: &Light, meshes: &[TestMesh], options: &ListOptions) -> Option<Vec<Vec<ReferenceFragment>>> {
    let gpu = gpu()?;
    let on_gpu: Vec<Mesh> = meshes.iter().map(|mesh| Mesh::new(gpu, &mesh.positions, &mesh.indices)).collect();
    let casters: Vec<_> = meshes.iter().zip(&on_gpu).map(|(mesh, on_gpu)| mesh.caster(on_gpu)).collect();
    let mut block = TexelLists::new(gpu);
    let prepared = block.prepare(&Stage::at_once(gpu), &view_of(light, meshes), &casters, options);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    block.record(&mut Recorder::new(&mut encoder, None), &casters, &prepared);
    gpu.queue().submit([encoder.finish()]);
    let fragments: Vec<[u32; 2]> = read_storage(gpu, &prepared.fragments);
    let lists: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists);
    let counters: Vec<u32> = read_storage(gpu, &prepared.counters);
    if options.layers == 0 && options.join.is_none() && options.samples == 1 {
        let stored: u32 = lists.iter().map(|list| list[1]).sum();
        assert_eq!(stored, counters[0].min(options.capacity));
        assert_eq!(counters[1].min(options.capacity), stored, "the lists are packed");
    }
    Some(lists.iter().map(|list| unpack(&fragments, *list, options.colored)).collect())
}

fn options(gather: Gather, colored: bool) -> ListOptions {
    ListOptions {
        map_size: MAP_SIZE,
        max_texels: MAP_SIZE.element_product(),
        capacity: 1 << 20,
        list_count: MAP_SIZE.element_product(),
        owners_bytes: 0,
        colored,
        layers: 0,
        join: None,
        all_faces: false,
        open_offset: DepthTolerance { slope: 0.0, m: 0.0 },
        accumulation: Accumulation::Multiply,
        gather,
        samples: 1,
        adjoin: DepthTolerance { slope: 0.0, m: 0.0 },
    }
}

#[test]
fn cpu_reference_sees_what_is_there() {
    let (_, light, meshes) = scenes().swap_remove(2);
    let view = view_of(&light, &meshes);
    let cpu_reference: Vec<_> = meshes.iter().map(TestMesh::cpu_reference).collect();
    let lists = lists(&view, MAP_SIZE, &cpu_reference);
    // Straight down on the middle: 16 sheets, then 300, then the ground's lower face, from the far side.
    let middle = &lists[MIDDLE];
    assert_eq!(middle.len(), 317);
    let height = |fragment: &ReferenceFragment| view.frame.center.y - fragment.z_m;
    assert!((height(&middle[0]) - 2.75).abs() < 1e-4 && (height(&middle[316]) + 0.2).abs() < 1e-4);
    // Beside the deep tower 16 sheets, beside both the ground alone.
    let counts: std::collections::BTreeSet<_> = lists.iter().map(Vec::len).collect();
    assert_eq!(counts.into_iter().filter(|n| *n > 0).collect::<Vec<_>>(), [1, 17, 317]);
}

#[test]
fn gpu_equals_cpu_reference_fragment_for_fragment() {
    for (name, light, meshes) in scenes() {
        let view = view_of(&light, &meshes);
        let cpu_reference: Vec<_> = meshes.iter().map(TestMesh::cpu_reference).collect();
        let want = lists(&view, MAP_SIZE, &cpu_reference);
        for (gather, colored) in [(Gather::Arrays, false), (Gather::Arrays, true), (Gather::Linked, false)] {
            let Some(got) = gpu_lists(&light, &meshes, &options(gather, colored)) else { return };
            // On steep triangles, depth is as exact as the snapping of vertices, 1/256 texel.
            let differing = want.iter().zip(&got).filter(|(want, got)| !agree(want, got, 2e-3)).count();
            println!("{name}, {gather:?}, colored {colored}: {differing} of {} lists differ", want.len());
            // Vertices are snapped after transforms whose last bits differ.
            assert!(differing * 500 <= want.len(), "{name}, {gather:?}: {differing} lists differ");
        }
    }
}

/// If the two passes over the geometry see different fragments, as compilers may cause, each list stays within its own range.
#[test]
fn what_was_not_counted_is_in_no_list() {
    let Some(gpu) = gpu() else { return };
    let (_, light, meshes) = scenes().swap_remove(0);
    let on_gpu: Vec<Mesh> = meshes.iter().map(|mesh| Mesh::new(gpu, &mesh.positions, &mesh.indices)).collect();
    let casters: Vec<_> = meshes.iter().zip(&on_gpu).map(|(mesh, on_gpu)| mesh.caster(on_gpu)).collect();
    let options = options(Gather::Arrays, false);
    let lists_of = |counted: &[MeshCaster<'_>], collected: &[MeshCaster<'_>]| {
        let mut block = TexelLists::new(gpu);
        let prepared = block.prepare(&Stage::at_once(gpu), &view_of(&light, &meshes), &casters, &options);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        block.record_passes(&mut Recorder::new(&mut encoder, None), [counted, collected], &prepared);
        gpu.queue().submit([encoder.finish()]);
        let fragments: Vec<[u32; 2]> = read_storage(gpu, &prepared.fragments);
        let lists: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists);
        lists.iter().map(|list| unpack(&fragments, *list, false)).collect::<Vec<_>>()
    };
    // The ground comes first, so that its fragments take the counted room.
    let ground = lists_of(&casters[..1], &casters[..1]);
    assert!(ground.iter().filter(|list| !list.is_empty()).count() > 1000);
    for (counted, collected) in [(1, 3), (3, 1)] {
        let got = lists_of(&casters[..counted], &casters[..collected]);
        let differing = ground.iter().zip(&got).filter(|(want, got)| !agree(want, got, 0.0)).count();
        assert_eq!(differing, 0, "{counted} of {} casters counted, {collected} collected", casters.len());
    }
}

#[test]
fn cpu_reference_s_coverage_is_the_area_s() {
    let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.05 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
    let sheet = |half: f32| TestMesh::sheets(1, half, 1.0, 0.0);
    let view = view_of(&sun, &[sheet(3.0)]);
    let area = |half: f32| {
        let lists =
            covered_lists(&view, MAP_SIZE, &[sheet(half).cpu_reference()], DepthTolerance { slope: 0.0, m: 0.0 });
        let opacity: f32 = lists.iter().flatten().map(|fragment| fragment.opacity).sum();
        opacity * view.texel_in_plane(MAP_SIZE.x) * view.texel_in_plane(MAP_SIZE.y)
    };
    for half in [1.0f32, 1.013, 1.027, 1.04] {
        let (got, want) = (area(half), 4.0 * half * half);
        assert!((got / want - 1.0).abs() < 0.02, "{half}: {got} against {want}");
    }
}

/// Thin and steep surfaces, and two faces of a solid in one texel.
#[test]
fn coverage_equals_the_cpu_reference_s() {
    for (name, light, meshes) in scenes() {
        let view = view_of(&light, &meshes);
        // The wider side of a texel.
        let texel = view.texel_in_plane(MAP_SIZE.y);
        let adjoin = if light.is_distant() {
            DepthTolerance { slope: 0.0, m: texel }
        } else {
            DepthTolerance { slope: texel, m: 0.0 }
        };
        let cpu_reference: Vec<_> = meshes.iter().map(TestMesh::cpu_reference).collect();
        let want = covered_lists(&view, MAP_SIZE, &cpu_reference, adjoin);
        for (gather, colored) in [(Gather::Arrays, false), (Gather::Arrays, true), (Gather::Linked, false)] {
            let options = ListOptions { samples: 4, adjoin, ..options(gather, colored) };
            let Some(got) = gpu_lists(&light, &meshes, &options) else { return };
            let differing = want.iter().zip(&got).filter(|(want, got)| !agree(want, got, 2e-3)).count();
            println!("{name}, {gather:?}, colored {colored}: {differing} of {} lists differ", want.len());
            assert!(differing * 100 <= want.len(), "{name}, {gather:?}: {differing} lists differ");
            let partial = want.iter().flatten().filter(|fragment| fragment.opacity < 0.5).count();
            // The towers' edges lie between texels.
            assert!(partial > 50 || name == "towers", "{name} has edges: {partial}");
        }
    }
}

/// Two sheets at different heights that meet along a row of samples: each sample belongs to one sheet, so that together they cover
/// whole texels.
#[test]
fn samples_on_a_shared_edge_are_one_sheet_s() {
    let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.05 }, Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO);
    let ground = || TestMesh::boxed(Vec3::new(-3.0, -0.2, -3.0), Vec3::new(3.0, 0.0, 3.0), 1.0);
    let world_from_clip = view_of(&sun, &[ground()]).clip_from_world().inverse();
    let sheet = |low: Vec2, high: Vec2, height: f32| {
        let corners = [low, Vec2::new(low.x, high.y), high, Vec2::new(high.x, low.y)];
        let in_clip = |corner: Vec2| (2.0 * corner / MAP_SIZE.as_vec2() - 1.0) * Vec2::new(1.0, -1.0);
        let at = |corner| world_from_clip.project_point3(in_clip(corner).extend(0.5)).with_y(height);
        TestMesh { positions: corners.map(at).to_vec(), indices: vec![0, 1, 2, 0, 2, 3], closed: false, opacity: 1.0 }
    };
    // WebGPU's samples lie an eighth and three off the texel's middle.
    for edge in [30.125, 30.375, 30.625, 30.875] {
        let (before, beyond) = (Vec2::new(10.3, 10.3), Vec2::new(60.7, 50.2));
        let meshes =
            [ground(), sheet(before, Vec2::new(beyond.x, edge), 1.0), sheet(Vec2::new(before.x, edge), beyond, 1.5)];
        let view = view_of(&sun, &meshes);
        let Some(lists) = gpu_lists(&sun, &meshes, &ListOptions { samples: 4, ..options(Gather::Arrays, false) })
        else {
            return;
        };
        for x in 15..55 {
            let list = &lists[30 * MAP_SIZE.x as usize + x];
            let of_sheets = list.iter().filter(|fragment| view.frame.center.y - fragment.z_m > 0.5);
            let covered: f32 = of_sheets.map(|fragment| fragment.opacity).sum();
            assert!((covered - 1.0).abs() < 1e-3, "edge at {edge}, texel {x}: {covered} of it");
        }
    }
}

/// The plane of a side at a grazing angle to the light leaves the scene, and passes the light, within the texels at the
/// side's edge.
#[test]
fn edge_on_surfaces_keep_their_depth_range() {
    let (_, light, _) = scenes().swap_remove(0);
    let at = |i: u32| 0.11 * i as f32 - 1.4;
    let posts: Vec<_> = (0..24)
        .map(|i| Vec3::new(at(i), 0.0, at((7 * i) % 24)))
        .map(|low| TestMesh::boxed(low, low + Vec3::new(0.06, 4.0, 0.06), 1.0))
        .collect();
    let view = view_of(&light, &posts);
    let depths = posts.iter().flat_map(|post| &post.positions).map(|p| (*p - view.frame.center).dot(view.frame.axis));
    let (nearest, farthest) = depths.fold((f32::INFINITY, 0.0f32), |(low, high), z| (low.min(z), high.max(z)));
    for faces in [false, true] {
        let options = ListOptions { samples: 4, all_faces: faces, ..options(Gather::Arrays, false) };
        let Some(lists) = gpu_lists(&light, &posts, &options) else { return };
        let fragments: Vec<_> = lists.iter().flatten().collect();
        assert!(fragments.len() > 1000);
        let outside = fragments.iter().filter(|f| !(f.z_m > 0.999 * nearest && f.z_m < 1.001 * farthest)).count();
        assert_eq!(outside, 0, "of {} fragments", fragments.len());
    }
}

/// Light that a textured pane stops in each texel of the map that it covers. 47 repeats of the texture lie across some 96 texels.
fn stopped_by_pane(
    gpu: &Gpu,
    view: &wgpu::TextureView,
    opacity: impl Fn(SurfaceTexture<'_>) -> Opacity<'_>,
) -> Vec<[f32; 3]> {
    let (_, light, _) = scenes().swap_remove(2);
    let pane = TestMesh::sheets(1, 2.0, 1.0, 0.0);
    let on_gpu = Mesh::new(gpu, &pane.positions, &pane.indices);
    let from_light = view_of(&light, &[pane]);
    let uvs = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test uvs"),
        size: 32,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let corners = [[0.0f32, 0.0], [0.0, 47.0], [47.0, 47.0], [47.0, 0.0]];
    gpu.queue().write_buffer(&uvs, 0, bytemuck::cast_slice(&corners));
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        ..wgpu::SamplerDescriptor::default()
    });
    let opacity = opacity(SurfaceTexture { uvs: &uvs, view, sampler: &sampler });
    let casters = [MeshCaster { opacity, ..on_gpu.caster() }];
    let mut block = TexelLists::new(gpu);
    let prepared = block.prepare(&Stage::at_once(gpu), &from_light, &casters, &options(Gather::Arrays, true));
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    block.record(&mut Recorder::new(&mut encoder, None), &casters, &prepared);
    gpu.queue().submit([encoder.finish()]);
    let fragments: Vec<[u32; 2]> = read_storage(gpu, &prepared.fragments);
    let lists: Vec<[u32; 2]> = read_storage(gpu, &prepared.lists);
    lists.iter().filter(|list| list[1] == 1).map(|list| fragments[list[0] as usize][1]).map(rgb8e4).collect()
}

/// Masked and translucent panes with a texture far finer than the map stop the mean of their mip levels, the same
/// everywhere.
#[test]
fn minified_textures_stop_their_mean() {
    let Some(gpu) = gpu() else { return };
    let checkers = alpha_texture(gpu, 64, |level, x, y| match level {
        0 if (x + y).is_multiple_of(2) => 255,
        0 => 0,
        _ => 128,
    });
    let view = checkers.create_view(&wgpu::TextureViewDescriptor::default());
    // Half of the texels stop a half of red, and all of green and blue; of the mask, all.
    let tinted = stopped_by_pane(gpu, &view, |texture| Opacity::Translucent {
        coverage: SurfaceCoverage::Alpha(1.0),
        transmitted: Vec3::new(0.5, 0.0, 0.0),
        texture: Some(texture),
    });
    let masked = stopped_by_pane(gpu, &view, |texture| Opacity::Masked { texture, alpha_factor: 1.0, cutoff: 0.5 });
    for (what, stopped, want) in [("tinted", tinted, [0.25f32, 0.5, 0.5]), ("masked", masked, [0.5; 3])] {
        assert!(stopped.len() > 4000, "{what}: {} texels", stopped.len());
        for stopped in stopped {
            let differs = stopped.iter().zip(&want).any(|(got, want)| (got - want).abs() > 0.01);
            assert!(!differs, "{what}: {stopped:?}, not {want:?}");
        }
    }
}

/// A host that streams textures binds a view of the mip levels that it has. The others are not read.
#[test]
fn levels_outside_the_host_s_view_are_not_read() {
    let Some(gpu) = gpu() else { return };
    for level in [0, 1] {
        let texture = alpha_texture(gpu, 64, |of, _, _| if of == level { 255 } else { 0 });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        });
        let stopped =
            stopped_by_pane(gpu, &view, |texture| Opacity::Masked { texture, alpha_factor: 1.0, cutoff: 0.5 });
        assert!(stopped.len() > 4000, "level {level}: {} texels", stopped.len());
        assert!(stopped.iter().flatten().all(|part| *part > 0.99), "level {level}");
    }
}

/// White texture with a full mip chain, of the given alpha by level and texel.
fn alpha_texture(gpu: &Gpu, size: u32, alpha: impl Fn(u32, u32, u32) -> u8) -> wgpu::Texture {
    let levels = size.ilog2() + 1;
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test texture"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for level in 0..levels {
        let side = size >> level;
        let texels: Vec<u8> =
            (0..side * side).flat_map(|i| [255, 255, 255, alpha(level, i % side, i / side)]).collect();
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            &texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * side), rows_per_image: None },
            wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        );
    }
    texture
}

#[test]
fn pruned_and_joined_lists_are_what_they_should_be() {
    let (_, light, meshes) = scenes().swap_remove(2);
    let Some(all) = gpu_lists(&light, &meshes, &options(Gather::Arrays, false)) else { return };
    let pruned = gpu_lists(&light, &meshes, &ListOptions { layers: 2, ..options(Gather::Arrays, false) });
    for (all, pruned) in all.iter().zip(&pruned.expect("has a GPU")) {
        assert_eq!(&all[..all.len().min(2)], &pruned[..]);
    }
    // The 300 sheets span 1.2 m, the 16 their own 0.75 m, the ground's face is alone.
    let join = Some(DepthTolerance { slope: 0.0, m: 1.21 });
    let joined = gpu_lists(&light, &meshes, &ListOptions { join, ..options(Gather::Arrays, false) });
    let joined = joined.expect("has a GPU");
    let middle = &joined[MIDDLE];
    assert_eq!(middle.len(), 3, "{middle:?}");
    assert!(middle.iter().all(|fragment| fragment.opacity == 1.0));
}

#[test]
fn without_room_what_fits_is_kept() {
    let (_, light, meshes) = scenes().swap_remove(0);
    for gather in [Gather::Arrays, Gather::Linked] {
        // The packing assertions of `gpu_lists` hold for the rest.
        let small = ListOptions { capacity: 3000, ..options(gather, false) };
        let Some(lists) = gpu_lists(&light, &meshes, &small) else { return };
        assert_eq!(lists.iter().map(Vec::len).sum::<usize>(), 3000, "{gather:?}");
    }
}
