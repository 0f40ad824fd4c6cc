//! An independent small wgpu renderer gains soft shadows.
//!
//! Everything down to `main` is an ordinary renderer: its own meshes, camera, depth buffer and shader. The lines that
//! add shadows are marked with `// shadows`. The only crate of this project is `antumbra`. It writes `minimal.png`:
//!
//! ```text
//! cargo run --example minimal
//! ```

use antumbra::light::{Aabb, Light, LightShape};
use antumbra::{Camera, Casters, DepthConvention, Frame, Gpu, Mask, MeshCaster, Receivers, Recorder, TechniqueKind};
use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_at_mat4};
use glam::{Mat4, UVec2, Vec2, Vec3};

const SIZE: UVec2 = UVec2::new(960, 540);

/// Uniforms of the host: camera and light.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Globals {
    clip_from_world: Mat4,
    light_position: Vec3,
    padding: f32,
}

const SHADER: &str = "
    struct Globals { clip_from_world: mat4x4f, light_position: vec3f, padding: f32 }
    @group(0) @binding(0) var<uniform> globals: Globals;
    @group(0) @binding(1) var visibility: texture_2d<f32>;

    struct Varyings { @builtin(position) clip: vec4f, @location(0) world: vec3f }

    @vertex fn vertex(@location(0) position: vec3f) -> Varyings {
        return Varyings(globals.clip_from_world * vec4f(position, 1.0), position);
    }

    @fragment fn fragment(in: Varyings) -> @location(0) vec4f {
        let normal = normalize(cross(dpdy(in.world), dpdx(in.world)));
        let to_light = normalize(globals.light_position - in.world);
        let v = textureLoad(visibility, vec2u(in.clip.xy), 0).x;
        let albedo = select(vec3f(0.75, 0.45, 0.3), vec3f(0.7), in.world.y < 0.001);
        return vec4f(albedo * (0.12 + 0.9 * v * max(dot(normal, to_light), 0.0)), 1.0);
    }
";

/// Adds a box: twelve triangles, counter-clockwise from outside.
fn add_box(min: Vec3, max: Vec3, positions: &mut Vec<Vec3>, indices: &mut Vec<u32>) {
    let base = positions.len() as u32;
    positions.extend(Aabb { min, max }.corners());
    for quad in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| base + quad[corner]));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The host's device, with the optional features of the library that the adapter supports.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: adapter.features() & Gpu::WANTED_FEATURES, // shadows
        ..wgpu::DeviceDescriptor::default()
    }))?;

    // The host's scene: a ground, a table of five boxes, a wall.
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    let mut add = |min, max| add_box(Vec3::from(min), Vec3::from(max), &mut positions, &mut indices);
    add([-8.0, -0.2, -8.0], [8.0, 0.0, 8.0]);
    add([-1.0, 0.9, -0.7], [1.0, 1.0, 0.7]);
    for (x, z) in [(-0.95, -0.65), (0.85, -0.65), (-0.95, 0.55), (0.85, 0.55)] {
        add([x, 0.0, z], [x + 0.1, 0.9, z + 0.1]);
    }
    add([-2.6, 0.0, -2.2], [2.6, 2.0, -2.0]);
    let buffer = |label, bytes: &[u8], usage| {
        let descriptor = wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        let buffer = device.create_buffer(&descriptor);
        queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let position_buffer = buffer("positions", bytemuck::cast_slice(&positions), wgpu::BufferUsages::VERTEX);
    let index_buffer = buffer("indices", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX);
    let instance_buffer = buffer("instances", bytemuck::bytes_of(&Mat4::IDENTITY), wgpu::BufferUsages::VERTEX);
    let view_from_world = look_at_mat4(Vec3::new(3.4, 2.6, 4.6), Vec3::new(0.0, 0.4, -0.4), Vec3::Y);
    let clip_from_view = perspective_infinite_reverse(0.7, SIZE.x as f32 / SIZE.y as f32, 0.1);

    // The host's targets and pipelines: depth first, then colour at equal depth.
    let texture = |label, format, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    let depth = texture("depth", wgpu::TextureFormat::Depth32Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let color = texture("color", wgpu::TextureFormat::Rgba8UnormSrgb, wgpu::TextureUsages::COPY_SRC);
    let depth_view = depth.create_view(&wgpu::TextureViewDescriptor::default());
    let color_view = color.create_view(&wgpu::TextureViewDescriptor::default());

    // Light, casters and receivers are the library's only inputs.
    let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) }; // shadows
    let light = Light::new(shape, Vec3::new(1.5, 4.5, 2.5), Vec3::ZERO); // shadows
    let mesh = MeshCaster::new(&position_buffer, &index_buffer, indices.len() as u32, &instance_buffer)
        .with_bounds(Aabb::of(positions.iter().copied()))
        .with_closed(true); // shadows
    let casters = [mesh]; // shadows
    let mask = Mask::new(&device, SIZE); // shadows
    let camera = Camera { view_from_world, clip_from_view, depth_convention: DepthConvention::Reversed }; // shadows
    let receivers = Receivers::new(&depth_view, SIZE, camera); // shadows
    let frame = Frame { light: &light, casters: Casters::Meshes(&casters), receivers, mask: &mask }; // shadows
    let gpu = Gpu::new(&device, &queue); // shadows
    let mut shadow = TechniqueKind::Smrt.create(&gpu)?; // shadows
    let work = shadow.prepare(&frame)?; // shadows

    let globals =
        Globals { clip_from_world: clip_from_view * view_from_world, light_position: light.center, padding: 0.0 };
    let globals = buffer("globals", bytemuck::bytes_of(&globals), wgpu::BufferUsages::UNIFORM);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("host"),
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let pipeline = |label, with_color: bool| {
        let targets = [Some(wgpu::TextureFormat::Rgba8UnormSrgb.into())];
        let attributes = wgpu::vertex_attr_array![0 => Float32x3];
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: 12,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &attributes,
                })],
            },
            primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(!with_color),
                depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: with_color.then(|| wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    let (depth_pipeline, color_pipeline) = (pipeline("depth", false), pipeline("color", true));
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    let bind_group = |pipeline: &wgpu::RenderPipeline, entries: &[wgpu::BindGroupEntry<'_>]| {
        let layout = &pipeline.get_bind_group_layout(0);
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("host"), layout, entries })
    };
    let depth_group = bind_group(&depth_pipeline, &[entry(0, globals.as_entire_binding())]);
    let color_entries =
        [entry(0, globals.as_entire_binding()), entry(1, wgpu::BindingResource::TextureView(mask.view()))];
    let color_group = bind_group(&color_pipeline, &color_entries);

    // One frame: the host's depth, the shadows, the host's colour.
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let draw = |encoder: &mut wgpu::CommandEncoder, with_color: bool| {
        let sky = wgpu::Color { r: 0.35, g: 0.45, b: 0.6, a: 1.0 };
        let color = [Some(wgpu::RenderPassColorAttachment {
            view: &color_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
        })];
        let load = if with_color { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(0.0) };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host"),
            color_attachments: if with_color { &color } else { &[] },
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth_view,
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(if with_color { &color_pipeline } else { &depth_pipeline });
        pass.set_bind_group(0, if with_color { &color_group } else { &depth_group }, &[]);
        pass.set_vertex_buffer(0, position_buffer.slice(..));
        pass.set_index_buffer(index_buffer.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..indices.len() as u32, 0, 0..1);
    };
    draw(&mut encoder, false);
    work.record(&mut Recorder::new(&mut encoder, None)); // shadows
    draw(&mut encoder, true);

    // Reads the image back and writes it.
    let row_bytes = (SIZE.x * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(row_bytes * SIZE.y),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &readback, layout };
    encoder.copy_texture_to_buffer(color.as_image_copy(), target, color.size());
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapping for reading"));
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = readback.get_mapped_range(..)?;
    let pixels: Vec<u8> =
        bytes.chunks_exact(row_bytes as usize).flat_map(|row| &row[..(SIZE.x * 4) as usize]).copied().collect();
    image::save_buffer("minimal.png", &pixels, SIZE.x, SIZE.y, image::ColorType::Rgba8)?;
    println!("wrote minimal.png");
    Ok(())
}
