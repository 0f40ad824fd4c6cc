//! Rasterises casters into a light's depth map: opaque ones from positions alone, cut-out ones with a texture lookup.
//!
//! All faces are drawn: open meshes cast from both sides, and the receiver-plane comparison needs no help from culling.

use std::num::NonZeroU64;

use glam::{Mat4, Vec4};

use crate::contract::{MeshCaster, Opacity};
use crate::gpu::{Gpu, gpu_structs, shader_module};
use crate::shaders;

gpu_structs! {
    /// The view that a pass renders.
    pub(crate) struct CasterView {
        clip_from_world: Mat4,
    }

    /// Where a surface has holes.
    pub(crate) struct Cutout {
        /// Multiplies the texture.
        factor: Vec4,
        /// Coverage below this is a hole.
        cutoff: f32,
        /// 0: coverage is alpha. 1: coverage is the share of white light that the surface stops.
        stops_light: u32,
        /// The texture's alpha is not opacity.
        texture_tints_only: u32,
        padding: u32,
    }
}

/// Dynamic uniform offsets are multiples of WebGPU's default alignment.
const UNIFORM_STRIDE: u64 = 256;

/// The light that a tinted surface must stop to count as opaque for techniques that know no other: half.
const TINTED_COUNTS_AS_OPAQUE: f32 = 0.5;

/// Rasterises casters into depth maps.
#[derive(Debug)]
pub(crate) struct CasterDepth {
    view_layout: wgpu::BindGroupLayout,
    cutout_layout: wgpu::BindGroupLayout,
    opaque: wgpu::RenderPipeline,
    cutout: wgpu::RenderPipeline,
    white: wgpu::TextureView,
    sampler: wgpu::Sampler,
    views: Option<(wgpu::Buffer, wgpu::BindGroup)>,
    /// One a caster; `None` where it is opaque.
    cutouts: Vec<Option<wgpu::BindGroup>>,
    /// Zero texture coordinates for tinted casters without a texture.
    no_uvs: Option<wgpu::Buffer>,
}

impl CasterDepth {
    /// The maps' format: 32-bit float, reversed.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// What a map is cleared to: the far plane.
    pub(crate) const CLEAR_DEPTH: f32 = 0.0;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self::multisampled(gpu, 1)
    }

    /// For maps with `sample_count` samples a texel.
    pub(crate) fn multisampled(gpu: &Gpu, sample_count: u32) -> Self {
        let view_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra caster view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: NonZeroU64::new(size_of::<CasterView>() as u64),
                },
                count: None,
            }],
        });
        let fragment_entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let cutout_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra cut-out"),
            entries: &[
                crate::gpu::uniform_entry(0, wgpu::ShaderStages::FRAGMENT),
                fragment_entry(
                    1,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
                fragment_entry(2, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        });
        let opaque =
            pipeline(gpu, "antumbra caster depth", shaders::CASTER_DEPTH_OPAQUE, &[&view_layout], false, sample_count);
        let cutout = pipeline(
            gpu,
            "antumbra caster depth cut-out",
            shaders::CASTER_DEPTH_CUTOUT,
            &[&view_layout, &cutout_layout],
            true,
            sample_count,
        );
        let white = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra white"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        gpu.queue.write_texture(
            white.as_image_copy(),
            &[255; 4],
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None },
            wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        );
        Self {
            view_layout,
            cutout_layout,
            opaque,
            cutout,
            white: white.create_view(&wgpu::TextureViewDescriptor::default()),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
            views: None,
            cutouts: Vec::new(),
            no_uvs: None,
        }
    }

    /// Uploads the views that the frame's passes will render, and the casters' surfaces.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, clip_from_world: &[Mat4], casters: &[MeshCaster<'_>]) {
        let needed = clip_from_world.len() as u64 * UNIFORM_STRIDE;
        if self.views.as_ref().is_none_or(|(buffer, _)| buffer.size() < needed) {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra caster views"),
                size: needed,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra caster views"),
                layout: &self.view_layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &buffer,
                        offset: 0,
                        size: NonZeroU64::new(size_of::<CasterView>() as u64),
                    }),
                }],
            });
            self.views = Some((buffer, bind_group));
        }
        let mut bytes = vec![0u8; needed as usize];
        for (chunk, matrix) in bytes.chunks_exact_mut(UNIFORM_STRIDE as usize).zip(clip_from_world) {
            let view = CasterView { clip_from_world: *matrix };
            chunk[..size_of::<CasterView>()].copy_from_slice(bytemuck::bytes_of(&view));
        }
        let (buffer, _) = self.views.as_ref().expect("made above where it was missing");
        gpu.queue.write_buffer(buffer, 0, &bytes);

        self.cutouts = casters.iter().map(|caster| self.cutout_bind_group(gpu, &caster.opacity)).collect();
        let most_vertices = casters
            .iter()
            .filter(|caster| matches!(caster.opacity, Opacity::Tinted { texture: None, .. }))
            .map(|caster| caster.positions.size() / 12)
            .max()
            .unwrap_or(0);
        if most_vertices > 0 && self.no_uvs.as_ref().is_none_or(|buffer| buffer.size() < most_vertices * 8) {
            self.no_uvs = Some(gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra no texture coordinates"),
                size: most_vertices * 8,
                usage: wgpu::BufferUsages::VERTEX,
                mapped_at_creation: false,
            }));
        }
    }

    fn cutout_bind_group(&self, gpu: &Gpu, opacity: &Opacity<'_>) -> Option<wgpu::BindGroup> {
        let (texture, cutout) = match opacity {
            Opacity::Opaque => return None,
            Opacity::Masked { texture, alpha_factor, cutoff } => {
                (Some(texture), Cutout { factor: Vec4::splat(*alpha_factor), cutoff: *cutoff, ..Cutout::default() })
            }
            Opacity::Tinted { tint, texture, texture_tints_only } => (
                texture.as_ref(),
                Cutout {
                    factor: *tint,
                    cutoff: TINTED_COUNTS_AS_OPAQUE,
                    stops_light: 1,
                    texture_tints_only: (*texture_tints_only).into(),
                    padding: 0,
                },
            ),
        };
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("antumbra cut-out"),
            size: size_of::<Cutout>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(&cutout));
        Some(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra cut-out"),
            layout: &self.cutout_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(texture.map_or(&self.white, |t| t.view)),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::Sampler(texture.map_or(&self.sampler, |t| t.sampler)),
                },
            ],
        }))
    }

    /// Draws the prepared casters into a pass, as view `view_index` sees them.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view_index: u32, casters: &[MeshCaster<'_>]) {
        let Some((_, views)) = &self.views else { return };
        pass.set_bind_group(0, views, &[view_index * UNIFORM_STRIDE as u32]);
        for cut_out in [false, true] {
            pass.set_pipeline(if cut_out { &self.cutout } else { &self.opaque });
            for (caster, cutout) in casters.iter().zip(&self.cutouts) {
                if cutout.is_some() != cut_out || caster.index_count == 0 || caster.instance_count == 0 {
                    continue;
                }
                pass.set_vertex_buffer(0, caster.positions.slice(..));
                pass.set_vertex_buffer(1, caster.instances.slice(..));
                if let Some(cutout) = cutout {
                    pass.set_bind_group(1, cutout, &[]);
                    let uvs = match &caster.opacity {
                        Opacity::Masked { texture, .. } | Opacity::Tinted { texture: Some(texture), .. } => texture.uvs,
                        _ => self.no_uvs.as_ref().expect("made by prepare for casters like this"),
                    };
                    pass.set_vertex_buffer(2, uvs.slice(..));
                }
                pass.set_index_buffer(caster.indices.slice(..), wgpu::IndexFormat::Uint32);
                let instances = caster.first_instance..caster.first_instance + caster.instance_count;
                pass.draw_indexed(0..caster.index_count, 0, instances);
            }
        }
    }
}

fn pipeline(
    gpu: &Gpu,
    label: &str,
    wgsl: &'static str,
    layouts: &[&wgpu::BindGroupLayout],
    cut_out: bool,
    sample_count: u32,
) -> wgpu::RenderPipeline {
    let module = shader_module(gpu, label, wgsl);
    let bind_group_layouts: Vec<_> = layouts.iter().map(|layout| Some(*layout)).collect();
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &bind_group_layouts,
        immediate_size: 0,
    });
    let positions = wgpu::VertexBufferLayout {
        array_stride: 12,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3],
    };
    let instances = wgpu::VertexBufferLayout {
        array_stride: 64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Float32x4],
    };
    let uvs = wgpu::VertexBufferLayout {
        array_stride: 8,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![5 => Float32x2],
    };
    let buffers = [Some(positions), Some(instances), Some(uvs)];
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: if cut_out { &buffers } else { &buffers[..2] },
        },
        primitive: wgpu::PrimitiveState {
            // Casters nearer than the near plane, where the light's plane cuts them, are kept at it.
            unclipped_depth: gpu.has(wgpu::Features::DEPTH_CLIP_CONTROL),
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: CasterDepth::FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: sample_count, ..wgpu::MultisampleState::default() },
        fragment: cut_out.then(|| wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}
