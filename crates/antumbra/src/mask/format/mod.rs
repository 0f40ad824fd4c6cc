//! Conversion of 32-bit masks to the host's formats of fewer bits.

use std::sync::Arc;

use crate::contract::{Mask, MaskChannels};
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, color_pipeline, texels};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Instance of `draw.wesl` that writes three layers as red, green and blue.
const ALL_LAYERS: u32 = 3;

bindings! {
    struct WideMask = "narrow mask", VERTEX_FRAGMENT, group 0 of [FORMAT_DRAW] {
        0 wide: TextureArray(texels::FLOAT),
    }
}

/// Conversion pass to a host's mask.
#[derive(Clone, Debug)]
pub(crate) struct NarrowMask {
    /// Mask texture that techniques write. Lights share it: each light's commands fill and read it before another light's do.
    scratch: Arc<wgpu::Texture>,
    wide: Mask,
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    /// Layers of the host's texture, and the instance that draws each.
    targets: Vec<(wgpu::TextureView, u32)>,
}

impl NarrowMask {
    /// Whether a mask needs a conversion.
    pub(crate) fn serves(mask: &Mask) -> bool {
        mask.texture().format() != Mask::FORMAT
    }

    /// Prepares the conversion to `mask`. `earlier` is the previous frame's.
    pub(crate) fn prepare(stage: &Stage<'_>, mask: &Mask, earlier: Option<Self>) -> Self {
        let descriptor = wgpu::TextureDescriptor {
            label: Some("antumbra mask of 32 bits"),
            size: wgpu::Extent3d {
                width: mask.size_px().x,
                height: mask.size_px().y,
                depth_or_array_layers: mask.channels().count(),
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Mask::FORMAT,
            usage: Mask::usages(Mask::FORMAT),
            view_formats: &[],
        };
        let scratch = stage.device.scratch_texture(Scratch::WideMask, &descriptor);
        let wide = earlier
            .filter(|earlier| earlier.scratch == scratch)
            .map_or_else(|| Mask::of_own_layers(&scratch, 0, mask.channels()), |earlier| earlier.wide);
        let layout = WideMask::layout(stage);
        Self {
            pipeline: pipeline(stage, &layout, mask),
            group: WideMask { wide: wide.layers_view() }.group(stage, &layout),
            targets: targets(stage, mask),
            scratch,
            wide,
        }
    }

    /// Mask that the technique writes.
    pub(crate) fn wide(&self) -> &Mask {
        &self.wide
    }

    /// Draws the host's mask.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, mask: &Mask) {
        let place = mask.place();
        let (origin, size) = (place.origin_px.as_vec2(), place.size_px.as_vec2());
        for (i, (target, instance)) in self.targets.iter().enumerate() {
            recorder.color_pass("mask of fewer bits", Span::of(i, self.targets.len()), &[target], |pass| {
                pass.set_viewport(origin.x, origin.y, size.x, size.y, 0.0, 1.0);
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &self.group, &[]);
                pass.draw(0..3, *instance..*instance + 1);
            });
        }
    }
}

/// Returns the colour components that a mask is written to.
fn write_mask(mask: &Mask) -> wgpu::ColorWrites {
    let has_one = mask.texture().format().components() == 1;
    match mask.channels() {
        MaskChannels::Three if !has_one => wgpu::ColorWrites::COLOR,
        MaskChannels::One | MaskChannels::Three => {
            [wgpu::ColorWrites::RED, wgpu::ColorWrites::GREEN, wgpu::ColorWrites::BLUE, wgpu::ColorWrites::ALPHA]
                [mask.place().component as usize]
        }
    }
}

fn pipeline(gpu: &Gpu, layout: &wgpu::BindGroupLayout, mask: &Mask) -> wgpu::RenderPipeline {
    let target = wgpu::ColorTargetState { format: mask.texture().format(), blend: None, write_mask: write_mask(mask) };
    color_pipeline(gpu, "antumbra narrow mask", shaders::FORMAT_DRAW, layout, &[Some(target)])
}

/// Returns the layers to draw to, and the instance that draws each.
fn targets(stage: &Stage<'_>, mask: &Mask) -> Vec<(wgpu::TextureView, u32)> {
    let instances = match mask.channels() {
        MaskChannels::One => 0..1,
        MaskChannels::Three if mask.texture().format().components() == 1 => 0..3,
        MaskChannels::Three => ALL_LAYERS..ALL_LAYERS + 1,
    };
    (mask.place().layer..)
        .zip(instances)
        .map(|(base_array_layer, instance)| {
            let view = stage.create_view(
                mask.texture(),
                &wgpu::TextureViewDescriptor {
                    label: Some("antumbra mask"),
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    mip_level_count: Some(1),
                    base_array_layer,
                    array_layer_count: Some(1),
                    ..wgpu::TextureViewDescriptor::default()
                },
            );
            (view, instance)
        })
        .collect()
}
