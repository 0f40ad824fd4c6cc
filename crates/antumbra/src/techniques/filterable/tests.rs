//! Tests of the filterable techniques against exact filtering of the same map: in the case that they solve exactly, and at the
//! extremes of number formats.

use antumbra_light::{Aabb, Light};
use glam::{DVec4, UVec2, Vec2, Vec3, Vec4Swizzles};

use super::{BasisShaders, DepthAxis, FilterKernel, FilterSettings, Filterable, FrameMap, Multisampling, ResolveBy};
use super::{convolution, esm, evsm, lvsm, moment, vsm};
use crate::TechniqueKind;
use crate::contract::{DepthConvention, DepthMapCaster, Error, MapSize, Receivers};
use crate::gpu::{Gpu, GpuStruct, Recorder, Stage};
use crate::light_map::central_view::fit_light_view;
use crate::primitives::depth_basis::cpu as basis;
use crate::primitives::packed_map::{Packing, cpu::unpack_word};
use crate::shaders;
use crate::shadow::{Casters, Frame};
use crate::testing::{Case, Mesh, RECTANGLE, View, draw_depth, gpu, read_layer, run, test_ground, view_of};

const ALL: [TechniqueKind; 6] = [
    TechniqueKind::Vsm,
    TechniqueKind::Lvsm,
    TechniqueKind::Evsm,
    TechniqueKind::Esm,
    TechniqueKind::Convolution,
    TechniqueKind::Moment,
];

/// Settings of a wide kernel on a small map: half a metre of the ground.
const WIDE: [(&str, &str); 3] = [("map_size", "256"), ("kernel_size", "11"), ("mips", "false")];

fn with<'a>(settings: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a str)> {
    WIDE.iter().chain(settings).copied().collect()
}

/// Returns the root mean square and the maximum of the differences.
fn difference(pixels: &[usize], a: &[f32], b: &[f32]) -> (f32, f32) {
    let squares: f32 = pixels.iter().map(|i| (a[*i] - b[*i]).powi(2)).sum();
    let most = pixels.iter().map(|i| (a[*i] - b[*i]).abs()).fold(0.0, f32::max);
    ((squares / pixels.len() as f32).sqrt(), most)
}

#[test]
fn one_planar_occluder_over_a_planar_receiver_is_exact() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let pixels: Vec<usize> = case.ground_pixels(test_ground).into_iter().map(|(i, _)| i).collect();
    let exact = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact")]));
    let penumbra = pixels.iter().filter(|i| exact[**i] > 0.05 && exact[**i] < 0.95).count();
    assert!(penumbra > 150, "the kernel is not wide: {penumbra} pixels of penumbra");
    let against_exact = |kind: TechniqueKind, settings: &[(&str, &str)]| {
        let (rmse, most) = difference(&pixels, &exact, &case.run(gpu, kind, &with(settings)));
        println!("{kind} {settings:?}: rmse {rmse:.5}, most {most:.4}");
        (rmse, most)
    };
    for placement in ["uniform", "lloyd"] {
        for layers in ["1", "2", "3", "4"] {
            let (rmse, _) = against_exact(TechniqueKind::Lvsm, &[("layers", layers), ("placement", placement)]);
            assert!(rmse <= 0.004, "{placement}, {layers}: {rmse}");
        }
    }
    assert!(against_exact(TechniqueKind::Vsm, &[]).0 <= 0.004);
    assert!(against_exact(TechniqueKind::Evsm, &[]).0 <= 0.004);
    assert!(against_exact(TechniqueKind::Moment, &[]).0 <= 0.004);
    // Figure 4: a split lies on the receiver, at 4 m, and there is no seam.
    let split = [("layers", "2"), ("placement", "manual"), ("split_depths", "4.0")];
    let (rmse, most) = against_exact(TechniqueKind::Lvsm, &split);
    assert!(rmse <= 0.02 && most <= 0.12, "a split on the receiver: {rmse}, {most}");
    // Multisampled maps have the same mean.
    for samples in ["2", "4", "8"] {
        if !has_samples(gpu, &case, samples) {
            continue;
        }
        let (rmse, most) = against_exact(TechniqueKind::Lvsm, &[("msaa", samples)]);
        assert!(rmse <= 0.02 && most <= 0.1, "{samples} samples: {rmse}, {most}");
        let exact_multisampled = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact"), ("msaa", samples)]));
        assert!(difference(&pixels, &exact, &exact_multisampled).0 <= 0.02);
    }
}

/// Depth as distance to the light, as published: where the curvature of the floor is too small to bleed under the kernel,
/// results are as accurate, but not identical.
#[test]
fn distances_to_the_light_are_filtered_as_exactly() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let pixels: Vec<usize> = case.ground_pixels(test_ground).into_iter().map(|(i, _)| i).collect();
    let exact = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact")]));
    for kind in [TechniqueKind::Vsm, TechniqueKind::Lvsm, TechniqueKind::Evsm, TechniqueKind::Moment] {
        let mask = |axis| case.run(gpu, kind, &with(&[("depth_axis", axis)]));
        let (by_distance, along_light) = (mask("distance"), mask("light"));
        let (rmse, most) = difference(&pixels, &exact, &by_distance);
        println!("{kind}: rmse {rmse:.5}, most {most:.4}");
        assert!(rmse <= 0.01, "{kind}: {rmse}");
        assert!(by_distance != along_light, "{kind}: the choice does nothing");
    }
}

/// Host's map that reaches two hundred metres down and holds one occluder but no ground. If the receivers' box is known, texels
/// without a caster count as its far side instead of the map's.
#[test]
fn a_host_s_deep_map_without_ground_is_filtered_as_exactly() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let occluder = [case.meshes[1].caster()];
    let ground = case.meshes[0].caster().bounds;
    let deep = Aabb { min: Vec3::new(-0.1, -200.0, -0.1), max: Vec3::new(0.1, -199.0, 0.1) };
    let view = fit_light_view(&case.light, &[ground, occluder[0].bounds, deep], &[]);
    let size_px = UVec2::splat(256);
    let map = view_of(&draw_depth(gpu, size_px, view.clip_from_world(), &occluder));
    let given = Casters::DepthMap(DepthMapCaster {
        view: &map,
        size_px,
        clip_from_world: view.clip_from_world(),
        depth_convention: DepthConvention::Reversed,
    });
    let pixels: Vec<usize> = case.ground_pixels(test_ground).into_iter().map(|(i, _)| i).collect();
    let mask = |kind: TechniqueKind, resolve: &str, bounds: Option<Aabb>| {
        let mut technique = kind.create(gpu).expect("a technique");
        for (key, value) in with(&[("resolve", resolve)]) {
            if key != "map_size" {
                technique.set(key, value).expect("a good setting");
            }
        }
        case.with_frame(given, |frame| {
            let receivers = Receivers { bounds, ..frame.receivers };
            run(gpu, &mut technique, &Frame { receivers, ..*frame }).expect("a good frame")
        })
    };
    let exact = mask(TechniqueKind::Vsm, "exact", None);
    assert!(pixels.iter().filter(|i| exact[**i] > 0.05 && exact[**i] < 0.95).count() > 100, "the kernel is not wide");
    for kind in [TechniqueKind::Vsm, TechniqueKind::Lvsm, TechniqueKind::Evsm, TechniqueKind::Moment] {
        let error = |bounds| difference(&pixels, &exact, &mask(kind, "basis", bounds)).0;
        let (known, unknown) = (error(Some(ground)), error(None));
        println!("{kind}: rmse {known:.4} where the receivers' box is known, {unknown:.4} where it is not");
        assert!(known <= 0.004 && unknown > 0.01, "{kind}: {known} and {unknown}");
    }
}

/// Whether the adapter supports light maps of `samples` samples per texel; if not, checks that the error says so in one line.
fn has_samples(gpu: &Gpu, case: &Case, samples: &str) -> bool {
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    match case.run_with(gpu, TechniqueKind::Vsm, &with(&[("msaa", samples)]), Casters::Meshes(&casters)) {
        Ok(_) => true,
        Err(error) => {
            says_which_sample_counts(&error, samples);
            false
        }
    }
}

fn says_which_sample_counts(error: &Error, samples: &str) {
    println!("skipped: {error}");
    let text = error.to_string();
    assert!(matches!(error, Error::Unsupported { .. }) && matches!(samples, "2" | "8"), "{text}");
    assert!(text.contains(&format!("{samples} samples per texel")) && !text.contains('\n'), "{text}");
}

/// A basis with its CPU reference, which maps t of a sample to the stored channels.
struct BasisCase<'a, P> {
    kind: TechniqueKind,
    shaders: BasisShaders,
    params: P,
    channels: u32,
    packing: Packing,
    buffer: Option<&'a wgpu::Buffer>,
    encode: &'a dyn Fn(f64) -> Vec<f64>,
    /// Tolerance for values up to 1; it is relative for larger ones.
    tolerance: f64,
}

/// Returns the depth of one sample, by the hash that the fragment shader uses too. A seventh of the samples are background.
fn sample_depth(x: u32, y: u32, sample: u32) -> f32 {
    let h = (x * 7919 + y * 104_729 + sample * 1_299_721 + 12345).wrapping_mul(2_654_435_761);
    let h = h ^ (h >> 15);
    if h.is_multiple_of(7) { 0.0 } else { ((h >> 8) & 0xffff) as f32 / 65536.0 }
}

const SAMPLE_DEPTH: &str = "
@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

@fragment
fn fragment(@builtin(position) pos: vec4f, @builtin(sample_index) sample: u32) -> @builtin(frag_depth) f32 {
    var h = (u32(pos.x) * 7919u + u32(pos.y) * 104729u + sample * 1299721u + 12345u) * 2654435761u;
    h ^= h >> 15u;
    return select(f32((h >> 8u) & 0xffffu) / 65536.0, 0.0, h % 7u == 0u);
}
";

/// Fills a depth texture with [`sample_depth`].
fn draw_samples(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, sample_count: u32) {
    let module = gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test samples"),
        source: wgpu::ShaderSource::Wgsl(SAMPLE_DEPTH.into()),
    });
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("test samples"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: sample_count, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("test samples"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: target,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(&pipeline);
    pass.draw(0..3, 0..1);
}

/// Returns t of a depth of the reversed perspective map at the centre of a texel.
fn t_of_depth(map: &FrameMap, texel: UVec2, depth: f32) -> f64 {
    if depth == 0.0 {
        return 1.0;
    }
    let FrameMap { view, range, .. } = map;
    let z_m = f64::from(view.depth_scale) / (f64::from(depth) - f64::from(view.depth_offset));
    let from_origin = (texel.as_dvec2() + 0.5) / map.size.as_dvec2() - view.uv_origin.as_dvec2();
    let columns = DVec4::from_array(view.plane_from_uv.map(f64::from));
    let plane = columns.xy() * from_origin.x + columns.zw() * from_origin.y;
    let ray_m = plane.extend(1.0) * z_m;
    let along_m = if range.is_distance { ray_m.length() } else { range.axis.as_dvec3().dot(ray_m) };
    let (near_m, far_m) = (f64::from(range.near_m), f64::from(range.far_m));
    ((along_m - near_m) / (far_m - near_m)).clamp(0.0, 1.0)
}

/// Compares each channel of each encoded texel with the CPU reference, for light maps of every sample count and size.
fn encode_equals_its_cpu_reference<P: GpuStruct>(gpu: &Gpu, basis: &BasisCase<'_, P>) {
    let case = Case::half_plane(gpu, RECTANGLE);
    let mut passes: Filterable<P> = Filterable::new(gpu, basis.kind.name(), basis.shaders);
    let sizes = [1, 2, 3, 7, 8, 9, 16, 31, 64, 65];
    for (i, msaa) in
        [Multisampling::One, Multisampling::Two, Multisampling::Four, Multisampling::Eight].into_iter().enumerate()
    {
        // Sample counts take turns at the sizes; all include the one that fills several workgroups.
        for size in sizes.iter().copied().skip(i % 2).step_by(2).chain([33]) {
            let settings = FilterSettings {
                map_size: MapSize::Texels(size),
                msaa,
                filter: FilterKernel::Box,
                kernel_size: 1.0,
                mips: false,
                anisotropy: 1,
                resolve: ResolveBy::Basis,
                // Every ray of the view runs down, so each axis is valid; sizes take turns at all three.
                depth_axis: [DepthAxis::Light, DepthAxis::World, DepthAxis::Distance][size as usize % 3],
                bias_scale: 1.0,
            };
            let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
            let made = case.with_prepared(&casters, |frame| {
                let map = passes.prepare_map(&Stage::at_once(gpu), frame, &settings)?;
                let prepared = passes.prepare_basis(
                    &Stage::at_once(gpu),
                    &map,
                    basis.channels,
                    basis.packing,
                    0.0,
                    &basis.params,
                    basis.buffer,
                );
                let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                draw_samples(gpu, &mut encoder, &map.depth, map.sample_count);
                prepared.record(&mut Recorder::new(&mut encoder, None));
                gpu.queue.submit([encoder.finish()]);
                Ok(map)
            });
            let map = match made {
                Ok(map) => map,
                Err(error) => {
                    says_which_sample_counts(&error, &msaa.count().to_string());
                    break;
                }
            };
            holds_to_cpu_reference(gpu, &passes, basis, &map, msaa.count());
        }
    }
}

fn holds_to_cpu_reference<P: GpuStruct>(
    gpu: &Gpu,
    passes: &Filterable<P>,
    basis: &BasisCase<'_, P>,
    map: &FrameMap,
    samples: u32,
) {
    let size = map.size;
    let per_word = basis.packing.channels();
    let layers: Vec<Vec<u32>> = (0..basis.channels.div_ceil(per_word))
        .map(|word| bytemuck::pod_collect_to_vec(&read_layer(gpu, passes.packed.texture(), word)))
        .collect();
    for texel in 0..size.x * size.y {
        let (x, y) = (texel % size.x, texel / size.x);
        let mut want = vec![0.0; basis.channels as usize];
        for sample in 0..samples {
            let encoded = (basis.encode)(t_of_depth(map, UVec2::new(x, y), sample_depth(x, y, sample)));
            for (sum, value) in want.iter_mut().zip(encoded) {
                *sum += value / f64::from(samples);
            }
        }
        for (channel, want) in want.iter().enumerate() {
            let channel = channel as u32;
            let word = layers[(channel / per_word) as usize][texel as usize];
            let got = f64::from(unpack_word(word, basis.packing)[(channel % per_word) as usize]);
            assert!(
                (got - want).abs() <= basis.tolerance * want.abs().max(1.0),
                "{}, {size}, {samples} samples, texel ({x}, {y}), channel {channel}: {got}, the twin has {want}",
                basis.kind
            );
        }
    }
}

fn shaders(encode: &'static str, encode_multisampled: &'static str, resolve: &'static str) -> BasisShaders {
    BasisShaders { encode, encode_multisampled, resolve }
}

#[test]
fn vsm_encodes_and_resolves_as_its_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    for (packing, tolerance) in [(Packing::Float32, 3e-6), (Packing::Float16, 6e-4), (Packing::Unorm16, 1e-5)] {
        let basis = BasisCase {
            kind: TechniqueKind::Vsm,
            shaders: shaders(shaders::VSM_ENCODE, shaders::VSM_ENCODE_MULTISAMPLED, shaders::VSM_RESOLVE),
            params: vsm::gpu_types::VsmUniform::default(),
            channels: 2,
            packing,
            buffer: None,
            encode: &|t| basis::encode_variance(t).to_vec(),
            tolerance,
        };
        encode_equals_its_cpu_reference(gpu, &basis);
    }
}

#[test]
fn lvsm_encodes_and_resolves_as_its_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let splits = [0.3f32, 0.45, 0.8];
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test splits"),
        size: size_of_val(&splits) as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&splits));
    let overlap = 0.02f32;
    let layered = |t: f64| {
        let ends: Vec<f64> = [0.0].into_iter().chain(splits.map(f64::from)).chain([1.0]).collect();
        let overlap = f64::from(overlap);
        ends.windows(2)
            .flat_map(|s| basis::encode_layered(t, (s[0] - overlap).max(0.0), (s[1] + overlap).min(1.0)))
            .collect()
    };
    let basis = BasisCase {
        kind: TechniqueKind::Lvsm,
        shaders: shaders(shaders::LVSM_ENCODE, shaders::LVSM_ENCODE_MULTISAMPLED, shaders::LVSM_RESOLVE),
        params: lvsm::gpu_types::LvsmUniform { layer_count: 4, overlap, ..Default::default() },
        channels: 8,
        packing: Packing::Unorm16,
        buffer: Some(&buffer),
        encode: &layered,
        // Encoding a layer magnifies the error of t.
        tolerance: 3e-5,
    };
    encode_equals_its_cpu_reference(gpu, &basis);
}

#[test]
fn evsm_encodes_and_resolves_as_its_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let basis = BasisCase {
        kind: TechniqueKind::Evsm,
        shaders: shaders(shaders::EVSM_ENCODE, shaders::EVSM_ENCODE_MULTISAMPLED, shaders::EVSM_RESOLVE),
        params: evsm::gpu_types::EvsmUniform { exponents: Vec2::new(6.0, 5.0), component_count: 4, padding: 0 },
        channels: 4,
        packing: Packing::Float32,
        buffer: None,
        encode: &|t| basis::encode_exponential_variance(t, [6.0, 5.0]).to_vec(),
        // dw = 2 c w dt.
        tolerance: 1e-4,
    };
    encode_equals_its_cpu_reference(gpu, &basis);
}

#[test]
fn esm_encodes_and_resolves_as_its_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let basis = BasisCase {
        kind: TechniqueKind::Esm,
        shaders: shaders(shaders::ESM_ENCODE, shaders::ESM_ENCODE_MULTISAMPLED, shaders::ESM_RESOLVE),
        params: esm::gpu_types::EsmUniform { exponent: 40.0, ..Default::default() },
        channels: 1,
        packing: Packing::Float32,
        buffer: None,
        encode: &|t| vec![basis::encode_exponential(t, 40.0)],
        tolerance: 3e-5,
    };
    encode_equals_its_cpu_reference(gpu, &basis);
}

#[test]
fn convolution_encodes_and_resolves_as_its_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let (terms, depth_scale) = (5u32, 0.8f32);
    let series = |t: f64| {
        let term = |k| basis::encode_convolution(f64::from(depth_scale) * t, k);
        (1..=terms).flat_map(term).map(|v| 0.5 + 0.5 * v).collect()
    };
    let basis = BasisCase {
        kind: TechniqueKind::Convolution,
        shaders: shaders(
            shaders::CONVOLUTION_ENCODE,
            shaders::CONVOLUTION_ENCODE_MULTISAMPLED,
            shaders::CONVOLUTION_RESOLVE,
        ),
        params: convolution::gpu_types::ConvolutionUniform { term_count: terms, depth_scale, ..Default::default() },
        channels: 2 * terms,
        packing: Packing::Unorm8,
        buffer: None,
        encode: &series,
        tolerance: 0.51 / 255.0,
    };
    encode_equals_its_cpu_reference(gpu, &basis);
}

#[test]
fn moment_encodes_and_resolves_as_its_cpu_reference_over_a_ladder_of_sizes() {
    let Some(gpu) = gpu() else { return };
    let basis = BasisCase {
        kind: TechniqueKind::Moment,
        shaders: shaders(shaders::MOMENT_ENCODE, shaders::MOMENT_ENCODE_MULTISAMPLED, shaders::MOMENT_RESOLVE),
        params: moment::gpu_types::MomentUniform::default(),
        channels: 4,
        packing: Packing::Unorm16,
        buffer: None,
        encode: &|t| basis::quantize_moments(basis::encode_moments(t)).to_vec(),
        tolerance: 1.2e-5,
    };
    encode_equals_its_cpu_reference(gpu, &basis);
}

#[test]
fn manual_splits_say_what_they_need() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    for depths in ["", "3", "3,2"] {
        let settings = with(&[("layers", "3"), ("placement", "manual"), ("split_depths", depths)]);
        let casters = crate::shadow::Casters::Meshes(&casters);
        let error = case.run_with(gpu, TechniqueKind::Lvsm, &settings, casters).unwrap_err().to_string();
        assert!(error.contains("2 ascending depths in metres for 3 layers"), "{error}");
    }
}

#[test]
fn ranges_from_a_metre_to_ten_kilometres_hold() {
    let Some(gpu) = gpu() else { return };
    for scale in [0.25, 2500.0] {
        let light = Light::new(RECTANGLE, Vec3::new(0.0, 4.0 * scale, 0.0), Vec3::ZERO);
        let view = View::new(scale * Vec3::new(2.0, 1.2, 5.0), scale * Vec3::new(0.6, 0.0, 0.0));
        let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0 * scale), Vec2::splat(6.0 * scale), 0.0);
        let occluder = Mesh::horizontal(gpu, scale * Vec2::new(-4.0, -4.0), scale * Vec2::new(0.0, 4.0), 1.5 * scale);
        let case = Case::new(gpu, light, view, vec![ground, occluder]);
        let pixels: Vec<usize> = case.ground_pixels(|p| test_ground(p / scale)).into_iter().map(|(i, _)| i).collect();
        let exact = case.run(gpu, TechniqueKind::Vsm, &with(&[("resolve", "exact")]));
        // The reference must contain a shadow: neither all dark nor all lit.
        let mean = pixels.iter().map(|i| exact[*i]).sum::<f32>() / pixels.len() as f32;
        println!("{} m: mean {mean:.4}", 4.0 * scale);
        assert!((0.62..0.64).contains(&mean), "exact filtering at {scale}: a mean of {mean}");
        for kind in ALL {
            let mask = case.run(gpu, kind, &with(&[]));
            assert!(mask.iter().all(|v| (0.0..=1.0).contains(v)), "{kind} at {scale}");
            let (rmse, _) = difference(&pixels, &exact, &mask);
            println!("{kind}, {} m: rmse {rmse:.4}", 4.0 * scale);
            // The bounds are the same at both scales.
            let bound = match kind {
                TechniqueKind::Esm => 0.11,
                TechniqueKind::Convolution => 0.0089,
                _ => 0.0009,
            };
            assert!(rmse <= bound, "{kind} at {scale}: {rmse}");
        }
    }
}
