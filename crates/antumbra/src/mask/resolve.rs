//! Resolve pass over the receivers, which writes the mask. It covers every pixel, or (sparse) every other one in both directions,
//! then those that interpolation between them would get wrong ([`sparse_upsample`](super::sparse_upsample)).
//!
//! Its shader has two entry points: `resolve`, one thread per `known_pixel`, and `resolve_missing` if the technique can be
//! sparse.

use super::sparse_upsample::{PreparedUpsample, SparseUpsample};
use crate::contract::PreparedFrame;
use crate::gpu::{Gpu, Recorder, Span, Stage, compute_entry};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};

/// Shader of a resolve pass.
pub(crate) struct ResolveShader<'a> {
    pub(crate) label: &'a str,
    pub(crate) wgsl: &'static str,
    /// Values of overridable constants, by name.
    pub(crate) constants: &'a [(&'static str, f64)],
    /// Bind group layouts that follow the frame's inputs; the same for one shader.
    pub(crate) layouts: &'a [&'a wgpu::BindGroupLayout],
}

/// Resolve pass.
#[derive(Debug, Default)]
pub(crate) struct Resolve {
    program: Option<Program>,
    upsample: Option<SparseUpsample>,
}

/// Resolve pass of one frame.
#[derive(Debug)]
pub(crate) struct PreparedResolve {
    inputs: PreparedInputs,
    known: wgpu::ComputePipeline,
    /// Upsampling and pipeline of missing pixels; `None` if every pixel is resolved.
    sparse: Option<(PreparedUpsample, wgpu::ComputePipeline)>,
}

#[derive(Debug)]
struct Program {
    wgsl: &'static str,
    constants: Vec<(&'static str, f64)>,
    known: wgpu::ComputePipeline,
    /// Pipeline of missing pixels; `None` until a frame is sparse.
    missing: Option<wgpu::ComputePipeline>,
}

impl Resolve {
    /// Uploads the frame's inputs, for all pixels or every other one, and compiles missing pipelines.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        inputs: &mut FrameInputs,
        frame: &PreparedFrame<'_>,
        is_sparse: bool,
        shader: &ResolveShader<'_>,
    ) -> PreparedResolve {
        // Points are in any order, so that nothing can be interpolated between them.
        let is_sparse = is_sparse && frame.receivers.have_neighbours();
        let stride_px = if is_sparse { SparseUpsample::STRIDE_PX } else { 1 };
        let of_frame = inputs.prepare_known(stage, frame, stride_px);
        let program = self.compile(stage, inputs, shader);
        let known = program.known.clone();
        let missing = is_sparse.then(|| program.missing(stage, shader).clone());
        let sparse = missing.map(|missing| {
            let upsample = self.upsample.get_or_insert_with(|| SparseUpsample::new(stage, inputs));
            (upsample.prepare(stage, inputs, frame, &of_frame), missing)
        });
        PreparedResolve { inputs: of_frame, known, sparse }
    }

    /// Returns the program of known pixels and compiles it if necessary.
    fn compile(&mut self, gpu: &Gpu, inputs: &FrameInputs, shader: &ResolveShader<'_>) -> &mut Program {
        let is_made = |made: &Program| std::ptr::eq(made.wgsl, shader.wgsl) && made.constants == shader.constants;
        let made = self.program.take().filter(is_made).unwrap_or_else(|| Program {
            wgsl: shader.wgsl,
            constants: shader.constants.to_vec(),
            known: shader.pipeline(gpu, "resolve", &inputs.layout),
            missing: None,
        });
        self.program.insert(made)
    }

    /// Compiles the program of known pixels before the first frame.
    pub(crate) fn compile_ahead(&mut self, gpu: &Gpu, inputs: &FrameInputs, shader: &ResolveShader<'_>) {
        self.compile(gpu, inputs, shader);
    }
}

impl ResolveShader<'_> {
    fn pipeline(&self, gpu: &Gpu, entry: &str, inputs: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
        let layouts: Vec<_> = std::iter::once(inputs).chain(self.layouts.iter().copied()).collect();
        compute_entry(gpu, self.label, self.wgsl, Some(entry), self.constants, &layouts)
    }
}

impl Program {
    /// Returns the pipeline of missing pixels.
    fn missing(&mut self, gpu: &Gpu, shader: &ResolveShader<'_>) -> &wgpu::ComputePipeline {
        self.missing.get_or_insert_with(|| shader.pipeline(gpu, "resolve_missing", &FrameInputs::missing_layout(gpu)))
    }
}

impl PreparedResolve {
    /// Bind group 0 of the frame.
    pub(crate) fn inputs(&self) -> &PreparedInputs {
        &self.inputs
    }

    /// Records the pass; `bind` sets the groups that follow the frame's inputs.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, bind: impl Fn(&mut wgpu::ComputePass<'_>)) {
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&self.known);
            self.inputs.bind(pass);
            bind(pass);
            self.inputs.dispatch_known(pass);
        });
        let Some((upsample, missing)) = &self.sparse else { return };
        upsample.record(recorder, &self.inputs);
        recorder.compute("resolve missing", Span::Only, |pass| {
            pass.set_pipeline(missing);
            bind(pass);
            upsample.dispatch_missing(pass);
        });
    }
}
