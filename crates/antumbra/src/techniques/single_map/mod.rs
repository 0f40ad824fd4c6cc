//! Techniques with one light map and one resolve pass, which reads the map for every receiver and writes the mask. They differ only
//! in that pass's shader and parameters.

use std::sync::Arc;

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{
    Bindings, Cached, Embeddable, EmbeddedGroup, Gpu, GpuStruct, Recorder, Stage, TableKey, bindings, create_uniform,
    shared_table, upload_storage, write_uniform,
};
use crate::light_map::map::{LightMap, MapSearch, MapSettings, PreparedMap};
use crate::mask::resolve::{PreparedResolve, Resolve, ResolveShader};
use crate::receivers::inputs::FrameInputs;

pub mod backprojection;
pub mod bitmask;
pub mod hard;
mod micro_patches;
pub mod pcf;
pub mod pcss;
pub mod pcss_anisotropic;
pub mod smrt;
pub(crate) mod taps;
#[cfg(test)]
mod tests;

bindings! {
    struct ResolveParams = "resolve parameters", COMPUTE {
        /// Parameters of the technique.
        0 params: Uniform,
        /// Points of the kernel.
        1 taps: Storage,
    }
}

/// Points of a kernel, uploaded as a storage buffer.
pub(crate) struct KernelPoints<'a> {
    /// Key of the table that lights share; `None` if the points belong to this light alone.
    pub(crate) key: Option<TableKey>,
    /// Function that computes the points' bytes, one point after the other.
    pub(crate) bytes: &'a dyn Fn() -> Vec<u8>,
}

impl KernelPoints<'_> {
    /// Placeholder for kernels without points: WebGPU has no empty bindings.
    pub(crate) fn without_points() -> Self {
        let key = TableKey { of: "antumbra no taps", numbers: Vec::new() };
        Self { key: Some(key), bytes: &|| vec![0; 16] }
    }
}

/// Settings of a frame's resolve pass.
pub(crate) struct ResolvePass<'a> {
    /// Settings of the library's own map; unused with a host's map.
    pub(crate) map: MapSettings,
    /// Values of the shader's override constants, by name.
    pub(crate) constants: &'a [(&'static str, f64)],
    /// Whether only every other pixel is resolved, plus the pixels that interpolation would get wrong.
    pub(crate) is_sparse: bool,
}

impl ResolvePass<'_> {
    /// Pass over every pixel with a shader without constants.
    pub(crate) fn of(map: MapSettings) -> Self {
        Self { map, constants: &[], is_sparse: false }
    }
}

/// One light map and its resolve pass. `P` is the resolve shader's parameter uniform.
#[derive(Debug)]
pub(crate) struct MapResolve<P> {
    technique: &'static str,
    map: LightMap,
    inputs: FrameInputs,
    params_layout: wgpu::BindGroupLayout,
    wgsl: &'static str,
    /// Layouts of the technique's bind groups that follow those of the map and the parameters.
    further_layouts: Vec<wgpu::BindGroupLayout>,
    resolve: Resolve,
    params_uniform: wgpu::Buffer,
    /// Kernel points of this light alone.
    taps: Option<wgpu::Buffer>,
    /// Kernel points that lights share.
    shared_taps: Cached<TableKey, Arc<wgpu::Buffer>>,
    /// Override constants of the frame prepared last.
    constants: Vec<(&'static str, f64)>,
    _params: std::marker::PhantomData<P>,
}

/// Map and resolve pass of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedMapResolve {
    map: PreparedMap,
    params_group: wgpu::BindGroup,
    resolve: PreparedResolve,
}

impl<P: GpuStruct> MapResolve<P> {
    /// Creates the pipelines of `technique` from its resolve shader and values of the shader's constants.
    pub(crate) fn new(
        gpu: &Gpu,
        technique: &'static str,
        wgsl: &'static str,
        constants: &[(&'static str, f64)],
        search: MapSearch,
    ) -> Self {
        Self::with_groups(gpu, technique, wgsl, constants, search, Vec::new())
    }

    /// Like [`Self::new`], with the technique's own bind groups after those of the map and the parameters.
    pub(crate) fn with_groups(
        gpu: &Gpu,
        technique: &'static str,
        wgsl: &'static str,
        constants: &[(&'static str, f64)],
        search: MapSearch,
        further_layouts: Vec<wgpu::BindGroupLayout>,
    ) -> Self {
        let inputs = FrameInputs::new(gpu);
        let map = LightMap::new(gpu, technique, search);
        let params_layout = ResolveParams::layout(gpu);
        let mut resolve = Resolve::default();
        let layouts = &layouts(&map, &params_layout, &further_layouts);
        let shader = ResolveShader { label: technique, wgsl, constants, layouts };
        resolve.compile_ahead(gpu, &inputs, &shader);
        Self {
            technique,
            map,
            inputs,
            params_layout,
            further_layouts,
            wgsl,
            resolve,
            params_uniform: create_uniform::<P>(gpu, "antumbra resolve parameters"),
            taps: None,
            shared_taps: Cached::default(),
            constants: Vec::new(),
            _params: std::marker::PhantomData,
        }
    }

    /// Fits and allocates the map, and uploads everything. Compiles the pass if it differs from the last one, or
    /// if it is sparse for the first time.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        pass: &ResolvePass<'_>,
        params: &P,
        kernel: KernelPoints<'_>,
    ) -> Result<PreparedMapResolve, Error> {
        let map = self.map.prepare(stage, frame, pass.map)?;
        let shader = ResolveShader {
            label: self.technique,
            wgsl: self.wgsl,
            constants: pass.constants,
            layouts: &layouts(&self.map, &self.params_layout, &self.further_layouts),
        };
        self.constants.clear();
        self.constants.extend_from_slice(pass.constants);
        let resolve = self.resolve.prepare(stage, &mut self.inputs, frame, pass.is_sparse, &shader);
        write_uniform(stage, &self.params_uniform, params);
        let taps = match kernel.key {
            Some(key) => {
                self.taps = None;
                &**self.shared_taps.get_or_make(key.clone(), || shared_table(stage, key, kernel.bytes))
            }
            None => {
                self.shared_taps = Cached::default();
                upload_storage(stage, &mut self.taps, "antumbra taps", &(kernel.bytes)())
            }
        };
        let params = ResolveParams { params: &self.params_uniform, taps };
        Ok(PreparedMapResolve { map, params_group: params.group(stage, &self.params_layout), resolve })
    }

    /// Records the light map's pass (if the map is the library's), its pyramid (if there is one) and the resolve pass.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMapResolve) {
        self.record_with(recorder, frame, prepared, &[]);
    }

    /// Like [`Self::record`], with the technique's own bind groups.
    pub(crate) fn record_with(
        &self,
        recorder: &mut Recorder<'_>,
        frame: &PreparedFrame<'_>,
        prepared: &PreparedMapResolve,
        further: &[&wgpu::BindGroup],
    ) {
        self.map.record(recorder, frame, &prepared.map);
        prepared.resolve.record(recorder, |pass| {
            pass.set_bind_group(1, &prepared.map.group, &[]);
            pass.set_bind_group(2, &prepared.params_group, &[]);
            for (index, group) in (3..).zip(further) {
                pass.set_bind_group(index, *group, &[]);
            }
        });
    }

    /// Function of the pass for hosts' shaders: `wgsl`, a linked text with a function `visibility_at`, its constants and bind groups.
    pub(crate) fn embeddable(&self, wgsl: &'static str) -> Option<Embeddable> {
        let inputs = self.inputs.embedded()?;
        let (map, is_own) = self.map.embedded()?;
        let taps = self.taps.as_ref().or(self.shared_taps.get().map(|taps| &**taps))?;
        let params = ResolveParams { params: &self.params_uniform, taps };
        let groups = vec![inputs, map, EmbeddedGroup::of(&params)];
        Some(Embeddable { wgsl, constants: self.constants.clone(), groups, is_own })
    }

    /// Light map that the technique has drawn, for display.
    pub(crate) fn drawn_map(&self) -> Option<DrawnMap> {
        self.map.drawn()
    }

    /// Bytes of the light map and its pyramid, if they belong to this light.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes()
    }
}

/// Bind group layouts, in the order of their groups.
fn layouts<'a>(
    map: &'a LightMap,
    params: &'a wgpu::BindGroupLayout,
    further: &'a [wgpu::BindGroupLayout],
) -> Vec<&'a wgpu::BindGroupLayout> {
    [&map.layout, params].into_iter().chain(further).collect()
}
