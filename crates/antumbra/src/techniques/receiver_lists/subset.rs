//! Subset of the view-samples with reconstruction (section 4.3): every other pixel in both directions, interpolation within a
//! surface, and a second round of the same passes for the pixels that interpolation would get wrong.

use super::buffers::BufferSet;
use crate::contract::PreparedFrame;
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline};
use crate::mask::sparse_upsample::{PreparedUpsample, SparseUpsample};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

bindings! {
    struct Marked = "view-sample missing", COMPUTE, group 1 of [LISTS_MARK_MISSING] {
        /// List and position of each pixel, as in the lists' passes.
        3 places: ReadWrite,
    }
}

/// Reconstruction passes.
#[derive(Debug)]
pub(super) struct Subset {
    upsample: SparseUpsample,
    layout: wgpu::BindGroupLayout,
    mark: wgpu::ComputePipeline,
}

/// Reconstruction passes of one frame.
#[derive(Debug)]
pub(super) struct PreparedSubset {
    upsample: PreparedUpsample,
    mark: wgpu::ComputePipeline,
    marked: wgpu::BindGroup,
    /// Group 1 of the passes that list the missing pixels.
    pub(super) lists: wgpu::BindGroup,
}

impl Subset {
    pub(super) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let layout = Marked::layout(gpu);
        let layouts = [&FrameInputs::missing_layout(gpu), &layout];
        let mark = compute_pipeline(gpu, "view-sample missing", shaders::LISTS_MARK_MISSING, &layouts);
        Self { upsample: SparseUpsample::new(gpu, inputs), layout, mark }
    }

    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        inputs: &FrameInputs,
        frame: &PreparedFrame<'_>,
        of_frame: &PreparedInputs,
        (buffers, lists): (BufferSet<'_>, wgpu::BindGroup),
    ) -> PreparedSubset {
        let upsample = self.upsample.prepare(stage, inputs, frame, of_frame);
        let marked = Marked { places: buffers.places }.group(stage, &self.layout);
        PreparedSubset { upsample, mark: self.mark.clone(), marked, lists }
    }
}

impl PreparedSubset {
    /// Records the interpolation between the listed pixels, and marks those for the second round.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, inputs: &PreparedInputs) {
        self.upsample.record(recorder, inputs);
        recorder.compute("missing view-samples", Span::Only, |pass| {
            pass.set_pipeline(&self.mark);
            pass.set_bind_group(1, &self.marked, &[]);
            self.upsample.dispatch_missing(pass);
        });
    }
}
