//! Renderer of the host: two cameras side by side in one window, depth first, then colour under eight lights.
//!
//! Its shadows are in `shadows.rs`; the lines that call them are marked with `// shadows`.

use antumbra::casters::Texture;
use antumbra::{Error, Gpu, Recorder};
use glam::{Mat4, UVec2, Vec4};

use super::buffers::Buffers;
use super::meshes::{LEAF_SIZE, PACKED_OFFSET, PACKED_SCALE, VertexBuffer, leaf_texels};
use super::pipelines::{COLOR_FORMAT, DEPTH_FORMAT, Layouts, NORMAL_FORMAT, Pipelines, bind_group};
use super::scene::{Camera, Object, Scene};
use super::shadows::{Shadows, ViewDepth};

/// Uniform `Globals` of the shader, one per view.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Globals {
    clip_from_world: Mat4,
    packed_scale: Vec4,
    packed_offset: Vec4,
    origin_px: UVec2,
    padding: [u32; 2],
}

pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pub scene: Scene,
    pub targets: Targets,
    pub shadows: Shadows, // shadows
    buffers: Buffers,
    pipelines: Pipelines,
    skin_group: wgpu::BindGroup,
    views: Vec<View>,
}

/// Render targets of the whole window. The views are created once, because shadows cache resources per depth view.
pub struct Targets {
    pub depth: wgpu::TextureView,
    pub normal: wgpu::TextureView,
    pub color: wgpu::TextureView,
}

/// Part of the window of one camera.
struct View {
    origin_px: UVec2,
    size_px: UVec2,
    globals: wgpu::Buffer,
    globals_group: wgpu::BindGroup,
    light_group: wgpu::BindGroup,
}

impl Targets {
    fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        let texture = |label, format| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            depth: texture("depth", DEPTH_FORMAT),
            normal: texture("normal", NORMAL_FORMAT),
            color: texture("color", COLOR_FORMAT),
        }
    }
}

impl View {
    fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        (origin_px, size_px): (UVec2, UVec2),
        (lights, leaf, masks): (&wgpu::Buffer, &Texture, &wgpu::Texture),
    ) -> Self {
        let globals = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("globals"),
            size: size_of::<Globals>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let texture = |view| wgpu::BindingResource::TextureView(view);
        let sampler = wgpu::BindingResource::Sampler(&leaf.sampler);
        let masks = masks.create_view(&wgpu::TextureViewDescriptor::default());
        Self {
            origin_px,
            size_px,
            globals_group: bind_group(
                device,
                &layouts.globals,
                &[globals.as_entire_binding(), texture(&leaf.view), sampler],
            ),
            light_group: bind_group(device, &layouts.lights, &[lights.as_entire_binding(), texture(&masks)]),
            globals,
        }
    }

    fn clip_from_view(&self, camera: &Camera) -> Mat4 {
        camera.clip_from_view(self.size_px.x as f32 / self.size_px.y as f32)
    }

    fn write_globals(&self, queue: &wgpu::Queue, camera: &Camera) {
        let globals = Globals {
            clip_from_world: self.clip_from_view(camera) * camera.view_from_world(),
            packed_scale: PACKED_SCALE.extend(0.0),
            packed_offset: PACKED_OFFSET.extend(0.0),
            origin_px: self.origin_px,
            padding: [0; 2],
        };
        queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&globals));
    }
}

impl Renderer {
    /// Creates the renderer of a window that is twice as wide as one view.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, view_size_px: UVec2) -> Result<Self, Error> {
        let scene = Scene::new();
        let buffers = Buffers::new(device, queue, &scene);
        let leaf = leaf_texture(device, queue);
        let shadows = Shadows::new(&Gpu::new(device, queue), &scene, &buffers, &leaf, view_size_px)?; // shadows
        let layouts = Layouts::new(device);
        let pipelines = Pipelines::new(device, &layouts);
        let skinned = [&buffers.joints, &buffers.modelled, &buffers.skinned].map(wgpu::Buffer::as_entire_binding);
        let skin_group = bind_group(device, &pipelines.skinning.get_bind_group_layout(0), &skinned);
        let view = |i: u32| {
            let viewport = (UVec2::new(i * view_size_px.x, 0), view_size_px);
            View::new(device, &layouts, viewport, (&buffers.lights, &leaf, shadows.masks(i as usize)))
        };
        let views = vec![view(0), view(1)];
        let targets = Targets::new(device, UVec2::new(2, 1) * view_size_px);
        let (device, queue) = (device.clone(), queue.clone());
        Ok(Self { device, queue, scene, targets, shadows, buffers, pipelines, skin_group, views })
    }

    /// Draws the scene at a time, in one submission.
    pub fn draw(&mut self, time_s: f32) -> Result<(), Error> {
        self.scene.move_to(time_s);
        self.buffers.write(&self.queue, &self.scene);
        for (view, camera) in self.views.iter().zip(&self.scene.cameras) {
            view.write_globals(&self.queue, camera);
        }
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.skin(&mut encoder);
        self.draw_views(&mut encoder, false);
        let mut recorder = Recorder::new(&mut encoder, None); // shadows
        self.shadows.update_casters(&self.scene, &self.buffers, &mut recorder)?; // shadows
        for (i, (view, camera)) in self.views.iter().zip(&self.scene.cameras).enumerate() {
            let seen = ViewDepth {
                depth: &self.targets.depth,
                normals: &self.targets.normal,
                origin_px: view.origin_px,
                view_from_world: camera.view_from_world(),
                clip_from_view: view.clip_from_view(camera),
            };
            self.shadows.record(i, &self.scene.lights, &seen, &mut recorder)?; // shadows
        }
        self.draw_views(&mut encoder, true);
        self.queue.submit([encoder.finish()]);
        Ok(())
    }

    fn skin(&self, encoder: &mut wgpu::CommandEncoder) {
        let vertices = self.scene.meshes.skin_vertices.len() as u32;
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipelines.skinning);
        pass.set_bind_group(0, &self.skin_group, &[]);
        pass.dispatch_workgroups(vertices.div_ceil(64), 1, 1);
    }

    /// Draws all views' depth, or all views' colour at that depth.
    fn draw_views(&self, encoder: &mut wgpu::CommandEncoder, with_color: bool) {
        let sky = wgpu::Color { r: 0.02, g: 0.025, b: 0.04, a: 1.0 };
        let color = Some(wgpu::RenderPassColorAttachment {
            view: if with_color { &self.targets.color } else { &self.targets.normal },
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
        });
        let load = if with_color { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(1.0) };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(if with_color { "color" } else { "depth" }),
            color_attachments: &[color],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        let pipelines = if with_color { &self.pipelines.color } else { &self.pipelines.depth };
        for view in &self.views {
            let [origin, size] = [view.origin_px, view.size_px].map(|v| v.as_vec2());
            pass.set_viewport(origin.x, origin.y, size.x, size.y, 0.0, 1.0);
            pass.set_bind_group(0, &view.globals_group, &[]);
            if with_color {
                pass.set_bind_group(1, &view.light_group, &[]);
            }
            self.draw_objects(&mut pass, pipelines);
        }
    }

    fn draw_objects(&self, pass: &mut wgpu::RenderPass<'_>, pipelines: &[wgpu::RenderPipeline; 2]) {
        pass.set_index_buffer(self.buffers.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.set_vertex_buffer(1, self.buffers.instances.slice(..));
        for (i, Object { part, world_from_object, .. }) in self.scene.objects.iter().enumerate() {
            pass.set_pipeline(&pipelines[usize::from(part.buffer == VertexBuffer::Packed)]);
            pass.set_vertex_buffer(0, self.buffers.vertices(part.buffer).slice(..));
            let first = self.scene.first_instance(i);
            let instances = first..first + world_from_object.len() as u32;
            pass.draw_indexed(part.indices.clone(), (part.vertices.start + part.base_vertex) as i32, instances);
        }
    }
}

fn leaf_texture(device: &wgpu::Device, queue: &wgpu::Queue) -> Texture {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("leaf"),
        size: wgpu::Extent3d { width: LEAF_SIZE, height: LEAF_SIZE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * LEAF_SIZE), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&leaf_texels()), layout, texture.size());
    Texture {
        view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
        sampler: device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        }),
    }
}
