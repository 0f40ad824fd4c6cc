//! Techniques of one light map and one pass over the receivers that resolves it into the mask. They differ in that pass's shader
//! and its parameters alone.

use glam::Vec2;

use crate::contract::{Error, Frame};
use crate::frame::inputs::FrameInputs;
use crate::gpu::{
    Gpu, GpuStruct, Recorder, Span, Stage, compute_pipeline, create_uniform, storage_entry, uniform_entry,
    upload_storage, write_uniform,
};
use crate::light_map::map::{LightMap, MapSearch, OwnMapSettings};
use crate::techniques::TechniqueKind;

pub mod hard;
pub mod pcf;
pub mod pcss;
pub mod pcss_anisotropic;

/// One light map and its resolve pass. `P` is the resolve shader's parameter uniform.
#[derive(Debug)]
pub(crate) struct MapResolve<P> {
    kind: TechniqueKind,
    map: LightMap,
    inputs: FrameInputs,
    params_layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    params_uniform: wgpu::Buffer,
    taps: Option<wgpu::Buffer>,
    params_group: Option<wgpu::BindGroup>,
    _params: std::marker::PhantomData<P>,
}

impl<P: GpuStruct> MapResolve<P> {
    /// Makes the pipelines of technique `kind` around its resolve shader.
    pub(crate) fn new(gpu: &Gpu, kind: TechniqueKind, resolve_wgsl: &'static str, search: MapSearch) -> Self {
        let inputs = FrameInputs::new(gpu);
        let map = LightMap::new(gpu, kind.name(), search);
        let params_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra resolve parameters"),
            entries: &[uniform_entry(0, wgpu::ShaderStages::COMPUTE), storage_entry(1, wgpu::ShaderStages::COMPUTE)],
        });
        let layouts = [&inputs.layout, &map.layout, &params_layout];
        let pipeline = compute_pipeline(gpu, kind.name(), resolve_wgsl, &layouts);
        Self {
            kind,
            map,
            inputs,
            params_layout,
            pipeline,
            params_uniform: create_uniform::<P>(gpu, "antumbra resolve parameters"),
            taps: None,
            params_group: None,
            _params: std::marker::PhantomData,
        }
    }

    /// Fits the map, allocates it, and uploads everything. `taps` are the kernel's points, none for kernels without.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &Frame<'_>,
        map: OwnMapSettings,
        params: &P,
        taps: &[Vec2],
    ) -> Result<(), Error> {
        self.inputs.prepare(stage, self.kind.name(), frame)?;
        self.map.prepare(stage, frame, map)?;
        write_uniform(stage, &self.params_uniform, params);
        let taps: &[Vec2] = if taps.is_empty() { &[Vec2::ZERO] } else { taps };
        let taps = upload_storage(stage, &mut self.taps, "antumbra taps", taps);
        self.params_group = Some(stage.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra resolve parameters"),
            layout: &self.params_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.params_uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: taps.as_entire_binding() },
            ],
        }));
        Ok(())
    }

    /// Records the light map's pass (where it is ours), its pyramid (where there is one) and the resolve.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.map.record(recorder, frame);
        let params_group = self.params_group.as_ref().expect("prepare comes before record");
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&self.pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, self.map.bind_group(), &[]);
            pass.set_bind_group(2, params_group, &[]);
            self.inputs.dispatch(pass);
        });
    }

    /// Bytes of the light map and its pyramid.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes()
    }
}
