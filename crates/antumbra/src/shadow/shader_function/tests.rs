//! Tests of shader functions: a host's fragment shader gets visibility at a mask's pixels; invalid requests are errors.

use std::sync::Arc;

use antumbra_light::Light;
use glam::UVec2;

use crate::TechniqueKind;
use crate::contract::Mask;
use crate::gpu::{Gpu, Recorder, ShaderFunction};
use crate::receivers::points::tests::{Places, SIZE, Scene, create, lights};
use crate::shaders;
use crate::shadow::{AnyShadow, Casters, Frame};
use crate::testing::{gpu_with, read_texture, view_of};

/// Prefixes of as many functions as a shader has bind groups besides the host's own.
const PREFIXES: [&str; 3] = ["first_", "second_", "third_"];

/// Every technique with a `shader_function.wesl` in its folder, in groups for one host's shader; the first ones again, if the last
/// group is short.
fn groups() -> Vec<[TechniqueKind; 3]> {
    let folders = shaders::ALL.iter().filter_map(|(path, _)| path.strip_suffix("/shader_function")?.rsplit('/').next());
    let kind = |name| TechniqueKind::from_name(name).unwrap_or_else(|| panic!("there is no technique {name}"));
    let kinds: Vec<_> = folders.map(kind).collect();
    let group = |first| [0, 1, 2].map(|i| kinds[(first + i) % kinds.len()]);
    (0..kinds.len()).step_by(3).map(group).collect()
}

/// Host's shader with the functions of three shadows; visibility is 1 where there is no surface, as in a mask.
const HOST: &str = "
    @group(0) @binding(0) var<storage, read> positions: array<vec4f>;
    @group(0) @binding(1) var<storage, read> normals: array<f32>;

    @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32((i << 1u) & 2u) * 2.0 - 1.0, f32(i & 2u) * 2.0 - 1.0, 0.0, 1.0);
    }

    struct Seen { @location(0) first: f32, @location(1) second: f32, @location(2) third: f32 }

    @fragment fn fragment(@builtin(position) at: vec4f) -> Seen {
        let pixel = vec2u(at.xy);
        let i = pixel.y * WIDTH + pixel.x;
        if positions[i].w != 1.0 {
            return Seen(1.0, 1.0, 1.0);
        }
        let x = positions[i].xyz;
        let normal = vec3f(normals[3u * i], normals[3u * i + 1u], normals[3u * i + 2u]);
        return Seen(
            first_visibility_at(x, normal, pixel),
            second_visibility_at(x, normal, pixel),
            third_visibility_at(x, normal, pixel),
        );
    }
";

/// Prepares and records a frame.
fn draw(gpu: &Gpu, shadow: &mut AnyShadow, frame: &Frame<'_>) {
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    shadow.prepare(frame).expect("a good frame").record(&mut Recorder::new(&mut encoder, None));
    gpu.queue().submit([encoder.finish()]);
}

/// Returns the values that a host's fragments get from three functions.
fn ask(gpu: &Gpu, functions: &[ShaderFunction], places: &Places) -> Vec<Vec<f32>> {
    let device = gpu.device();
    let texts: String = functions.iter().map(|function| &*function.wgsl).collect();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test host"),
        source: wgpu::ShaderSource::Wgsl(format!("{texts}{}", HOST.replace("WIDTH", &format!("{}u", SIZE.x))).into()),
    });
    let storage = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let own = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("test host"),
        entries: &[storage(0), storage(1)],
    });
    let entry = |binding, buffer: &wgpu::Buffer| (binding, buffer.clone());
    let buffers = [entry(0, &places.positions), entry(1, &places.normals)];
    let entries: Vec<_> = (buffers.iter())
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("test host"),
        layout: &own,
        entries: &entries,
    });
    let layouts: Vec<_> =
        std::iter::once(Some(&own)).chain(functions.iter().map(|function| Some(&function.layout))).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("test host"),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    let targets = [(); 3].map(|()| Some(wgpu::TextureFormat::R32Float.into()));
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("test host"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    });
    let textures = [(); 3].map(|()| target(gpu, SIZE));
    let views = textures.each_ref().map(view_of);
    let attachments = views.each_ref().map(|view| {
        Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("test host"),
            color_attachments: &attachments,
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        for (i, function) in (1..).zip(functions) {
            pass.set_bind_group(i, &function.bind_group, &[]);
        }
        pass.draw(0..3, 0..1);
    }
    gpu.queue().submit([encoder.finish()]);
    textures.iter().map(|texture| bytemuck::pod_collect_to_vec(&read_texture(gpu, texture, 0, SIZE))).collect()
}

fn target(gpu: &Gpu, size: UVec2) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("test host"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// At the mask's pixels a host's fragments get the mask's bits, from three functions in one shader, within WebGPU's default limits.
/// While a light moves, text, bind group and all other resources are reused.
#[test]
fn a_host_s_shader_gets_what_the_mask_has() {
    let Some(gpu) = gpu_with(|_| wgpu::Limits::default()) else { return };
    let gpu = &gpu;
    let scene = Scene::new(gpu);
    let places = scene.places(gpu);
    let casters = scene.casters();
    let lights = &lights()[..2];
    for (kinds, (name, light)) in groups().into_iter().flat_map(|kinds| lights.iter().map(move |light| (kinds, light)))
    {
        let mut functions = Vec::new();
        let mut masks: Vec<Vec<f32>> = Vec::new();
        let mut shadows = kinds.map(|kind| create(gpu, kind, &[("samples", "32")]));
        for ((group, prefix), shadow) in (1..).zip(PREFIXES).zip(&mut shadows) {
            let mask = Mask::new(gpu.device(), SIZE);
            let mut last = None;
            for i in 0..6 {
                let away = if light.is_distant() { 0.0 } else { 0.01 * (i - 5) as f32 };
                let moved = Light { center: light.center + away, ..light.clone() };
                let frame = Frame {
                    light: &moved,
                    casters: Casters::Meshes(&casters),
                    receivers: scene.receivers(),
                    mask: &mask,
                };
                draw(gpu, shadow, &frame);
                let before = gpu.objects_created().total();
                let function = shadow.shader_function(group, prefix).unwrap_or_else(|error| panic!("{error}"));
                if let Some(ShaderFunction { wgsl, bind_group, .. }) = &last {
                    assert!(
                        Arc::ptr_eq(wgsl, &function.wgsl) && *bind_group == function.bind_group,
                        "{prefix}, {name}"
                    );
                    assert_eq!(gpu.objects_created().total(), before, "{prefix}, {name}");
                }
                last = Some(function);
            }
            functions.extend(last);
            masks.push(bytemuck::pod_collect_to_vec(&read_texture(gpu, mask.texture(), 0, SIZE)));
        }
        let asked = ask(gpu, &functions, &places);
        for ((kind, mask), asked) in kinds.iter().zip(&masks).zip(&asked) {
            let differing = mask.iter().zip(asked).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            let [lit, dark] = [mask.iter().filter(|v| **v > 0.9).count(), mask.iter().filter(|v| **v < 0.1).count()];
            println!("{kind}, {name}: {differing} of {} differ; {lit} lit, {dark} dark", mask.len());
            assert!(lit > 500 && dark > 20, "{kind}, {name}: {lit} lit, {dark} dark");
            assert_eq!(differing, 0, "{kind}, {name}");
        }
    }
}

/// Techniques without a function, frames without a single map, and invalid prefixes give errors of one line.
#[test]
fn what_has_no_function_says_so() {
    let Some(gpu) = gpu_with(|_| wgpu::Limits::default()) else { return };
    let gpu = &gpu;
    let scene = Scene::new(gpu);
    let casters = scene.casters();
    let [(_, light), _, (_, in_parts)] = &lights();
    let frame =
        |light| Frame { light, casters: Casters::Meshes(&casters), receivers: scene.receivers(), mask: &scene.mask };
    let refuses = |shadow: &mut AnyShadow, prefix, words: &[&str]| {
        let error = shadow.shader_function(1, prefix).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)) && !error.contains('\n'), "{error}");
    };
    let mut shadow = create(gpu, TechniqueKind::Pcss, &[]);
    refuses(&mut shadow, "", &["a prepared frame"]);
    draw(gpu, &mut shadow, &frame(light));
    shadow.shader_function(3, "").expect("it has one");
    for prefix in ["_a", "1", "a-b", "ä"] {
        refuses(&mut shadow, prefix, &["prefix", prefix, "letters"]);
    }
    draw(gpu, &mut shadow, &frame(in_parts));
    refuses(&mut shadow, "", &["a single shadow map", "`fov_rad`", "`prepare_points`"]);
    gpu.set_map_budget(0);
    let mut shared = create(gpu, TechniqueKind::Hard, &[]);
    draw(gpu, &mut shared, &frame(light));
    refuses(&mut shared, "", &["that lights share", "set_map_budget"]);
    let mut traced = create(gpu, TechniqueKind::RayTraced, &[("samples", "1")]);
    draw(gpu, &mut traced, &frame(light));
    refuses(&mut traced, "", &["`prepare_points`"]);
}
