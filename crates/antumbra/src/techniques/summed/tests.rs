//! Tests of the number of reads per pixel, and of the blocker search against a CPU reference that reads every texel.

use std::f32::consts::{FRAC_PI_2, PI};
use std::path::Path;

use antumbra_light::{Light, LightShape, hash_u32, unit_f32};
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::{UVec2, Vec2, Vec3};

use super::table_fit::RIM;
use super::{SoftFilter, SoftParams};
use crate::contract::{
    DepthConvention, DepthMapCaster, MapSize, Mask, MaskChannels, Params, PreparedCasters, PreparedFrame, Receivers,
};
use crate::gpu::{Gpu, Recorder, Stage, shared_constants};
use crate::light_map::central_view::fit_light_view;
use crate::light_map::light_view::LightViewGpu;
use crate::shaders;
use crate::techniques::summed::cssm::CssmParams;
use crate::techniques::summed::essm::EssmParams;
use crate::techniques::summed::evssm::EvssmParams;
use crate::techniques::summed::mssm::MssmParams;
use crate::techniques::summed::savsm::SavsmParams;
use crate::techniques::summed::vssm::VssmParams;
use crate::testing::{Mesh, draw_depth, gpu, read_layer, read_texture, view_of};

const SIZE: UVec2 = UVec2::new(96, 54);

/// Built-in scene on the GPU, without materials.
struct Staged {
    mesh: Mesh,
    setup: Setup,
    depth: wgpu::Texture,
}

impl Staged {
    fn new(gpu: &Gpu, spec: &str) -> Self {
        let scene = load(spec, &LoadOptions::default()).expect("a built-in scene");
        let setup = Setup::for_scene(&scene);
        Self::with_setup(gpu, &scene, setup)
    }

    fn with_setup(gpu: &Gpu, scene: &Scene, setup: Setup) -> Self {
        let positions: Vec<Vec3> = scene.world_triangles().flat_map(|triangle| triangle.positions).collect();
        let indices: Vec<u32> = (0..positions.len() as u32).collect();
        let mesh = Mesh::new(gpu, &positions, &indices);
        let camera = &setup.camera;
        let depth = draw_depth(gpu, SIZE, camera.clip_from_view(SIZE) * camera.view_from_world(), &[mesh.caster()]);
        Self { mesh, setup, depth }
    }

    /// Returns the mask of a technique of the family, one layer per channel.
    fn run(
        &self,
        gpu: &Gpu,
        filter: &mut SoftFilter,
        light: &Light,
        casters: PreparedCasters<'_>,
        params: &impl SoftParams,
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
            shadow_distance: None,
            version: None,
        };
        let frame = PreparedFrame { light, casters, receivers: receivers.into(), mask: &mask, noisy: None };
        let prepared =
            filter.prepare(&Stage::at_once(gpu), &frame, params.design(), &params.settings()).expect("a good frame");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        filter.record(&mut Recorder::new(&mut encoder, None), &frame, &prepared);
        gpu.queue.submit([encoder.finish()]);
        (0..3).map(|layer| bytemuck::pod_collect_to_vec(&read_layer(gpu, mask.texture(), layer))).collect()
    }
}

/// Creates a technique of the family with its own resolve shader or another one.
fn filter_of<P: SoftParams>(gpu: &Gpu, resolve: Option<&'static str>) -> SoftFilter {
    let mut filter = SoftFilter::new(gpu, P::NAME);
    filter.test_shader = resolve;
    filter
}

/// Counter of the mean reads of penumbra pixels, and of the mean width of their kernels.
struct Counter {
    plain: SoftFilter,
    counting: SoftFilter,
}

struct Counted {
    search: f32,
    kernel: f32,
    texels: f32,
}

impl Counted {
    fn reads(&self) -> f32 {
        self.search + self.kernel
    }
}

impl Counter {
    fn new<P: SoftParams>(gpu: &Gpu) -> Self {
        Self { plain: filter_of::<P>(gpu, None), counting: filter_of::<P>(gpu, Some(shaders::SUMMED_RESOLVE_COUNT)) }
    }

    fn count(&mut self, gpu: &Gpu, staged: &Staged, light: &Light, params: &impl SoftParams) -> Counted {
        let meshes = [staged.mesh.caster()];
        let lit = staged.run(gpu, &mut self.plain, light, PreparedCasters::Draws(&meshes), params).swap_remove(0);
        let counted = staged.run(gpu, &mut self.counting, light, PreparedCasters::Draws(&meshes), params);
        let soft: Vec<usize> = (0..lit.len()).filter(|i| (0.02..0.98).contains(&lit[*i])).collect();
        let [search, kernel, texels] = [0, 1, 2].map(|k: usize| mean(soft.iter().map(|i| counted[k][*i])));
        println!(
            "{:?}: {} pixels in penumbrae read {search:.0} for the search and {kernel:.0} for a kernel of {texels:.0} texels",
            light.shape,
            soft.len()
        );
        Counted { search, kernel, texels }
    }
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

/// For any light, a penumbra pixel reads less than three times as often as `pcss` takes taps, and hardly more than under a
/// light an eighth as large, once kernels are some 15 texels wide. Pieces as wide as tiles contain more that their tables
/// cannot resolve.
#[test]
fn what_a_penumbra_pixel_reads_does_not_grow_with_the_light() {
    let Some(gpu) = gpu() else { return };
    let mut counter = Counter::new::<EssmParams>(gpu);
    let sizes = [("1024", 1.0), ("2048", 0.5), ("4096", 0.25)];
    for (spec, sizes) in [("builtin:leaning-plank", &sizes[..]), ("builtin:columns", &sizes[..2])] {
        let staged = Staged::new(gpu, spec);
        for (map_size, scale) in sizes.iter().copied() {
            let params = params(&[("map_size", map_size), ("kernel", "isotropic"), ("second_look", "false")]);
            println!("{spec}, {map_size}²");
            let mut of = |scale: f32| counter.count(gpu, &staged, &staged.setup.lights[0].scaled(scale), &params);
            let (small, large) = (of(scale), of(8.0 * scale));
            assert!(
                small.texels > 10.0 && large.texels > 6.0 * small.texels,
                "{spec}: kernels of {} and {} texels",
                small.texels,
                large.texels
            );
            let growth = large.reads() / small.reads();
            assert!((growth - 1.0).abs() < 0.25, "{spec}, {map_size}: {} and {} reads", small.reads(), large.reads());
            assert!(large.reads() < MAX_READS, "{spec}, {map_size}: {} reads", large.reads());
        }
    }
}

/// Maximum number of reads with one search. A second adds at most 150 to the search, and as many again to the kernel.
const MAX_READS: f32 = 270.0;

/// Reads do not grow under round lights either, where every pixel is penumbra. An ellipse's kernel reads no more than the
/// enclosing rectangle's. Covers one technique of exponentials and one of variances; the others use the same shader.
#[test]
fn reads_do_not_grow_under_round_lights() {
    let Some(gpu) = gpu() else { return };
    let staged = all_penumbra(gpu);
    reads_do_not_grow(gpu, &staged, &EssmParams { map_size: KERNELS_FROM_30, ..EssmParams::default() });
    reads_do_not_grow(gpu, &staged, &VssmParams { map_size: KERNELS_FROM_30, ..VssmParams::default() });
}

#[test]
#[ignore = "long"]
fn reads_do_not_grow_for_the_rest_of_the_family() {
    let Some(gpu) = gpu() else { return };
    let staged = all_penumbra(gpu);
    let map_size = KERNELS_FROM_30;
    reads_do_not_grow(gpu, &staged, &SavsmParams { map_size, ..SavsmParams::default() });
    reads_do_not_grow(gpu, &staged, &MssmParams { map_size, ..MssmParams::default() });
    reads_do_not_grow(gpu, &staged, &CssmParams { map_size, ..CssmParams::default() });
    reads_do_not_grow(gpu, &staged, &EvssmParams { map_size, ..EvssmParams::default() });
}

/// Side of maps, texels, at which kernels have at least 30 texels.
const KERNELS_FROM_30: MapSize = MapSize::Texels(1024);

fn all_penumbra(gpu: &Gpu) -> Staged {
    let scene = load("builtin:leaning-plank", &LoadOptions::default()).expect("a built-in scene");
    let setup = include_str!("../../../../../bench/setups/all_penumbra.toml");
    let setup = Setup::from_toml(setup, Path::new("all_penumbra.toml")).expect("a setup");
    Staged::with_setup(gpu, &scene, setup)
}

fn reads_do_not_grow<P: SoftParams>(gpu: &Gpu, staged: &Staged, params: &P) {
    println!("{}", P::NAME);
    let mut counter = Counter::new::<P>(gpu);
    let mut count = |shape: LightShape| {
        let light = Light { shape, ..staged.setup.lights[0].clone() };
        counter.count(gpu, staged, &light, params)
    };
    let square = count(LightShape::Rectangle { size_m: Vec2::splat(2.4) });
    for shape_of in [|radius_m| LightShape::Disk { radius_m }, |radius_m| LightShape::Sphere { radius_m }] {
        let counted = [0.6, 1.2, 2.4].map(|radius_m| count(shape_of(radius_m)));
        for (i, large) in counted.iter().enumerate() {
            let least = counted[..=i].iter().map(Counted::reads).fold(f32::MAX, f32::min);
            assert!(least > 10.0 && large.reads() <= 1.15 * least, "{}: {} after {least}", P::NAME, large.reads());
        }
        let round = &counted[1];
        assert!(round.kernel <= 1.15 * square.kernel, "{}: {} and {}", P::NAME, round.kernel, square.kernel);
    }
}

/// Compares the rows of an ellipse in `kernel_rows.wesl` with the ellipse: variances, and the penumbra of a straight edge.
#[test]
fn rows_of_an_ellipse_have_its_spread_and_its_penumbra() {
    for count in 1..=16 {
        let rows = EllipseRow::all(count);
        let area: f32 = rows.iter().map(EllipseRow::area).sum();
        let across = rows.iter().map(|row| row.area() * row.half * row.half / 3.0).sum::<f32>() / area;
        let along = rows.iter().map(|row| row.area() * row.mean_square()).sum::<f32>() / area;
        // The variance of a disk of radius 1 is a quarter.
        for (variance, name) in [(across, "across"), (along, "along")] {
            let spread = (4.0 * variance).sqrt();
            let bound = if count < 4 { 0.03 } else { 0.01 };
            assert!((spread - 1.0).abs() < bound, "{count} rows, {name} them: {spread}");
        }
        let off = [0.0, 0.25, 0.5, 0.75, 1.0].map(|turn| penumbra_error(&rows, turn * FRAC_PI_2));
        let rms = (off.iter().map(|e| e * e).sum::<f32>() / off.len() as f32).sqrt();
        println!("{count} rows: penumbrae off by {rms:.4}");
        if count >= 5 {
            assert!(rms < 0.003, "{count} rows: {rms}");
        }
    }
}

shared_constants! {
    const ROW_SPREAD: f32 = 1.2, as in SUMMED_RESOLVE;
    const ROW_SHORTER: f32 = 0.75, as in SUMMED_RESOLVE;
    const ROW_WIDER: f32 = 0.38, as in SUMMED_RESOLVE;
    const ROW_SHORTEST: f32 = 0.866_025_4, as in SUMMED_RESOLVE;
    const ROW_WIDEST: f32 = 1.09, as in SUMMED_RESOLVE;
    const GAUSS: f32 = 0.288_675_13, as in SUMMED_RESOLVE;
}

/// The loop over rows in `wide_lit` ends after as many iterations as there are rows, and one for each tile border: cuts lie
/// between texels, and rows that rounding makes empty are skipped.
#[test]
fn rows_of_an_ellipse_come_to_an_end() {
    for i in 0..200_000 {
        let random = |k: u32| unit_f32(hash_u32(5 * i + k));
        let tile = if i % 2 == 0 { 16.0 } else { 64.0 };
        let half = 1.0 + 40.0 * random(0) * random(1);
        let center = 100.0 + 64.0 * random(2);
        let count = (1 + i % 16).min(half.ceil() as u32);
        let (low, high) = (center - half, center + half);
        let mut rows = EllipseWalk { at: low, left: count as f32 };
        let mut turns = 0;
        while rows.at < high {
            let before = rows.at;
            rows.step(center, half, count as f32, tile);
            turns += 1;
            assert!(
                rows.at >= before && rows.at <= high + 0.5,
                "{count} rows about {center}, {half} high: at {}",
                rows.at
            );
            let most = count + (2.0 * half / tile) as u32 + 2;
            assert!(turns <= most, "{count} rows about {center}, half {half} high, tiles of {tile}: {turns}");
        }
    }
}

/// CPU reference of the loop: start of the next row, and number of rows left.
struct EllipseWalk {
    at: f32,
    left: f32,
}

impl EllipseWalk {
    fn step(&mut self, center: f32, half: f32, count: f32, tile: f32) {
        let place = 1.0 - 2.0 * (self.left - 1.0) / count;
        let height = center + half * ((ROW_SPREAD * place).sin() / ROW_SPREAD.sin()) - self.at;
        let high = center + half;
        let cut = if self.left <= 1.5 { high } else { (self.at + height).round() };
        let border = (self.at / tile).floor() * tile + tile;
        let is_border = border - self.at >= 1.0 && high - border >= 1.0 && border < cut + 0.5 * height;
        let next = if is_border { border } else { cut };
        let is_done = next <= self.at || next - self.at >= 0.5 * height;
        self.at = next;
        self.left = (self.left - if is_done { 1.0 } else { 0.0 }).max(1.0);
    }
}

/// Rectangle centred on x = 0.
struct EllipseRow {
    low: f32,
    high: f32,
    half: f32,
}

impl EllipseRow {
    /// Returns the rows of a disk of radius 1.
    fn all(count: u32) -> Vec<Self> {
        let per_square = 1.0 / (count * count) as f32;
        let wide = (1.0 + ROW_WIDER * per_square).min(ROW_WIDEST);
        let tall = (1.0 - ROW_SHORTER * per_square).max(ROW_SHORTEST);
        let end = |j: u32| tall * (ROW_SPREAD * (2.0 * j as f32 / count as f32 - 1.0)).sin() / ROW_SPREAD.sin();
        let half_at = |y: f32| wide * (1.0 - (y / tall).powi(2)).max(0.0).sqrt();
        let row = |j: u32| {
            let (low, high) = (end(j), end(j + 1));
            let (middle, aside) = (0.5 * (low + high), GAUSS * (high - low));
            Self { low, high, half: 0.5 * (half_at(middle - aside) + half_at(middle + aside)) }
        };
        (0..count).map(row).collect()
    }

    fn area(&self) -> f32 {
        2.0 * self.half * (self.high - self.low)
    }

    /// Returns the mean of y².
    fn mean_square(&self) -> f32 {
        (self.low * self.low + self.low * self.high + self.high * self.high) / 3.0
    }

    /// Returns the area where x cos + y sin < d.
    fn area_before(&self, normal: Vec2, d: f32) -> f32 {
        const STEPS: u32 = 64;
        let height = (self.high - self.low) / STEPS as f32;
        let at = |i: u32| {
            let y = self.low + (i as f32 + 0.5) * height;
            if normal.x < 1e-6 {
                return if y < d { 2.0 * self.half } else { 0.0 };
            }
            ((d - normal.y * y) / normal.x + self.half).clamp(0.0, 2.0 * self.half)
        };
        (0..STEPS).map(at).sum::<f32>() * height
    }
}

/// Returns the rms difference between rows and disk of radius 1 in the fraction before a moving edge.
fn penumbra_error(rows: &[EllipseRow], turn_rad: f32) -> f32 {
    const STEPS: u32 = 80;
    let normal = Vec2::from_angle(turn_rad);
    let area: f32 = rows.iter().map(EllipseRow::area).sum();
    let off = |i: u32| {
        let d = 2.0 * (i as f32 + 0.5) / STEPS as f32 - 1.0;
        let of_disk = 0.5 + (d * (1.0 - d * d).sqrt() + d.asin()) / PI;
        let of_rows = rows.iter().map(|row| row.area_before(normal, d)).sum::<f32>() / area;
        (of_rows - of_disk).powi(2)
    };
    ((0..STEPS).map(off).sum::<f32>() / STEPS as f32).sqrt()
}

/// CPU reference of the search, which reads every texel.
struct CpuReference<'a> {
    view: LightViewGpu,
    stored: &'a [f32],
    size: u32,
    extent: Vec2,
    scales: u32,
    /// Whether the mean is of depth instead of g.
    averages_depth: bool,
}

fn columns_of(m: [f32; 4]) -> [Vec2; 2] {
    [Vec2::new(m[0], m[1]), Vec2::new(m[2], m[3])]
}

impl CpuReference<'_> {
    /// Returns the blockers' mean g at a point of the ground, and the blocked fraction; `search_g` is the widest window's.
    fn blockers(&self, point: Vec3, search_g: f32) -> (f32, f32) {
        let view = &self.view;
        let p = point - view.origin_in_world;
        let [x, y, z] = [view.right_in_world, view.up_in_world, view.axis_in_world].map(|axis| p.dot(axis));
        let [right, up] = columns_of(view.uv_from_plane);
        let [across, down] = columns_of(view.plane_from_uv);
        let texels = self.size as f32;
        let center = texels * (view.uv_origin + right * (x / z) + up * (y / z));
        let half_at_1 = texels * (right.abs() * self.extent.x + up.abs() * self.extent.y);
        // 1/Z over the map for the ground plane y = 0: n · P = k.
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
                        let averaged = if self.averages_depth { 1.0 / inverse_z } else { g };
                        g_sum += share * f64::from(averaged);
                    }
                }
            }
        }
        let mean = (g_sum / share_sum.max(1e-12)) as f32;
        let mean_g = if self.averages_depth { 1.0 / mean - 1.0 / z } else { mean };
        (mean_g, share_sum as f32)
    }
}

/// Compares mean blocker depths by ESM-Z on tables with those of every texel of the same windows, on the ground of scenes.
#[test]
fn mean_blocker_depths_are_those_of_every_texel() {
    let Some(gpu) = gpu() else { return };
    const MAP: u32 = 1024;
    let mut filter = filter_of::<EssmParams>(gpu, Some(shaders::SUMMED_RESOLVE_BLOCKERS));
    for (spec, blocker_mean, bound) in [
        ("builtin:leaning-plank", "width", 0.03),
        ("builtin:overlap", "width", 0.03),
        ("builtin:columns", "width", 0.03),
        ("builtin:stacked-panels", "width", 0.03),
        ("builtin:window", "width", 0.10),
        // As published.
        ("builtin:leaning-plank", "depth", 0.03),
        ("builtin:overlap", "depth", 0.03),
    ] {
        let params = params(&[("map_size", "1024"), ("blocker_mean", blocker_mean)]);
        let staged = Staged::new(gpu, spec);
        let light = &staged.setup.lights[0];
        let caster = staged.mesh.caster();
        let light_view = fit_light_view(light, &[caster.bounds], &[]);
        let map = draw_depth(gpu, UVec2::splat(MAP), light_view.clip_from_world(), &[caster]);
        let view = view_of(&map);
        let casters = PreparedCasters::HostDepthMap(DepthMapCaster {
            view: &view,
            size_px: UVec2::splat(MAP),
            clip_from_world: light_view.clip_from_world(),
            depth_convention: DepthConvention::Reversed,
        });
        let had = staged.run(gpu, &mut filter, light, casters, &params);
        let stored: Vec<f32> = bytemuck::pod_collect_to_vec(&read_texture(gpu, &map, 0, UVec2::splat(MAP)));
        let depth: Vec<f32> = bytemuck::pod_collect_to_vec(&read_texture(gpu, &staged.depth, 0, SIZE));
        let cpu_reference = CpuReference {
            view: light_view.to_gpu(MAP),
            stored: &stored,
            size: MAP,
            extent: crate::light_map::light_spread::LightSpread::of(light).extent,
            scales: params.search_scales,
            averages_depth: blocker_mean == "depth",
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
            let (exact_g, exact_share) = cpu_reference.blockers(point, search_g);
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
