//! Irradiance from the bits by equation 1: emission by sample and channel, both cosines, and the distance.

use glam::Vec4;

use super::buffers::BufferSet;
use super::light_points::LocalPoint;
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, upload_storage};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

bindings! {
    struct Weighed = "view-sample irradiance", COMPUTE, group 1 of [LIGHT_BITS_IRRADIANCE] {
        0 settings: Uniform,
        1 bits: Storage,
        2 places: Storage,
        /// Two vectors per light point.
        3 emitters: Storage,
    }
}

/// Irradiance pass.
#[derive(Debug)]
pub(super) struct Irradiance {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    emitters: Option<wgpu::Buffer>,
}

/// Irradiance pass of one frame.
#[derive(Debug)]
pub(super) struct PreparedIrradiance {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl Irradiance {
    pub(super) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let layout = Weighed::layout(gpu);
        let layouts = [&inputs.layout, &layout];
        let pipeline = compute_pipeline(gpu, "view-sample irradiance", shaders::LIGHT_BITS_IRRADIANCE, &layouts);
        Self { layout, pipeline, emitters: None }
    }

    /// Uploads the light's points. The settings must count all of them, and every pixel's bits must be kept.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        buffers: BufferSet<'_>,
        settings: &wgpu::Buffer,
        points: &[LocalPoint],
    ) -> PreparedIrradiance {
        let packed: Vec<Vec4> =
            points.iter().flat_map(|point| [point.at.extend(point.weight), point.emission.extend(0.0)]).collect();
        let emitters = upload_storage(stage, &mut self.emitters, "view-sample emitters", &packed);
        let BufferSet { bits, places, .. } = buffers;
        let group = Weighed { settings, bits, places, emitters }.group(stage, &self.layout);
        PreparedIrradiance { pipeline: self.pipeline.clone(), group }
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.emitters.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

impl PreparedIrradiance {
    /// Writes the mask of every listed receiver.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, inputs: &PreparedInputs) {
        recorder.compute("irradiance", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            inputs.bind(pass);
            pass.set_bind_group(1, &self.group, &[]);
            inputs.dispatch(pass);
        });
    }
}
