//! Pass of coherent shading: how dark the triangles around each pixel's corners are.

use antumbra::{Gpu, programs};

use super::{IRRADIANCE_WGSL, LightBuffers};
use crate::buffer_entry;
use crate::gpu_scene::{Draw, GpuScene};
use crate::receivers::{DEPTH_FORMAT, RECEIVERS_WGSL, ReceiverImages, ReceiverPass, draw_pipeline, uniform_buffer};

const BENT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Draws, for each light, the bent irradiance of the surfaces of `scene` in `images`: the least irradiance of a triangle's
/// neighbours, over their irradiance if they faced the light. 1 if nothing is bent.
pub(super) fn bent_images(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    scene: &GpuScene,
    images: &ReceiverImages,
    lights: &[LightBuffers],
) -> Vec<wgpu::TextureView> {
    let receivers = ReceiverPass::new(gpu);
    let pipelines = Pipelines::new(gpu.device(), &receivers);
    let view_group = receivers.view_group(gpu, images);
    // The pass has its own depth, so that no two shaders need to compute equal vertex positions.
    let depth = target(gpu, images, "bent: depth", DEPTH_FORMAT);
    // A geometry without faces has no normals to bend by.
    let no_faces = no_faces_for(gpu, scene);
    lights
        .iter()
        .map(|light| {
            let view = target(gpu, images, "bent", BENT_FORMAT);
            let groups = draw_groups(gpu, scene, &receivers, &pipelines.light_layout, light, &no_faces);
            let mut pass = begin_pass(encoder, &view, &depth);
            pass.set_bind_group(0, &view_group, &[]);
            for (draw, draw_group, light_group) in &groups {
                pass.set_pipeline(if scene.is_masked(draw) { &pipelines.masked } else { &pipelines.solid });
                pass.set_bind_group(1, draw_group, &[]);
                pass.set_bind_group(2, light_group, &[]);
                let instances = draw.first_instance..draw.first_instance + draw.instance_count;
                pass.draw(scene.geometries[draw.geometry].corners(), instances);
            }
            drop(pass);
            view
        })
        .collect()
}

struct Pipelines {
    light_layout: wgpu::BindGroupLayout,
    solid: wgpu::RenderPipeline,
    masked: wgpu::RenderPipeline,
}

impl Pipelines {
    fn new(device: &wgpu::Device, receivers: &ReceiverPass) -> Self {
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let vertex = wgpu::ShaderStages::VERTEX;
        let light_layout = programs::create_bind_group_layout(
            device,
            &wgpu::BindGroupLayoutDescriptor {
                label: Some("bent: light"),
                entries: &[
                    buffer_entry(0, vertex, wgpu::BufferBindingType::Uniform),
                    buffer_entry(1, vertex, storage),
                    buffer_entry(2, vertex, storage),
                ],
            },
        );
        let layout = programs::create_pipeline_layout(
            device,
            &wgpu::PipelineLayoutDescriptor {
                label: Some("bent"),
                bind_group_layouts: &[Some(&receivers.view_layout), Some(&receivers.draw_layout), Some(&light_layout)],
                immediate_size: 0,
            },
        );
        let source = [RECEIVERS_WGSL, IRRADIANCE_WGSL, include_str!("bent.wgsl")].concat();
        let module = programs::create_shader_module(device, "bent", source.into());
        let targets = [Some(BENT_FORMAT.into())];
        let pipeline = |fragment| draw_pipeline(device, &layout, &module, "vertex_bent", fragment, &targets);
        let (solid, masked) = (pipeline("fragment_bent_solid"), pipeline("fragment_bent_masked"));
        Self { light_layout, solid, masked }
    }
}

/// Creates an image of the receivers' size to draw to.
fn target(gpu: &Gpu, images: &ReceiverImages, label: &str, format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: images.size_px.x, height: images.size_px.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Bind groups of each draw: its own group, and the light's with the faces of its geometry.
fn draw_groups<'s>(
    gpu: &Gpu,
    scene: &'s GpuScene,
    receivers: &ReceiverPass,
    light_layout: &wgpu::BindGroupLayout,
    light: &LightBuffers,
    no_faces: &wgpu::Buffer,
) -> Vec<(&'s Draw, wgpu::BindGroup, wgpu::BindGroup)> {
    let uniform = uniform_buffer(gpu.device(), "bent: light", light.uniform_bytes());
    let groups = scene.draws.iter().map(|draw| {
        let faces = scene.geometries[draw.geometry].faces.as_ref().unwrap_or(no_faces);
        let buffers = [uniform.as_entire_binding(), light.points.as_entire_binding(), faces.as_entire_binding()];
        let light_group = super::bind_group(gpu, "bent: light", light_layout, buffers);
        (draw, receivers.draw_group(gpu, scene, draw), light_group)
    });
    groups.collect()
}

/// Begins the pass, which clears to white: nothing is bent where nothing is drawn.
fn begin_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    view: &wgpu::TextureView,
    depth: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("bent"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Creates a buffer of zeros for the largest number of vertices of any geometry: no normals at all.
fn no_faces_for(gpu: &Gpu, scene: &GpuScene) -> wgpu::Buffer {
    let lacking = scene.geometries.iter().filter(|geometry| geometry.faces.is_none());
    let vertices = lacking.map(|geometry| scene.buffers_of(geometry).positions.size() / 12).max().unwrap_or(0);
    gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("bent: no faces"),
        size: 4 * (vertices + 1),
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}
