//! Techniques of one light map and one pass over the receivers that resolves it into the mask. They differ in that pass's shader
//! and its parameters alone.

use bytemuck::Pod;

use crate::contract::{DrawnMap, Error, Frame};
use crate::frame::inputs::FrameInputs;
use crate::gpu::{
    Bindings, Gpu, GpuStruct, Recorder, Span, Stage, bindings, compute_entry, create_uniform, upload_storage,
    write_uniform,
};
use crate::light_map::map::{LightMap, MapSearch, OwnMapSettings};
use crate::techniques::TechniqueKind;

pub mod hard;
pub mod pcf;
pub mod pcss;
pub mod pcss_anisotropic;

bindings! {
    struct ResolveParams = "resolve parameters", COMPUTE {
        /// The technique's own.
        0 params: Uniform,
        /// The kernel's points.
        1 taps: Storage,
    }
}

/// The resolve pass, compiled for values of its shader's constants.
#[derive(Debug)]
struct Program {
    constants: Vec<(&'static str, f64)>,
    pipeline: wgpu::ComputePipeline,
}

/// One light map and its resolve pass. `P` is the resolve shader's parameter uniform.
#[derive(Debug)]
pub(crate) struct MapResolve<P> {
    kind: TechniqueKind,
    map: LightMap,
    inputs: FrameInputs,
    params_layout: wgpu::BindGroupLayout,
    wgsl: &'static str,
    program: Program,
    params_uniform: wgpu::Buffer,
    taps: Option<wgpu::Buffer>,
    params_group: Option<wgpu::BindGroup>,
    _params: std::marker::PhantomData<P>,
}

impl<P: GpuStruct> MapResolve<P> {
    /// Makes the pipelines of technique `kind` around its resolve shader, with values for the shader's constants.
    pub(crate) fn new(
        gpu: &Gpu,
        kind: TechniqueKind,
        wgsl: &'static str,
        constants: &[(&'static str, f64)],
        search: MapSearch,
    ) -> Self {
        let inputs = FrameInputs::new(gpu);
        let map = LightMap::new(gpu, kind.name(), search);
        let params_layout = ResolveParams::layout(gpu);
        let layouts = [&inputs.layout, &map.layout, &params_layout];
        let pipeline = compute_entry(gpu, kind.name(), wgsl, None, constants, &layouts);
        Self {
            kind,
            map,
            inputs,
            params_layout,
            wgsl,
            program: Program { constants: constants.to_vec(), pipeline },
            params_uniform: create_uniform::<P>(gpu, "antumbra resolve parameters"),
            taps: None,
            params_group: None,
            _params: std::marker::PhantomData,
        }
    }

    /// Fits the map, allocates it, and uploads everything; compiles the pass where it is for other `constants`. `taps` are
    /// the kernel's points, none for kernels without.
    pub(crate) fn prepare<T: Pod>(
        &mut self,
        stage: &Stage<'_>,
        frame: &Frame<'_>,
        map: OwnMapSettings,
        constants: &[(&'static str, f64)],
        params: &P,
        taps: &[T],
    ) -> Result<(), Error> {
        self.inputs.prepare(stage, self.kind.name(), frame)?;
        self.map.prepare(stage, frame, map)?;
        if self.program.constants != constants {
            let layouts = [&self.inputs.layout, &self.map.layout, &self.params_layout];
            let pipeline = compute_entry(stage, self.kind.name(), self.wgsl, None, constants, &layouts);
            self.program = Program { constants: constants.to_vec(), pipeline };
        }
        write_uniform(stage, &self.params_uniform, params);
        let taps: &[T] = if taps.is_empty() { &[T::zeroed()] } else { taps };
        let taps = upload_storage(stage, &mut self.taps, "antumbra taps", taps);
        let params = ResolveParams { params: &self.params_uniform, taps };
        self.params_group = Some(params.group(stage, &self.params_layout));
        Ok(())
    }

    /// Records the light map's pass (where it is ours), its pyramid (where there is one) and the resolve.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.map.record(recorder, frame);
        let params_group = self.params_group.as_ref().expect("prepare comes before record");
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&self.program.pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, self.map.bind_group(), &[]);
            pass.set_bind_group(2, params_group, &[]);
            self.inputs.dispatch(pass);
        });
    }

    /// Bytes of the light map and its pyramid.
    pub(crate) fn drawn_map(&self) -> Option<DrawnMap> {
        self.map.drawn()
    }

    pub(crate) fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes()
    }
}
