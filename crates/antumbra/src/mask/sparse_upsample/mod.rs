//! Completion of a mask of which a technique has written every other pixel in both directions.
//!
//! Any technique can use it: it writes the pixels with even column and row, a quarter of them. This block fills in the
//! rest by interpolation within a surface, guided by the receivers' positions and normals (joint bilateral upsampling:
//! Kopf, Cohen, Lischinski, Uyttendaele 2007). Where the known pixels lie across edges or disagree, it lists the pixel.
//! The technique runs once more for the listed pixels alone, packed into full workgroups wherever they lie in the image
//! (`missing.wesl`), so that no thread waits for a neighbour's lookup.

use std::sync::Arc;

use crate::contract::PreparedFrame;
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_pipeline};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

#[cfg(test)]
mod tests;

bindings! {
    struct Upsampled = "sparse upsample", COMPUTE, group 1 of [SPARSE_UPSAMPLE] {
        0 missing_list: ReadWrite,
        1 missing_dispatch: ReadWrite,
    }
}

/// Upsampling pass.
#[derive(Debug)]
pub(crate) struct SparseUpsample {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    missing_layout: wgpu::BindGroupLayout,
    lists: Option<Lists>,
}

/// Upsampling pass of one frame.
#[derive(Debug)]
pub(crate) struct PreparedUpsample {
    pipeline: wgpu::ComputePipeline,
    lists: Lists,
    /// Group 0 of the technique's pipeline for missing pixels.
    missing_group: wgpu::BindGroup,
}

#[derive(Clone, Debug)]
struct Lists {
    /// Number of missing pixels and their coordinates; all lights share it.
    missing: Arc<wgpu::Buffer>,
    /// Indirect dispatch arguments for the missing pixels.
    dispatch: Arc<wgpu::Buffer>,
    group: wgpu::BindGroup,
}

impl SparseUpsample {
    /// Distance between known pixels, along columns and rows.
    pub(crate) const STRIDE_PX: u32 = 2;

    pub(crate) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let layout = Upsampled::layout(gpu);
        Self {
            pipeline: compute_pipeline(gpu, "sparse upsample", shaders::SPARSE_UPSAMPLE, &[&inputs.layout, &layout]),
            layout,
            missing_layout: FrameInputs::missing_layout(gpu),
            lists: None,
        }
    }

    /// Allocates lists for as many missing pixels as the image can have. `of_frame` is the result of preparing `inputs` for the frame.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        inputs: &FrameInputs,
        frame: &PreparedFrame<'_>,
        of_frame: &PreparedInputs,
    ) -> PreparedUpsample {
        let size_px = frame.receivers.size_px;
        let known = size_px.map(|px| px.div_ceil(Self::STRIDE_PX));
        let most = size_px.element_product() - known.element_product();
        let bytes = 4 * u64::from(most + 1);
        let lists = self.lists.take().filter(|lists| lists.missing.size() >= bytes);
        let lists = self.lists.insert(lists.unwrap_or_else(|| Lists::new(stage, &self.layout, bytes)));
        PreparedUpsample {
            pipeline: self.pipeline.clone(),
            missing_group: inputs.missing_group(stage, frame, of_frame, &self.missing_layout, &lists.missing),
            lists: lists.clone(),
        }
    }
}

impl PreparedUpsample {
    /// Records the interpolation of the frame's mask, except the missing pixels.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, inputs: &PreparedInputs) {
        // Only the count needs clearing; the entries are written before they are read.
        recorder.clear_buffer(&self.lists.missing);
        recorder.clear_buffer(&self.lists.dispatch);
        recorder.compute("upsample", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            inputs.bind(pass);
            pass.set_bind_group(1, &self.lists.group, &[]);
            inputs.dispatch_known(pass);
        });
    }

    /// Dispatches the current pipeline, of 64 threads per workgroup, for the missing pixels, with its group 0.
    pub(crate) fn dispatch_missing(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(0, &self.missing_group, &[]);
        pass.dispatch_workgroups_indirect(&self.lists.dispatch, 0);
    }
}

impl Lists {
    fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, missing_bytes: u64) -> Self {
        let buffer = |scratch, label, size, usage| {
            let descriptor = wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | usage,
                mapped_at_creation: false,
            };
            gpu.device.scratch_buffer(scratch, &descriptor)
        };
        let label = "antumbra missing pixels";
        let missing = buffer(Scratch::MissingPixels, label, missing_bytes, wgpu::BufferUsages::empty());
        let label = "antumbra missing pixels' workgroups";
        let dispatch = buffer(Scratch::MissingDispatch, label, 12, wgpu::BufferUsages::INDIRECT);
        let group = Upsampled { missing_list: &missing, missing_dispatch: &dispatch }.cached_group(gpu, layout);
        Self { missing, dispatch, group }
    }
}
