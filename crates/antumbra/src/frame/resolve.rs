//! The pass over the receivers that writes the mask: for every pixel; or, where it is sparse, for every other in both directions,
//! then for those that interpolation between them would get wrong ([`sparse_upsample`](super::sparse_upsample)).
//!
//! A shader for it has two entry points: `resolve`, of a thread for each `known_pixel`, and, if the technique can be sparse,
//! `resolve_missing`.

use super::inputs::FrameInputs;
use super::sparse_upsample::SparseUpsample;
use crate::contract::PreparedFrame;
use crate::gpu::{Gpu, Recorder, Span, Stage, compute_entry};

/// What is compiled.
pub(crate) struct ResolveShader<'a> {
    pub(crate) label: &'a str,
    pub(crate) wgsl: &'static str,
    /// Values of overridable constants, by their ids.
    pub(crate) constants: &'a [(&'static str, f64)],
    /// Of the groups behind the frame's inputs; the same for one shader.
    pub(crate) layouts: &'a [&'a wgpu::BindGroupLayout],
}

/// The pass.
#[derive(Debug, Default)]
pub(crate) struct Resolve {
    program: Option<Program>,
    upsample: Option<SparseUpsample>,
    is_sparse: bool,
}

#[derive(Debug)]
struct Program {
    wgsl: &'static str,
    constants: Vec<(&'static str, f64)>,
    known: wgpu::ComputePipeline,
    /// Where it was sparse once.
    missing: Option<wgpu::ComputePipeline>,
}

impl Resolve {
    /// Uploads the frame: all pixels, or every other.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        inputs: &mut FrameInputs,
        frame: &PreparedFrame<'_>,
        is_sparse: bool,
    ) {
        self.is_sparse = is_sparse;
        if !is_sparse {
            return inputs.prepare(stage, frame);
        }
        inputs.prepare_known(stage, frame, SparseUpsample::STRIDE_PX);
        let upsample = self.upsample.get_or_insert_with(|| SparseUpsample::new(stage, inputs));
        upsample.prepare(stage, inputs, frame);
    }

    /// Compiles what is not compiled yet.
    pub(crate) fn compile(&mut self, gpu: &Gpu, inputs: &FrameInputs, shader: &ResolveShader<'_>) {
        let pipeline = |entry, inputs: &wgpu::BindGroupLayout| {
            let layouts: Vec<_> = std::iter::once(inputs).chain(shader.layouts.iter().copied()).collect();
            compute_entry(gpu, shader.label, shader.wgsl, Some(entry), shader.constants, &layouts)
        };
        let is_made = |made: &Program| std::ptr::eq(made.wgsl, shader.wgsl) && made.constants == shader.constants;
        let made = self.program.take().filter(is_made).unwrap_or_else(|| Program {
            wgsl: shader.wgsl,
            constants: shader.constants.to_vec(),
            known: pipeline("resolve", &inputs.layout),
            missing: None,
        });
        let program = self.program.insert(made);
        if self.is_sparse && program.missing.is_none() {
            program.missing = Some(pipeline("resolve_missing", &FrameInputs::missing_layout(gpu)));
        }
    }

    /// Records it; `bind` sets the groups behind the frame's inputs.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &FrameInputs,
        bind: impl Fn(&mut wgpu::ComputePass<'_>),
    ) {
        let Some(program) = &self.program else { return };
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&program.known);
            inputs.bind(pass);
            bind(pass);
            inputs.dispatch_known(pass);
        });
        let (true, Some(upsample), Some(missing)) = (self.is_sparse, &self.upsample, &program.missing) else { return };
        upsample.record(recorder, inputs);
        recorder.compute("resolve missing", Span::Only, |pass| {
            pass.set_pipeline(missing);
            bind(pass);
            upsample.dispatch_missing(pass);
        });
    }

    /// Bytes of what the sparse pass holds.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.upsample.as_ref().map_or(0, SparseUpsample::memory_bytes)
    }
}
