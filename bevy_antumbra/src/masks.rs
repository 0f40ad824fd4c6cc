//! Masks in a form that Bevy's bindings can carry: layers of a depth array.
//!
//! The library writes 32-bit floats. Bevy's view binds an array of depth textures, its shadow maps of spots and suns, and both
//! hold values from 0 to 1. So a depth-only pass draws each channel of each light's mask into a layer, and that array is bound
//! in place of the maps. No layout changes, and no bind group is added.
//!
//! The array has the view's size, unless Bevy draws maps of its own. In that case it has the maps' size, its first layers are
//! copies of them, and the mask of a larger view is cut into tiles. Masks are numbered from the last layer backwards, because
//! the shader does not know the number of maps.

use antumbra::{Mask, MaskChannels};
use bevy::render::render_resource::TextureView;

/// Format of the array. It has as many bits as the library's masks, and Bevy's maps use it, too.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Masks of a view: one slot per light's mask channel. With several samples per pixel, the depths of both images come first,
/// then for each mask a slot per image.
pub struct ViewMasks {
    pub shape: Shape,
    layers: Vec<wgpu::TextureView>,
    /// View of all layers, for Bevy.
    pub array: TextureView,
    /// Bevy's own maps, which are copied to the first layers.
    pub maps: Option<Maps>,
    /// Frame in which the view was last rendered.
    pub seen: u64,
}

/// Dimensions of an array of masks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Size of the view.
    pub size_px: glam::UVec2,
    pub samples: u32,
    /// Size of a layer; the view is cut into tiles of this size.
    pub tile_px: glam::UVec2,
    pub map_count: u32,
    /// Number of mask slots of each image.
    pub mask_count: u32,
    pub max_layers: u32,
}

/// Bevy's own shadow maps.
pub struct Maps {
    pub texture: wgpu::Texture,
    group: wgpu::BindGroup,
}

impl Shape {
    /// Returns the number of tiles of a slot along both sides of the view.
    pub fn tiles(&self) -> glam::UVec2 {
        (self.size_px + self.tile_px - 1) / self.tile_px
    }

    pub fn slot_count(&self) -> u32 {
        if self.samples > 1 { 2 + 2 * self.mask_count } else { self.mask_count }
    }

    /// Returns the number of layers, limited by the device. Masks beyond it are treated as absent.
    fn layer_count(&self) -> u32 {
        (self.map_count + self.slot_count() * self.tiles().element_product()).min(self.max_layers)
    }

    /// Whether an array of this shape can hold the masks of another.
    pub fn serves(&self, other: &Self) -> bool {
        self.mask_count >= other.mask_count && Self { mask_count: other.mask_count, ..*self } == *other
    }

    /// Returns a slot's layers, each with the first pixel of the view that it holds.
    fn tiles_of(self, slot: u32) -> impl Iterator<Item = (u32, glam::UVec2)> {
        let (tiles, layers) = (self.tiles(), self.layer_count());
        (0..tiles.element_product()).filter_map(move |tile| {
            let layer = layers.checked_sub(1 + slot * tiles.element_product() + tile)?;
            let first_px = glam::UVec2::new(tile % tiles.x, tile / tiles.x) * self.tile_px;
            (layer >= self.map_count).then_some((layer, first_px))
        })
    }
}

impl ViewMasks {
    pub fn new(device: &wgpu::Device, shape: Shape) -> Self {
        let layer_count = shape.layer_count();
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("bevy_antumbra masks"),
            size: wgpu::Extent3d {
                width: shape.tile_px.x,
                height: shape.tile_px.y,
                depth_or_array_layers: layer_count,
            },
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
        Self { shape, layers, array, maps: None, seen: 0 }
    }

    /// Returns the slot of an image's mask.
    pub fn slot_of(&self, picture: u32, mask: u32) -> u32 {
        if self.shape.samples > 1 { 2 + 2 * mask + picture } else { mask }
    }

    /// Returns the depth of the nearest surfaces, if pixels have several samples and one layer holds all of the view.
    pub fn depth_layer(&self) -> Option<&wgpu::TextureView> {
        let is_whole = self.shape.samples > 1 && self.shape.tiles() == glam::UVec2::ONE;
        self.layers.last().filter(|_| is_whole)
    }

    /// Whether the view has masks at all: none with 2 or 8 samples per pixel.
    pub fn has_masks(&self) -> bool {
        matches!(self.shape.samples, 1 | 4)
    }
}

/// Mask that the library writes and that is drawn into layers. Lights of a view share it, one after the other.
pub struct ScratchMask {
    pub mask: Mask,
    groups: Vec<wgpu::BindGroup>,
}

/// Bind group, cached as long as the bound view is the same.
pub type CachedGroup = Option<(wgpu::TextureView, wgpu::BindGroup)>;

/// Pipelines that draw masks into layers.
pub struct MaskWriter {
    device: wgpu::Device,
    of_masks: wgpu::RenderPipeline,
    of_maps: wgpu::RenderPipeline,
}

/// Clear value of a mask layer: fully lit.
const LIGHT: f32 = 1.0;
/// Clear value of a depth layer: no surface.
const NOTHING: f32 = 0.0;

impl MaskWriter {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bevy_antumbra masks"),
            source: wgpu::ShaderSource::Wgsl(include_str!("masks.wgsl").into()),
        });
        let texture = |binding, sample_type, view_dimension| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false },
            count: None,
        };
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let mask = texture(0, float, wgpu::TextureViewDimension::D2);
        let maps = texture(1, wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array);
        Self {
            device: device.clone(),
            of_masks: pipeline(device, &module, "write", mask),
            of_maps: pipeline(device, &module, "copy_map", maps),
        }
    }

    /// Creates a scratch mask of a size.
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
            layout: &self.of_masks.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(from) }],
        })
    }

    pub fn maps(&self, texture: &wgpu::Texture) -> Maps {
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("bevy_antumbra maps"),
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            aspect: wgpu::TextureAspect::DepthOnly,
            ..wgpu::TextureViewDescriptor::default()
        });
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("bevy_antumbra maps"),
            layout: &self.of_maps.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&view) }],
        });
        Maps { texture: texture.clone(), group }
    }

    /// Draws a mask's channels into slots; without a mask, fully lit.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        masks: &ViewMasks,
        slots: impl Iterator<Item = u32>,
        mask: Option<&ScratchMask>,
    ) {
        for (i, slot) in slots.enumerate() {
            self.draw(encoder, masks, slot, mask.and_then(|mask| mask.groups.get(i)));
        }
    }

    /// Draws the depth of one of the view's images into its slot.
    pub fn record_view(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        masks: &ViewMasks,
        picture: u32,
        from: &wgpu::TextureView,
        kept: &mut CachedGroup,
    ) {
        let of_from = kept.take().filter(|(of, _)| of == from);
        let (_, group) = kept.insert(of_from.unwrap_or_else(|| (from.clone(), self.group(from))));
        self.draw(encoder, masks, picture, Some(group));
    }

    /// Draws the other layers: copies of Bevy's own maps and, if the view has no masks, depths that match no fragment, which
    /// tells the shader so.
    pub fn record_others(&self, encoder: &mut wgpu::CommandEncoder, masks: &ViewMasks) {
        if let Some(maps) = &masks.maps {
            for (layer, view) in (0..masks.shape.map_count).zip(&masks.layers) {
                let mut pass = begin(encoder, view, NOTHING);
                pass.set_pipeline(&self.of_maps);
                pass.set_bind_group(0, &maps.group, &[]);
                pass.draw(0..3, layer..layer + 1);
            }
        }
        if !masks.has_masks() {
            let layers = (0..2).flat_map(|slot| masks.shape.tiles_of(slot));
            for (layer, _) in layers {
                begin(encoder, &masks.layers[layer as usize], NOTHING);
            }
        }
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, masks: &ViewMasks, slot: u32, group: Option<&wgpu::BindGroup>) {
        for (layer, first_px) in masks.shape.tiles_of(slot) {
            let mut pass = begin(encoder, &masks.layers[layer as usize], LIGHT);
            if let Some(group) = group {
                let size_px = masks.shape.tile_px.min(masks.shape.size_px - first_px);
                pass.set_scissor_rect(0, 0, size_px.x, size_px.y);
                pass.set_pipeline(&self.of_masks);
                pass.set_bind_group(0, group, &[]);
                let part = first_px.x | first_px.y << 16;
                pass.draw(0..3, part..part + 1);
            }
        }
    }
}

fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, view: &wgpu::TextureView, clear: f32) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("bevy_antumbra masks"),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    reads: wgpu::BindGroupLayoutEntry,
) -> wgpu::RenderPipeline {
    let group_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("bevy_antumbra masks"),
        entries: &[reads],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("bevy_antumbra masks"),
        bind_group_layouts: &[Some(&group_layout)],
        ..wgpu::PipelineLayoutDescriptor::default()
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("bevy_antumbra masks"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
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
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: Shape = Shape {
        size_px: glam::UVec2::new(1920, 1080),
        samples: 1,
        tile_px: glam::UVec2::splat(1024),
        map_count: 5,
        mask_count: 2,
        max_layers: 256,
    };

    #[test]
    fn slots_fill_the_array_from_behind_and_leave_maps_alone() {
        assert_eq!((SHAPE.tiles(), SHAPE.layer_count()), (glam::UVec2::splat(2), 5 + 2 * 4));
        let of_slot = |slot| SHAPE.tiles_of(slot).collect::<Vec<_>>();
        let at = |x, y| glam::UVec2::new(x, y);
        assert_eq!(of_slot(0), [(12, at(0, 0)), (11, at(1024, 0)), (10, at(0, 1024)), (9, at(1024, 1024))]);
        assert_eq!(of_slot(1).iter().map(|(layer, _)| *layer).collect::<Vec<_>>(), [8, 7, 6, 5]);
        assert_eq!(of_slot(2), [], "these layers contain the maps");
    }

    #[test]
    fn what_has_no_room_is_left_out() {
        let few = Shape { max_layers: 10, ..SHAPE };
        assert_eq!(few.layer_count(), 10);
        assert_eq!(few.tiles_of(0).count() + few.tiles_of(1).count(), 5);
        let four_samples = Shape { samples: 4, ..SHAPE };
        assert_eq!(four_samples.slot_count(), 6);
    }
}
