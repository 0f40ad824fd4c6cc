//! Masks as Bevy's bindings can carry them: layers of a depth array of the view's size.
//!
//! The library writes 32-bit floats; Bevy's view has a place for an array of depth textures, that of its maps of spots and
//! suns, and both hold numbers from 0 to 1 as well. So each channel of each light's mask is drawn into a layer, by a pass that
//! writes depth alone, and that array is bound in the maps' place. No layout changes, and no bind group is added.

use antumbra::{Mask, MaskChannels};
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::pbr::ViewShadowBindings;
use bevy::prelude::*;
use bevy::render::render_resource::TextureView;
use bevy::render::view::{ExtractedView, Msaa};

use crate::draw::Shadows;
use crate::lights::MaskLayers;
use crate::warnings::Warnings;

/// What the array is made of; the library's masks are of as many bits.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A view's masks: layers of all lights, one behind the other. Of a view of several samples a pixel first the depths of its
/// two pictures, then the masks of the one, then those of the other.
pub struct ViewMasks {
    pub size_px: glam::UVec2,
    samples: u32,
    layers: Vec<wgpu::TextureView>,
    /// All layers, for Bevy.
    array: TextureView,
    /// The frame in which the view was last there.
    pub seen: u64,
}

impl ViewMasks {
    /// With room for `mask_layers` of each picture.
    fn new(device: &wgpu::Device, size_px: glam::UVec2, mask_layers: u32, samples: u32) -> Self {
        let layer_count = if samples > 1 { 2 + 2 * mask_layers } else { mask_layers };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("bevy_antumbra masks"),
            size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: layer_count },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |dimension, first, count| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("bevy_antumbra masks"),
                dimension: Some(dimension),
                base_array_layer: first,
                array_layer_count: Some(count),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let layers = (0..layer_count).map(|layer| view(wgpu::TextureViewDimension::D2, layer, 1)).collect();
        let array = TextureView::from(view(wgpu::TextureViewDimension::D2Array, 0, layer_count));
        Self { size_px, samples, layers, array, seen: 0 }
    }

    /// How many layers there are for each picture's masks.
    fn mask_layers(&self) -> u32 {
        let all = self.layers.len() as u32;
        if self.samples > 1 { (all - 2) / 2 } else { all }
    }

    /// Where a mask of a picture lies.
    pub fn layer_of(&self, picture: u32, mask: u32) -> u32 {
        if self.samples > 1 { 2 + picture * self.mask_layers() + mask } else { mask }
    }

    /// The depth of the nearest surfaces, where pixels have several samples.
    pub fn depth_layer(&self) -> Option<&wgpu::TextureView> {
        self.layers.first().filter(|_| self.samples > 1)
    }
}

/// A mask that the library writes, from which layers are drawn; lights of a view share it, one after the other.
pub struct ScratchMask {
    pub mask: Mask,
    groups: Vec<wgpu::BindGroup>,
}

/// A group that is kept as long as it is of the same view.
pub type KeptGroup = Option<(wgpu::TextureView, wgpu::BindGroup)>;

/// Draws masks into layers.
pub struct MaskWriter {
    device: wgpu::Device,
    pipeline: wgpu::RenderPipeline,
}

impl MaskWriter {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bevy_antumbra masks"),
            source: wgpu::ShaderSource::Wgsl(include_str!("masks.wgsl").into()),
        });
        let group_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("bevy_antumbra masks"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("bevy_antumbra masks"),
            bind_group_layouts: &[Some(&group_layout)],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("bevy_antumbra masks"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("cover"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("write"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { device: device.clone(), pipeline }
    }

    /// A scratch mask of a size.
    pub fn scratch(&self, size_px: glam::UVec2, channels: MaskChannels) -> ScratchMask {
        let mask = Mask::with_channels(&self.device, size_px, channels);
        let group = |layer| {
            let view = mask.texture().create_view(&wgpu::TextureViewDescriptor {
                label: Some("bevy_antumbra mask"),
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            });
            self.group(&view)
        };
        let groups = (0..channels.count()).map(group).collect();
        ScratchMask { mask, groups }
    }

    fn group(&self, from: &wgpu::TextureView) -> wgpu::BindGroup {
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("bevy_antumbra mask"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(from) }],
        })
    }

    /// Draws a mask's channels into layers from `first` on; without a mask, light everywhere.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        masks: &ViewMasks,
        layers: std::ops::Range<u32>,
        mask: Option<&ScratchMask>,
    ) {
        for (i, layer) in layers.enumerate() {
            self.draw(encoder, masks, layer, mask.and_then(|mask| mask.groups.get(i)));
        }
    }

    /// Draws what a texture of floats holds, 0 to 1, into a layer.
    pub fn record_view(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        masks: &ViewMasks,
        layer: u32,
        from: &wgpu::TextureView,
        kept: &mut KeptGroup,
    ) {
        let of_from = kept.take().filter(|(of, _)| of == from);
        let (_, group) = kept.insert(of_from.unwrap_or_else(|| (from.clone(), self.group(from))));
        self.draw(encoder, masks, layer, Some(group));
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, masks: &ViewMasks, layer: u32, group: Option<&wgpu::BindGroup>) {
        let Some(view) = masks.layers.get(layer as usize) else { return };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("bevy_antumbra masks"),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        if let Some(group) = group {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// Puts each view's masks where Bevy's own maps would be bound. After Bevy has made those, and before its bind groups.
pub fn bind_masks(
    shadows: Option<ResMut<Shadows>>,
    layers: Res<MaskLayers>,
    mut warnings: ResMut<Warnings>,
    mut views: Query<(Entity, &ExtractedView, &mut ViewShadowBindings, Has<DepthPrepass>, &Msaa)>,
) {
    let Some(mut shadows) = shadows else { return };
    let shadows = &mut *shadows;
    shadows.frame += 1;
    if layers.count == 0 {
        return;
    }
    for (entity, view, mut bindings, has_depth, msaa) in &mut views {
        if !has_depth || !matches!(msaa.samples(), 1 | 4) {
            let what = if has_depth { "2 or 8 samples a pixel" } else { "no DepthPrepass" };
            let remedy = if has_depth { "Msaa::Sample4 or Msaa::Off" } else { "one" };
            warnings.say(format!("a camera has {what} and so no soft shadows: give it {remedy}"));
            continue;
        }
        let size_px = glam::UVec2::new(view.viewport.z, view.viewport.w);
        if size_px.min_element() == 0 {
            continue;
        }
        let samples = msaa.samples();
        let fits = |masks: &ViewMasks| {
            masks.size_px == size_px && masks.samples == samples && masks.mask_layers() >= layers.count
        };
        let device = shadows.gpu.device();
        let masks = match shadows.views.remove(&entity).filter(fits) {
            Some(masks) => masks,
            // Lights come and go: some layers to spare.
            None => {
                let mask_layers = layers.count.next_multiple_of(4).min(crate::lights::MAX_LAYERS);
                ViewMasks::new(device, size_px, mask_layers, samples)
            }
        };
        bindings.directional_light_depth_texture_view = masks.array.clone();
        shadows.views.insert(entity, ViewMasks { seen: shadows.frame, ..masks });
    }
    let frame = shadows.frame;
    shadows.views.retain(|_, masks| masks.seen + 8 > frame);
}
