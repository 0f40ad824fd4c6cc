//! Smoothing of one frame's noisy visibility over neighbouring pixels, for techniques that know how far their blockers are.
//!
//! ```text
//! technique, of each part of the light ──► visibility, least magnification ──► smooth ──► mask
//! ```
//!
//! `smooth.wesl`: a Gaussian mean over neighbours on the same surface, whose standard deviation is .06 of the penumbra's
//! width as the light's shape and the nearest blocker give it, 2 pixels at the most. Contacts, whose penumbrae are narrower than
//! a few pixels, stay as they are. Few rays with their noise spread as blue noise are enough under it. Source of the idea: the
//! filter widths of Mehta, Wang, Ramamoorthi 2012, "Axis-aligned filtering for interactive sampled soft shadows", here by the light's ellipse and with
//! neighbours in pairs, so that silhouettes and ramps have no bias.
//!
//! Per pixel: 4 bytes written and read, and the depth buffer once; in tiles that are not all of one visibility 24 pairs of
//! neighbours in workgroup memory. Unlike [`denoise`](super::denoise) it keeps nothing from frame to frame.
//!
//! Where a light is cut into parts, all of them write one texture and the pass follows the last: a mean that ended where a part does left
//! a line of noise there.

use std::sync::Arc;

use crate::contract::PreparedFrame;
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, passed_texture, texels};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Two half floats: `noisy.wesl`.
pub(crate) const NOISY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

bindings! {
    struct NoisyRead = "noisy visibility", COMPUTE, group 1 of [SMOOTHING_SMOOTH] {
        0 noisy: Texture(texels::UINT),
    }
}

/// The pass behind a technique's own.
#[derive(Debug)]
pub(crate) struct Smoothing {
    inputs: FrameInputs,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    /// Of the last frame. Each light's commands fill it and read it before another's do, so lights share it.
    noisy: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
}

/// The pass of one frame.
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

    /// Makes ready for a frame whose mask is of 32 bits.
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
    /// Where the technique writes.
    pub(crate) fn noisy(&self) -> &wgpu::TextureView {
        &self.noisy
    }

    /// Records that all is dark, before parts write what they reach.
    pub(crate) fn record_dark(&self, recorder: &mut Recorder<'_>) {
        recorder.clear("smooth", &self.noisy);
    }

    /// Records the way from noisy visibility into the mask.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("smooth", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, &self.group, &[]);
            self.inputs.dispatch(pass);
        });
    }
}
