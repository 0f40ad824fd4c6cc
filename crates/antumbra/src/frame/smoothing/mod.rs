//! Noisy visibility of one frame made smooth over neighbouring pixels, by a technique that knows how far its blockers are.
//!
//! ```text
//! resolve ──► visibility, least magnification ──► smooth ──► mask
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

use std::sync::Arc;

use glam::UVec2;

use super::inputs::{FrameInputs, PreparedInputs};
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, passed_texture, texels};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Two half floats: `noisy.wesl`.
const NOISY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

bindings! {
    /// Bind group 3 of passes that write noisy visibility.
    struct NoisyWritten = "noisy visibility, written", COMPUTE, group 3 of [SMRT_RESOLVE] {
        0 noisy: WrittenTexture(NOISY_FORMAT),
    }

    struct NoisyRead = "noisy visibility", COMPUTE, group 1 of [SMOOTHING_SMOOTH] {
        0 noisy: Texture(texels::UINT),
    }
}

/// The pass that follows a technique's own over the receivers.
#[derive(Debug)]
pub(crate) struct Smoothing {
    written_layout: wgpu::BindGroupLayout,
    read_layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    /// Of the last frame. Each light's commands fill it and read it before another's do, so lights share it.
    noisy: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
}

/// The pass of one frame.
#[derive(Debug)]
pub(crate) struct PreparedSmoothing {
    /// Bind group 3 of the technique's pass.
    pub(crate) written: wgpu::BindGroup,
    /// Where the frame is smoothed.
    read: Option<(wgpu::ComputePipeline, wgpu::BindGroup)>,
}

impl Smoothing {
    pub(crate) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let read_layout = NoisyRead::layout(gpu);
        Self {
            written_layout: Self::written_layout(gpu),
            pipeline: compute_pipeline(gpu, "smooth", shaders::SMOOTHING_SMOOTH, &[&inputs.layout, &read_layout]),
            read_layout,
            noisy: None,
        }
    }

    /// Of bind group 3 of the technique's pass.
    pub(crate) fn written_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        NoisyWritten::layout(gpu)
    }

    /// Makes ready for a frame of so many pixels; where it `is_on`, the technique's pass writes noisy visibility, else the mask.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, size_px: UVec2, is_on: bool) -> PreparedSmoothing {
        let size_px = if is_on { size_px } else { UVec2::ONE };
        let scratch = stage.device.scratch_texture(
            Scratch::NoisyVisibility,
            &passed_texture("antumbra noisy visibility", NOISY_FORMAT, size_px, 1),
        );
        let made = self.noisy.take().filter(|(texture, _)| *texture == scratch);
        let (_, noisy) = self.noisy.insert(made.unwrap_or_else(|| {
            let view = stage.create_view(&scratch, &wgpu::TextureViewDescriptor::default());
            (scratch, view)
        }));
        PreparedSmoothing {
            written: NoisyWritten { noisy }.group(stage, &self.written_layout),
            read: is_on.then(|| (self.pipeline.clone(), NoisyRead { noisy }.group(stage, &self.read_layout))),
        }
    }
}

impl PreparedSmoothing {
    /// Records the way from noisy visibility into the mask, where the frame has such.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, inputs: &PreparedInputs) {
        let Some((pipeline, read)) = &self.read else { return };
        recorder.compute("smooth", Span::Only, |pass| {
            pass.set_pipeline(pipeline);
            inputs.bind(pass);
            pass.set_bind_group(1, read, &[]);
            inputs.dispatch(pass);
        });
    }
}
