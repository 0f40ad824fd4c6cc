//! A mask of which a technique has written every other pixel in both directions, made whole.
//!
//! For any technique: it writes the pixels whose column and row are even, a quarter of them. This block fills in the
//! rest by interpolation within a surface, guided by the receivers' positions and normals (joint bilateral upsampling:
//! Kopf, Cohen, Lischinski, Uyttendaele 2007). Where the known pixels lie across edges or disagree, it writes −1: the
//! technique runs once more for these pixels alone.

use glam::UVec2;

use crate::blocks::frame_inputs::FrameInputs;
use crate::gpu::{Gpu, Recorder, Span, compute_pipeline};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Fills in.
#[derive(Debug)]
pub(crate) struct SparseUpsample {
    pipeline: wgpu::ComputePipeline,
}

impl SparseUpsample {
    pub(crate) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        Self { pipeline: compute_pipeline(gpu, "sparse upsample", shaders::SPARSE_UPSAMPLE, &[&inputs.layout]) }
    }

    /// Threads that a technique needs to write the known pixels of a picture: thread (x, y) is pixel (2 x, 2 y).
    pub(crate) fn known_size(size_px: UVec2) -> UVec2 {
        size_px.map(|px| px.div_ceil(2))
    }

    /// Fills in the mask of the prepared frame, with −1 where the technique has to.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, inputs: &FrameInputs) {
        recorder.compute("upsample", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            inputs.bind(pass);
            inputs.dispatch(pass);
        });
    }
}
