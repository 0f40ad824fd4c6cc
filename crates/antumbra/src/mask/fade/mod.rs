//! Fade of shadows that end at a distance from the camera: the last pass over the receivers, of frames with
//! [such a distance](crate::Receivers::shadow_distance).
//!
//! What lies beyond the end is in no part of the light, so that no technique runs for it and the mask is dark there; here it becomes lit.
//!
//! Per pixel: the depth buffer and, where shadows fade, the mask are read and written once.

use antumbra_light::ShadowDistance;

use crate::contract::PreparedFrame;
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, gpu_structs};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

bindings! {
    struct FadeInputs = "fade", COMPUTE, group 1 of [FADE] {
        0 fade: Storage,
    }
}

gpu_structs! {
    /// Where shadows fade.
    pub(crate) struct FadeGpu {
        /// From here on, metres from the eye.
        begin_m: f32,
        /// Over so many metres.
        length_m: f32,
        padding_0: f32,
        padding_1: f32,
    }
}

/// The pass.
#[derive(Debug)]
pub(crate) struct Fade {
    inputs: FrameInputs,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// The pass of one frame.
#[derive(Debug)]
pub(crate) struct PreparedFade {
    inputs: PreparedInputs,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl Fade {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let inputs = FrameInputs::new(gpu);
        let layout = FadeInputs::layout(gpu);
        let pipeline = compute_pipeline(gpu, "fade", shaders::FADE, &[&inputs.layout, &layout]);
        Self { inputs, layout, pipeline }
    }

    /// Makes ready for a frame whose mask is of 32 bits.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        distance: &ShadowDistance,
    ) -> PreparedFade {
        let [begin_m, length_m] = distance.fade_span_m();
        let fade = FadeGpu { begin_m, length_m, padding_0: 0.0, padding_1: 0.0 };
        // No uniform, since drivers may compile for its values.
        let fade = stage.storage("antumbra fade", bytemuck::bytes_of(&fade));
        PreparedFade {
            inputs: self.inputs.prepare(stage, frame),
            pipeline: self.pipeline.clone(),
            group: FadeInputs { fade: &fade }.group(stage, &self.layout),
        }
    }
}

impl PreparedFade {
    /// Records the way of the mask into itself.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("fade", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, &self.group, &[]);
            self.inputs.dispatch(pass);
        });
    }
}
