//! Smoothing of one frame's noisy visibility over neighbouring pixels, for techniques that know the distance of their blockers.
//!
//! ```text
//! technique, of each part of the light ──► visibility, least magnification ──► smooth ──► mask
//! ```
//!
//! `smooth.wesl` computes a Gaussian mean over neighbours on the same surface. Its standard deviation is .06 of the penumbra's width, which
//! follows from the light's shape and the nearest blocker, and at most 2 pixels. Contacts, whose penumbrae are narrower than a few pixels,
//! are unchanged. With noise spread as blue noise, few rays are enough. Source of the idea: the filter widths of Mehta, Wang, Ramamoorthi
//! 2012, "Axis-aligned filtering for interactive sampled soft shadows", here with the light's ellipse and neighbours in pairs, so that
//! silhouettes and ramps have no bias.
//!
//! Cost per pixel: 4 bytes written and read, and one read of the depth buffer; in tiles of differing visibility, 24 pairs
//! of neighbours in workgroup memory. Unlike [`denoise`](super::denoise) it keeps no state between frames.
//!
//! If a light has several parts, all write one texture and the pass follows the last: means that end at a part's edge leave a line of
//! noise there.

use std::sync::Arc;

use crate::contract::PreparedFrame;
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, passed_texture, texels};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Texel format: two half floats, see `noisy.wesl`.
pub(crate) const NOISY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

bindings! {
    struct NoisyRead = "noisy visibility", COMPUTE, group 1 of [SMOOTHING_SMOOTH] {
        0 noisy: Texture(texels::UINT),
    }
}

/// Smoothing pass that follows a technique.
#[derive(Debug)]
pub(crate) struct Smoothing {
    inputs: FrameInputs,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    /// Texture of the last frame. Lights share it: each light's commands fill and read it before another light's do.
    noisy: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
}

/// Smoothing pass of one frame.
#[derive(Debug)]
pub(crate) struct PreparedSmoothing {
    inputs: PreparedInputs,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    noisy: wgpu::TextureView,
}

impl Smoothing {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let inputs = FrameInputs::new(gpu);
        let layout = NoisyRead::layout(gpu);
        let pipeline = compute_pipeline(gpu, "smooth", shaders::SMOOTHING_SMOOTH, &[&inputs.layout, &layout]);
        Self { inputs, layout, pipeline, noisy: None }
    }

    /// Prepares a frame whose mask has 32 bits.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, frame: &PreparedFrame<'_>) -> PreparedSmoothing {
        let mut descriptor = passed_texture("antumbra noisy visibility", NOISY_FORMAT, frame.receivers.size_px, 1);
        descriptor.usage |= wgpu::TextureUsages::RENDER_ATTACHMENT;
        let scratch = stage.device.scratch_texture(Scratch::NoisyVisibility, &descriptor);
        let made = self.noisy.take().filter(|(texture, _)| *texture == scratch);
        let (_, noisy) = self.noisy.insert(made.unwrap_or_else(|| {
            let view = stage.create_view(&scratch, &wgpu::TextureViewDescriptor::default());
            (scratch, view)
        }));
        PreparedSmoothing {
            inputs: self.inputs.prepare(stage, frame),
            pipeline: self.pipeline.clone(),
            group: NoisyRead { noisy }.group(stage, &self.layout),
            noisy: noisy.clone(),
        }
    }
}

impl PreparedSmoothing {
    /// Texture that the technique writes.
    pub(crate) fn noisy(&self) -> &wgpu::TextureView {
        &self.noisy
    }

    /// Records a clear to dark, before the light's parts write the pixels that they cover.
    pub(crate) fn record_dark(&self, recorder: &mut Recorder<'_>) {
        recorder.clear("smooth", &self.noisy);
    }

    /// Records the pass from noisy visibility to the mask.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("smooth", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, &self.group, &[]);
            self.inputs.dispatch(pass);
        });
    }
}
