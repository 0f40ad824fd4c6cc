//! An independent small wgpu renderer gains soft shadows.
//!
//! Everything down to `main` is an ordinary renderer: its own meshes, shader, pipelines and passes. `main` reads from top to
//! bottom; the lines that add shadows are marked with `// shadows`. The only crate of this project is `antumbra`. It writes
//! `minimal.png`:
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

/// The host's scene on the GPU.
struct Scene {
    positions: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    instances: wgpu::Buffer,
    bounds: Aabb,
}

impl Scene {
    /// Uploads a ground, a table of five boxes, and a wall.
    fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        let mut add = |min, max| add_box(Vec3::from(min), Vec3::from(max), &mut positions, &mut indices);
        add([-8.0, -0.2, -8.0], [8.0, 0.0, 8.0]);
        add([-1.0, 0.9, -0.7], [1.0, 1.0, 0.7]);
        for (x, z) in [(-0.95, -0.65), (0.85, -0.65), (-0.95, 0.55), (0.85, 0.55)] {
            add([x, 0.0, z], [x + 0.1, 0.9, z + 0.1]);
        }
        add([-2.6, 0.0, -2.2], [2.6, 2.0, -2.0]);
        let buffer = |label, bytes: &[u8], usage| buffer(device, queue, label, bytes, usage);
        Self {
            positions: buffer("positions", bytemuck::cast_slice(&positions), wgpu::BufferUsages::VERTEX),
            indices: buffer("indices", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            index_count: indices.len() as u32,
            instances: buffer("instances", bytemuck::bytes_of(&Mat4::IDENTITY), wgpu::BufferUsages::VERTEX),
            bounds: Aabb::of(positions),
        }
    }
}

/// Creates a buffer with content.
fn buffer(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    bytes: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    queue.write_buffer(&buffer, 0, bytes);
    buffer
}

/// Creates a target of the image's size.
fn target(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
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
}

/// Pass over the host's scene: of depth alone, or of colour at equal depth.
struct ScenePass {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
}

impl ScenePass {
    /// Creates a pass of colour if there is a visibility mask to read, otherwise of depth.
    fn new(
        device: &wgpu::Device,
        module: &wgpu::ShaderModule,
        globals: &wgpu::Buffer,
        visibility: Option<&wgpu::TextureView>,
    ) -> Self {
        let pipeline = pipeline(device, module, visibility.is_some());
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: globals.as_entire_binding() }];
        entries.extend(
            visibility
                .map(|mask| wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(mask) }),
        );
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("host"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self { pipeline, bind_group }
    }

    /// Draws the scene, with colour if there is a view for it.
    fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        depth: &wgpu::TextureView,
        color: Option<&wgpu::TextureView>,
    ) {
        let sky = wgpu::Color { r: 0.35, g: 0.45, b: 0.6, a: 1.0 };
        let load = if color.is_some() { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(0.0) };
        let attachment = |view| wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
        };
        let colors: Vec<_> = color.into_iter().map(|view| Some(attachment(view))).collect();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host"),
            color_attachments: &colors,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_vertex_buffer(0, scene.positions.slice(..));
        pass.set_index_buffer(scene.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..scene.index_count, 0, 0..1);
    }
}

/// Creates the pipeline of a [`ScenePass`].
fn pipeline(device: &wgpu::Device, module: &wgpu::ShaderModule, with_color: bool) -> wgpu::RenderPipeline {
    let targets = [Some(wgpu::TextureFormat::Rgba8UnormSrgb.into())];
    let attributes = wgpu::vertex_attr_array![0 => Float32x3];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
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
            module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Submits the frame, reads its image back, and writes it.
fn save(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    color: &wgpu::Texture,
) -> Result<(), Box<dyn std::error::Error>> {
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

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The host's device, with the optional features of the library that the adapter supports.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: adapter.features() & Gpu::WANTED_FEATURES, // shadows
        ..wgpu::DeviceDescriptor::default()
    }))?;

    // The host's scene, camera and targets.
    let scene = Scene::new(&device, &queue);
    let view_from_world = look_at_mat4(Vec3::new(3.4, 2.6, 4.6), Vec3::new(0.0, 0.4, -0.4), Vec3::Y);
    let clip_from_view = perspective_infinite_reverse(0.7, SIZE.x as f32 / SIZE.y as f32, 0.1);
    let depth = target(&device, "depth", wgpu::TextureFormat::Depth32Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let color = target(&device, "color", wgpu::TextureFormat::Rgba8UnormSrgb, wgpu::TextureUsages::COPY_SRC);
    let depth_view = depth.create_view(&wgpu::TextureViewDescriptor::default());
    let color_view = color.create_view(&wgpu::TextureViewDescriptor::default());

    // Light, casters and receivers are the library's only inputs.
    let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) }; // shadows
    let light = Light::new(shape, Vec3::new(1.5, 4.5, 2.5), Vec3::ZERO); // shadows
    let mesh = MeshCaster::new(&scene.positions, &scene.indices, scene.index_count, &scene.instances)
        .with_bounds(scene.bounds)
        .with_closed(true); // shadows
    let casters = [mesh]; // shadows
    let mask = Mask::new(&device, SIZE); // shadows
    let camera = Camera { view_from_world, clip_from_view, depth_convention: DepthConvention::Reversed }; // shadows
    let receivers = Receivers::new(&depth_view, SIZE, camera); // shadows
    let frame = Frame { light: &light, casters: Casters::Meshes(&casters), receivers, mask: &mask }; // shadows
    let gpu = Gpu::new(&device, &queue); // shadows
    let mut shadow = TechniqueKind::Smrt.create(&gpu)?; // shadows
    let work = shadow.prepare(&frame)?; // shadows

    // The host's passes: depth first, then colour, multiplied by the mask.
    let globals =
        Globals { clip_from_world: clip_from_view * view_from_world, light_position: light.center, padding: 0.0 };
    let globals = buffer(&device, &queue, "globals", bytemuck::bytes_of(&globals), wgpu::BufferUsages::UNIFORM);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("host"),
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let depth_pass = ScenePass::new(&device, &module, &globals, None);
    let color_pass = ScenePass::new(&device, &module, &globals, Some(mask.view()));

    // One frame: the host's depth, the shadows, the host's colour.
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    depth_pass.draw(&mut encoder, &scene, &depth_view, None);
    work.record(&mut Recorder::new(&mut encoder, None)); // shadows
    color_pass.draw(&mut encoder, &scene, &depth_view, Some(&color_view));
    save(&device, &queue, encoder, &color)
}
