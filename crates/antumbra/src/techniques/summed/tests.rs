//! What a pixel reads, counted, and the blocker search against a twin on the CPU that looks at every texel.

use antumbra_light::Light;
use antumbra_scene::{LoadOptions, Setup, load};
use glam::{UVec2, Vec2, Vec3};

use super::table_fit::RIM;
use super::{SoftFilter, SoftParams};
use crate::contract::{Casters, DepthConvention, DepthMapCaster, Frame, Mask, MaskChannels, Params, Receivers};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::central_view::fit_light_view;
use crate::light_map::light_view::LightViewGpu;
use crate::shaders;
use crate::techniques::TechniqueKind;
use crate::techniques::summed::essm::EssmParams;
use crate::testing::{Mesh, draw_depth, gpu, read_layer, read_texture, view_of};

const SIZE: UVec2 = UVec2::new(96, 54);

/// A built-in scene on the GPU, without its surfaces.
struct Staged {
    mesh: Mesh,
    setup: Setup,
    depth: wgpu::Texture,
}

impl Staged {
    fn new(gpu: &Gpu, spec: &str) -> Self {
        let scene = load(spec, &LoadOptions::default()).expect("a built-in scene");
        let setup = Setup::for_scene(&scene);
        let positions: Vec<Vec3> = scene.world_triangles().flat_map(|triangle| triangle.positions).collect();
        let indices: Vec<u32> = (0..positions.len() as u32).collect();
        let mesh = Mesh::new(gpu, &positions, &indices);
        let camera = &setup.camera;
        let depth = draw_depth(gpu, SIZE, camera.clip_from_view(SIZE) * camera.view_from_world(), &[mesh.caster()]);
        Self { mesh, setup, depth }
    }

    /// The mask of `essm`, a layer for each channel.
    fn run(
        &self,
        gpu: &Gpu,
        filter: &mut SoftFilter,
        light: &Light,
        casters: Casters<'_>,
        params: &EssmParams,
    ) -> Vec<Vec<f32>> {
        let mask = Mask::with_channels(gpu.device(), SIZE, MaskChannels::Three);
        let view = view_of(&self.depth);
        let receivers = Receivers {
            size_px: SIZE,
            origin_px: UVec2::ZERO,
            depth: &view,
            depth_convention: DepthConvention::Reversed,
            view_from_world: self.setup.camera.view_from_world(),
            clip_from_view: self.setup.camera.clip_from_view(SIZE),
            normals: None,
            bounds: None,
            hull: &[],
            seen: &[],
            version: None,
        };
        let frame = Frame { light, casters, receivers, mask: &mask };
        filter.prepare(&Stage::at_once(gpu), &frame, params.design(), &params.settings()).expect("a good frame");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        filter.record(&mut Recorder::new(&mut encoder, None), &frame);
        gpu.queue.submit([encoder.finish()]);
        (0..3).map(|layer| bytemuck::pod_collect_to_vec(&read_layer(gpu, mask.texture(), layer))).collect()
    }
}

/// `essm` with a resolve shader of its own or another.
fn essm(gpu: &Gpu, resolve: Option<&'static str>) -> SoftFilter {
    let mut filter = SoftFilter::new(gpu, TechniqueKind::Essm);
    filter.resolve = resolve;
    filter
}

fn params(settings: &[(&str, &str)]) -> EssmParams {
    let mut params = EssmParams::default();
    for (key, value) in settings {
        params.set("essm", key, value).expect("a good setting");
    }
    params
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0.0f32), |(sum, count), v| (sum + v, count + 1.0));
    sum / count.max(1.0)
}

/// However large the light, a pixel in the penumbra reads as much, once its kernel is wide enough to be cut into all of its
/// parts: the light eight times as large, from where kernels are some 15 texels wide.
#[test]
fn what_a_penumbra_pixel_reads_does_not_grow_with_the_light() {
    let Some(gpu) = gpu() else { return };
    let (mut plain, mut counting) = (essm(gpu, None), essm(gpu, Some(shaders::SOFT_RESOLVE_COUNT)));
    for spec in ["builtin:leaning-plank", "builtin:columns"] {
        let staged = Staged::new(gpu, spec);
        let meshes = [staged.mesh.caster()];
        for (map_size, scale) in [("1024", 1.0), ("2048", 0.5), ("4096", 0.25)] {
            let params = params(&[("map_size", map_size), ("kernel", "isotropic")]);
            // What a pixel reads, and how wide its kernel is.
            let mut of = |scale: f32| {
                let light = staged.setup.lights[0].scaled(scale);
                let lit = staged.run(gpu, &mut plain, &light, Casters::Meshes(&meshes), &params).swap_remove(0);
                let counted = staged.run(gpu, &mut counting, &light, Casters::Meshes(&meshes), &params);
                let soft: Vec<usize> = (0..lit.len()).filter(|i| (0.02..0.98).contains(&lit[*i])).collect();
                let [search, kernel, texels] = [0, 1, 2].map(|k: usize| mean(soft.iter().map(|i| counted[k][*i])));
                println!(
                    "{spec}, {map_size}², light times {scale}: {} pixels in penumbrae read {search:.0} for the search and \
                     {kernel:.0} for a kernel of {texels:.0} texels",
                    soft.len()
                );
                (search + kernel, texels)
            };
            let (small, large) = (of(scale), of(8.0 * scale));
            assert!(small.1 > 10.0 && large.1 > 6.0 * small.1, "{spec}: kernels of {} and {} texels", small.1, large.1);
            assert!((large.0 / small.0 - 1.0).abs() < 0.15, "{spec}, {map_size}: {} and {} reads", small.0, large.0);
        }
    }
}

/// The search over every texel: what its parts stand for.
struct Twin<'a> {
    view: LightViewGpu,
    stored: &'a [f32],
    size: u32,
    extent: Vec2,
    scales: u32,
}

fn columns_of(m: [f32; 4]) -> [Vec2; 2] {
    [Vec2::new(m[0], m[1]), Vec2::new(m[2], m[3])]
}

impl Twin<'_> {
    /// The mean g of what hides the light from a point of the ground, and how much does; `search_g` is the widest window's.
    fn blockers(&self, point: Vec3, search_g: f32) -> (f32, f32) {
        let view = &self.view;
        let p = point - view.origin_in_world;
        let [x, y, z] = [view.right_in_world, view.up_in_world, view.axis_in_world].map(|axis| p.dot(axis));
        let [right, up] = columns_of(view.uv_from_plane);
        let [across, down] = columns_of(view.plane_from_uv);
        let texels = self.size as f32;
        let center = texels * (view.uv_origin + right * (x / z) + up * (y / z));
        let half_at_1 = texels * (right.abs() * self.extent.x + up.abs() * self.extent.y);
        // 1/Z over the map, of the ground's plane y = 0: n · P = k.
        let n = Vec3::new(view.right_in_world.y, view.up_in_world.y, view.axis_in_world.y);
        let bias = 0.5 * view.texel_in_plane * z / p.length();
        let k = -view.origin_in_world.y * (1.0 - bias);
        let (mut share_sum, mut g_sum) = (0.0f64, 0.0f64);
        for scale in 0..self.scales {
            let s = (scale as f32 + 0.5) / self.scales as f32;
            let half = (half_at_1 * RIM * search_g * s * s).max(Vec2::ONE);
            let low = (center - half).max(Vec2::ZERO);
            let high = (center + half).min(Vec2::splat(texels));
            let area = f64::from(4.0 * half.x * half.y);
            for row in low.y as u32..high.y.ceil() as u32 {
                let height = high.y.min(row as f32 + 1.0) - low.y.max(row as f32);
                for column in low.x as u32..high.x.ceil() as u32 {
                    let width = high.x.min(column as f32 + 1.0) - low.x.max(column as f32);
                    let stored = self.stored[(row * self.size + column) as usize];
                    let inverse_z = (stored - view.depth_offset) / view.depth_scale;
                    let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                    let uv = at / texels - view.uv_origin;
                    let plane = across * uv.x + down * uv.y;
                    let receiver = (n.x * plane.x + n.y * plane.y + n.z) / k;
                    let g = inverse_z - 1.0 / z;
                    let gauge = ((at - center) / half_at_1).abs().max_element();
                    if inverse_z > receiver.max(1.0 / z / (1.0 - bias)) && g > 0.0 && gauge <= RIM * g {
                        let share = f64::from(width * height) / area;
                        share_sum += share;
                        g_sum += share * f64::from(g);
                    }
                }
            }
        }
        ((g_sum / share_sum.max(1e-12)) as f32, share_sum as f32)
    }
}

/// The mean blocker's depth by ESM-Z on tables against every texel of the same windows, on the ground of built-in scenes.
#[test]
fn mean_blocker_depths_are_those_of_every_texel() {
    let Some(gpu) = gpu() else { return };
    const MAP: u32 = 1024;
    let params = params(&[("map_size", "1024")]);
    let mut filter = essm(gpu, Some(shaders::SOFT_RESOLVE_BLOCKERS));
    for (spec, bound) in [
        ("builtin:leaning-plank", 0.03),
        ("builtin:overlap", 0.03),
        ("builtin:columns", 0.03),
        ("builtin:stacked-panels", 0.03),
        ("builtin:window", 0.10),
    ] {
        let staged = Staged::new(gpu, spec);
        let light = &staged.setup.lights[0];
        let caster = staged.mesh.caster();
        let light_view = fit_light_view(light, &[caster.bounds], &[]);
        let map = draw_depth(gpu, UVec2::splat(MAP), light_view.clip_from_world(), &[caster]);
        let view = view_of(&map);
        let casters = Casters::DepthMap(DepthMapCaster {
            view: &view,
            size_px: UVec2::splat(MAP),
            clip_from_world: light_view.clip_from_world(),
            depth_convention: DepthConvention::Reversed,
        });
        let had = staged.run(gpu, &mut filter, light, casters, &params);
        let stored: Vec<f32> = bytemuck::pod_collect_to_vec(&read_texture(gpu, &map, 0, UVec2::splat(MAP)));
        let depth: Vec<f32> = bytemuck::pod_collect_to_vec(&read_texture(gpu, &staged.depth, 0, SIZE));
        let twin = Twin {
            view: light_view.to_gpu(MAP),
            stored: &stored,
            size: MAP,
            extent: crate::light_map::light_spread::LightSpread::of(light).extent,
            scales: params.search_scales,
        };
        let camera = &staged.setup.camera;
        let world_from_clip = (camera.clip_from_view(SIZE) * camera.view_from_world()).inverse();
        let mut errors = Vec::new();
        for i in (0..SIZE.x * SIZE.y).step_by(7) {
            let pixel = UVec2::new(i % SIZE.x, i / SIZE.x);
            let ndc = (pixel.as_vec2() + 0.5) / SIZE.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
            let depth = depth[i as usize];
            let point = world_from_clip.project_point3(ndc.extend(depth.max(1e-9)));
            let [g, search_g, share] = [0, 1, 2].map(|channel: usize| had[channel][i as usize]);
            if depth == 0.0 || point.y.abs() > 1e-3 || share <= 0.0 {
                continue;
            }
            let (exact_g, exact_share) = twin.blockers(point, search_g);
            if exact_share <= 0.0 {
                continue;
            }
            let d = (point - light.center).dot(light.frame().axis);
            let z_of = |g: f32| 1.0 / (g + 1.0 / d);
            errors.push((z_of(g) - z_of(exact_g)).abs() / (d - z_of(exact_g)));
        }
        errors.sort_by(f32::total_cmp);
        let at = |share: f32| errors[((errors.len() - 1) as f32 * share) as usize];
        println!("{spec}: |Δz| / (d − z) median {:.4}, 90 % {:.4}, of {} pixels", at(0.5), at(0.9), errors.len());
        assert!(errors.len() > 20, "{spec}: {} pixels", errors.len());
        assert!(at(0.5) <= bound, "{spec}: median {}", at(0.5));
    }
}
