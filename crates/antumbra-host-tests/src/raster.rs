//! The host's rasteriser of depth and normals.

use antumbra::{DepthConvention, Receivers};
use glam::{Mat4, UVec2, Vec3};

use crate::device::Device;
use crate::scene::{Camera, Scene};

/// A vertex of the triangle soup.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct SoupVertex {
    pos_in_world: Vec3,
    normal_in_world: Vec3,
}

const SHADER: &str = "
    @group(0) @binding(0) var<uniform> clip_from_world: mat4x4f;

    struct Varyings {
        @builtin(position) pos_in_clip: vec4f,
        @location(0) @interpolate(flat) normal_in_world: vec3f,
    }

    @vertex fn vertex(@location(0) pos_in_world: vec3f, @location(1) normal_in_world: vec3f) -> Varyings {
        return Varyings(clip_from_world * vec4f(pos_in_world, 1.0), normal_in_world);
    }

    @fragment fn fragment(in: Varyings) -> @location(0) vec4f {
        return vec4f(in.normal_in_world, 0.0);
    }
";

/// Depth and normals of a scene from a camera.
#[derive(Debug)]
pub struct Picture {
    /// Depth texture.
    pub depth: wgpu::Texture,
    /// View of the whole texture, depth aspect only.
    pub depth_view: wgpu::TextureView,
    /// World-space geometric normals, `Rgba32Float`.
    pub normals: wgpu::Texture,
    /// View of the whole texture.
    pub normals_view: wgpu::TextureView,
    /// The camera.
    pub camera: Camera,
}

impl Picture {
    /// Draws depth and normals without waiting for the GPU.
    pub fn draw(device: &Device, scene: &Scene, camera: &Camera) -> Self {
        Self::draw_as(device, scene, camera, wgpu::TextureFormat::Depth32Float, wgpu::TextureUsages::TEXTURE_BINDING)
    }

    /// Draws depth in any format; `usage` is added to that of an attachment.
    pub fn draw_as(
        device: &Device,
        scene: &Scene,
        camera: &Camera,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Self {
        let depth = texture(device, camera.size_px, 1, format, usage);
        let normals =
            texture(device, camera.size_px, 1, wgpu::TextureFormat::Rgba32Float, wgpu::TextureUsages::TEXTURE_BINDING);
        let aspect =
            if format.has_stencil_aspect() { wgpu::TextureAspect::DepthOnly } else { wgpu::TextureAspect::All };
        let depth_view =
            depth.create_view(&wgpu::TextureViewDescriptor { aspect, ..wgpu::TextureViewDescriptor::default() });
        let normals_view = normals.create_view(&wgpu::TextureViewDescriptor::default());
        let picture = Self { depth, depth_view, normals, normals_view, camera: *camera };
        picture.record(device, scene);
        picture
    }

    fn record(&self, device: &Device, scene: &Scene) {
        let vertices: Vec<SoupVertex> = scene
            .triangles()
            .into_iter()
            .flat_map(|[a, b, c]| {
                let normal_in_world = (b - a).cross(c - a).normalize_or_zero();
                [a, b, c].map(|pos_in_world| SoupVertex { pos_in_world, normal_in_world })
            })
            .collect();
        let clip_from_world: Mat4 = self.camera.clip_from_view() * self.camera.view_from_world();
        let vertex_buffer = device.buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX);
        let uniform = device.buffer(bytemuck::bytes_of(&clip_from_world), wgpu::BufferUsages::UNIFORM);
        let pipeline = self.pipeline(device);
        let group = device.wgpu().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("host camera"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        // Views of attachments must have all aspects.
        let attachment = self.depth.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = device.encoder();
        {
            let load = wgpu::LoadOp::Clear(self.camera.background_depth());
            let stencil_ops = self
                .depth
                .format()
                .has_stencil_aspect()
                .then_some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Store });
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("host depth"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &self.normals_view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &attachment,
                    depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                    stencil_ops,
                }),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_vertex_buffer(0, vertex_buffer.slice(..));
            pass.draw(0..vertices.len() as u32, 0..1);
        }
        device.queue().submit([encoder.finish()]);
    }

    fn pipeline(&self, device: &Device) -> wgpu::RenderPipeline {
        let module = device.wgpu().create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("host"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let compare =
            if self.camera.is_reversed { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
        device.wgpu().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("host depth"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<SoupVertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: self.depth.format(),
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(self.normals.format().into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// Receivers of the image, with normals and without any other optional input.
    pub fn receivers(&self) -> Receivers<'_> {
        let camera = antumbra::Camera {
            view_from_world: self.camera.view_from_world(),
            clip_from_view: self.camera.clip_from_view(),
            depth_convention: if self.camera.is_reversed {
                DepthConvention::Reversed
            } else {
                DepthConvention::Standard
            },
        };
        Receivers::new(&self.depth_view, self.camera.size_px, camera).with_normals(&self.normals_view)
    }
}

/// Creates a render target.
pub fn texture(
    device: &Device,
    size_px: UVec2,
    layers: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.wgpu().create_texture(&wgpu::TextureDescriptor {
        label: Some("host texture"),
        size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}
