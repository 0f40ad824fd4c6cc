//! A mask of which a technique has written every other pixel in both directions, made whole.
//!
//! For any technique: it writes the pixels whose column and row are even, a quarter of them. This block fills in the
//! rest by interpolation within a surface, guided by the receivers' positions and normals (joint bilateral upsampling:
//! Kopf, Cohen, Lischinski, Uyttendaele 2007). Where the known pixels lie across edges or disagree, it lists the pixel:
//! the technique runs once more for those alone, side by side wherever they lie in the picture (`missing.wesl`), so that
//! no thread waits for a neighbour's lookup.

use glam::UVec2;

use crate::frame::inputs::FrameInputs;
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline};
use crate::shaders;

#[cfg(test)]
mod tests;

bindings! {
    struct Upsampled = "sparse upsample", COMPUTE, group 1 of [SPARSE_UPSAMPLE] {
        0 missing_list: ReadWrite,
        1 missing_dispatch: ReadWrite,
    }

    struct Missing = "missing pixels", COMPUTE, group 2 of [MULTI_LAYER_RESOLVE] {
        0 missing: Storage,
    }
}

/// Fills in.
#[derive(Debug)]
pub(crate) struct SparseUpsample {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    /// Group 2 of the technique's pipeline for missing pixels.
    pub(crate) missing_layout: wgpu::BindGroupLayout,
    prepared: Option<Prepared>,
}

#[derive(Debug)]
struct Prepared {
    /// Count and pixels.
    missing: wgpu::Buffer,
    /// Workgroups for them.
    dispatch: wgpu::Buffer,
    group: wgpu::BindGroup,
    missing_group: wgpu::BindGroup,
}

impl SparseUpsample {
    pub(crate) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let layout = Upsampled::layout(gpu);
        Self {
            pipeline: compute_pipeline(gpu, "sparse upsample", shaders::SPARSE_UPSAMPLE, &[&inputs.layout, &layout]),
            layout,
            missing_layout: Missing::layout(gpu),
            prepared: None,
        }
    }

    /// Threads that a technique needs to write the known pixels of a picture: thread (x, y) is pixel (2 x, 2 y).
    pub(crate) fn known_size(size_px: UVec2) -> UVec2 {
        size_px.map(|px| px.div_ceil(2))
    }

    /// Makes room for as many missing pixels as the picture can have.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, size_px: UVec2) {
        let most = size_px.element_product() - Self::known_size(size_px).element_product();
        let bytes = 4 * u64::from(most + 1);
        if self.prepared.as_ref().is_some_and(|prepared| prepared.missing.size() >= bytes) {
            return;
        }
        let buffer = |label, size, usage| {
            stage.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | usage,
                mapped_at_creation: false,
            })
        };
        let missing = buffer("antumbra missing pixels", bytes, wgpu::BufferUsages::empty());
        let dispatch = buffer("antumbra missing pixels' workgroups", 12, wgpu::BufferUsages::INDIRECT);
        self.prepared = Some(Prepared {
            group: Upsampled { missing_list: &missing, missing_dispatch: &dispatch }.group(stage, &self.layout),
            missing_group: Missing { missing: &missing }.group(stage, &self.missing_layout),
            missing,
            dispatch,
        });
    }

    /// Fills in the mask of the prepared frame, all but the missing pixels.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, inputs: &FrameInputs) {
        let Some(prepared) = &self.prepared else { return };
        // The count; what lies behind it is written before it is read.
        recorder.clear_buffer(&prepared.missing);
        recorder.clear_buffer(&prepared.dispatch);
        recorder.compute("upsample", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            inputs.bind(pass);
            pass.set_bind_group(1, &prepared.group, &[]);
            inputs.dispatch(pass);
        });
    }

    /// Dispatches the pipeline that the pass has set, of 64 threads a workgroup, for the missing pixels, as its group 2.
    pub(crate) fn dispatch_missing(&self, pass: &mut wgpu::ComputePass<'_>) {
        let Some(prepared) = &self.prepared else { return };
        pass.set_bind_group(2, &prepared.missing_group, &[]);
        pass.dispatch_workgroups_indirect(&prepared.dispatch, 0);
    }

    pub(crate) fn memory_bytes(&self) -> u64 {
        self.prepared.as_ref().map_or(0, |prepared| prepared.missing.size() + prepared.dispatch.size())
    }
}
