//! Fade of shadows that end at a distance from the camera. It is the last pass over the receivers, in frames with a
//! [shadow distance](crate::Receivers::shadow_distance).
//!
//! Receivers beyond the end are in no part of the light: no technique runs for them, and the mask is dark. This pass lights them.
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
    /// Range of distances over which shadows fade.
    pub(crate) struct FadeGpu {
        /// Begin of the fade, metres from the eye.
        begin_m: f32,
        /// Length of the fade, metres.
        length_m: f32,
        padding_0: f32,
        padding_1: f32,
    }
}

/// Fade pass.
#[derive(Debug)]
pub(crate) struct Fade {
    inputs: FrameInputs,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// Fade pass of one frame.
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

    /// Prepares a frame whose mask has 32 bits.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        distance: &ShadowDistance,
    ) -> PreparedFade {
        let [begin_m, length_m] = distance.fade_span_m();
        let fade = FadeGpu { begin_m, length_m, padding_0: 0.0, padding_1: 0.0 };
        // A storage buffer, because drivers may compile uniforms' values into the shader.
        let fade = stage.storage("antumbra fade", bytemuck::bytes_of(&fade));
        PreparedFade {
            inputs: self.inputs.prepare(stage, frame),
            pipeline: self.pipeline.clone(),
            group: FadeInputs { fade: &fade }.group(stage, &self.layout),
        }
    }
}

impl PreparedFade {
    /// Records the pass, which updates the mask in place.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("fade", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, &self.group, &[]);
            self.inputs.dispatch(pass);
        });
    }
}
