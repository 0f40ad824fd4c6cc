//! Passes of the filterable techniques of fixed kernel width. They differ only in their basis (see `primitives/depth_basis`):
//! each has two thin shaders, one that encodes and one that decodes.
//!
//! ```text
//! light map (1 to 8 samples per texel) ─► encode ─► blur ─► mips ─► resolve ─► mask
//! ```
//!
//! By default depth is measured along the world axis nearest to the light's axis, provided that every ray of the map runs
//! forward along it (see `depth_axis`). A floor then has one depth under the kernel, however slanted the light. A pipeline
//! constant selects distances to the light instead. Texels without a caster count as the far end of the range. The range covers
//! casters and receivers; for a host's map it is the map's own, cut at the farthest receiver if `Receivers` bounds them.
//!
//! Texels of the map store the basis's channels in 32-bit words: one 32-bit, two 16-bit or four 8-bit channels per word. A
//! receiver reads only the words that it needs. Lookups are trilinear and anisotropic over the pixel's footprint on the
//! receiver's plane. `resolve = exact` replaces the basis by a comparison of every texel under the same kernel; it is the
//! reference for these techniques.

use glam::UVec2;

use crate::contract::{CastersKey, DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::gpu::{
    Bindings, Cached, Content, Gpu, GpuStruct, Recorder, Span, Stage, compute_entry, compute_pipeline, create_uniform,
    write_uniform,
};
use crate::light_map::caster_depth::CasterDepth;
use crate::light_map::hosts_map::view_of_hosts_map;
use crate::light_map::light_view::LightViewGpu;
use crate::primitives::packed_map::{PackedMap, Packing};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};

pub mod convolution;
mod depth_axis;
pub mod esm;
pub mod evsm;
pub(crate) mod gpu_types;
pub mod lvsm;
pub mod moment;
mod own_map;
mod params;
mod pipelines;
mod prepared_basis;
#[cfg(test)]
mod tests;
pub mod vsm;

pub use depth_axis::DepthAxis;
use depth_axis::DepthRange;
use gpu_types::FilterUniform;
use own_map::OwnMap;
pub use params::{FilterKernel, FloatStorage, MomentStorage, Multisampling, ResolveBy};
pub(crate) use params::{FilterSettings, filterable_params};
pub(crate) use pipelines::pipelines_index;
use pipelines::{Basis, Filtered, MapPipelines};
pub use prepared_basis::PreparedBasis;

/// Shaders of one basis, as WGSL.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BasisShaders {
    pub(crate) encode: &'static str,
    pub(crate) encode_multisampled: &'static str,
    pub(crate) resolve: &'static str,
}

/// Light map of the prepared frame.
#[derive(Clone, Debug)]
pub(crate) struct FrameMap {
    /// Depth texture, with one or several samples per texel.
    pub(crate) depth: wgpu::TextureView,
    pub(crate) size: UVec2,
    pub(crate) sample_count: u32,
    /// Light view with which the map is drawn.
    pub(crate) view: LightViewGpu,
    /// Depth axis and range of the map.
    pub(crate) range: DepthRange,
    settings: FilterSettings,
    inputs: PreparedInputs,
    /// Whether an earlier frame has already drawn the map with the same casters and view.
    is_drawn: bool,
}

/// Passes that all filterable techniques share. `P` is the basis's parameter uniform.
#[derive(Debug)]
pub(crate) struct Filterable<P> {
    technique: &'static str,
    shaders: BasisShaders,
    /// Pipelines that draw the light map, keyed by sample count.
    casters: Cached<u32, CasterDepth>,
    inputs: FrameInputs,
    packed: PackedMap,
    params_layout: wgpu::BindGroupLayout,
    resolve_layout: wgpu::BindGroupLayout,
    gather_sampler: wgpu::Sampler,
    resolve: wgpu::ComputePipeline,
    /// Pipeline constants of the basis for `resolve`; may be empty.
    constants: Vec<(&'static str, f64)>,
    /// Whether the caster pass writes the packed map in place of the encode pass.
    is_drawn: bool,
    /// Constants that `resolve` is compiled for.
    compiled: Vec<(&'static str, f64)>,
    /// Pipelines per kind of map, indexed by [`pipelines_index`].
    map_pipelines: [Option<MapPipelines>; 4],
    view_uniform: wgpu::Buffer,
    filter_uniform: wgpu::Buffer,
    params_uniform: wgpu::Buffer,
    /// Placeholder for a basis that has no buffer of its own.
    no_buffer: wgpu::Buffer,
    own_map: Option<OwnMap>,
    /// Cache key of the light map: casters, view and sample count.
    content: Content<(CastersKey, Vec<u8>)>,
    frame_map: Option<FrameMap>,
    _params: std::marker::PhantomData<P>,
}

impl<P: GpuStruct> Filterable<P> {
    /// Creates the pipelines of `technique`. Its shaders find `P` at binding 0 and the basis's buffer at binding 1: in group 1
    /// of the encode pass, in group 2 of the resolve pass.
    pub(crate) fn new(gpu: &Gpu, technique: &'static str, shaders: BasisShaders) -> Self {
        let inputs = FrameInputs::new(gpu);
        let params_layout = Basis::layout(gpu);
        let resolve_layout = Filtered::layout(gpu);
        let layouts = [&inputs.layout, &resolve_layout, &params_layout];
        Self {
            technique,
            shaders,
            casters: Cached::default(),
            packed: PackedMap::new(gpu),
            resolve: compute_pipeline(gpu, technique, shaders.resolve, &layouts),
            constants: Vec::new(),
            is_drawn: false,
            compiled: Vec::new(),
            inputs,
            params_layout,
            resolve_layout,
            // The default sampler: no filtering, clamped to the edge.
            gather_sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()),
            map_pipelines: [const { None }; 4],
            view_uniform: create_uniform::<LightViewGpu>(gpu, "antumbra light view"),
            filter_uniform: create_uniform::<FilterUniform>(gpu, "antumbra filter"),
            params_uniform: create_uniform::<P>(gpu, "antumbra basis parameters"),
            no_buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra no buffer"),
                size: 16,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            own_map: None,
            content: Content::default(),
            frame_map: None,
            _params: std::marker::PhantomData,
        }
    }

    /// Sets whether the caster pass writes the packed map in place of the encode pass. Call it before [`Self::prepare_map`].
    pub(crate) fn set_drawn(&mut self, is_drawn: bool) {
        self.is_drawn = is_drawn;
        self.packed.set_drawn(is_drawn);
    }

    /// Sets the basis's constants of the resolve pipeline (default 0). [`Self::prepare_basis`] compiles the pipeline for them.
    pub(crate) fn specialise(&mut self, constants: &[(&'static str, f64)]) {
        self.constants = constants.to_vec();
    }

    /// Recompiles the resolve pipeline if it is not compiled for the frame's constants.
    fn compile_resolve(&mut self, gpu: &Gpu) {
        let constants = [&self.distance_constant()[..], &self.constants].concat();
        let made = self.compiled.iter().map(|(_, value)| *value).chain(std::iter::repeat(0.0));
        if constants.iter().zip(made).all(|((_, value), made)| *value == made) {
            return;
        }
        let layouts = [&self.inputs.layout, &self.resolve_layout, &self.params_layout];
        self.resolve = compute_entry(gpu, self.technique, self.shaders.resolve, None, &constants, &layouts);
        self.compiled = constants;
    }

    /// Returns the constant `IS_DISTANCE`, which every pipeline that measures depth takes.
    pub(crate) fn distance_constant(&self) -> [(&'static str, f64); 1] {
        [("IS_DISTANCE", f64::from(u8::from(self.is_distance())))]
    }

    /// Fits and allocates the light map of the frame, and returns its description.
    pub(crate) fn prepare_map(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        settings: &FilterSettings,
    ) -> Result<FrameMap, Error> {
        let inputs = self.inputs.prepare(stage, frame);
        let mut map = match &frame.casters {
            PreparedCasters::Draws(meshes) => self.prepare_own_map(stage, frame, meshes, settings, inputs)?,
            PreparedCasters::HostDepthMap(map) => {
                self.own_map = None;
                let view = view_of_hosts_map(self.technique, frame, map)?;
                if view.far_m == f32::MAX {
                    return Err(Error::BadFrame {
                        technique: self.technique,
                        what: "the depth map's matrix",
                        had: "one of infinite depth".into(),
                        needed: "one of finite depth, unless the receivers have `bounds` or a `hull`, because filtered depths \
                             are fractions of the range"
                            .into(),
                    });
                }
                FrameMap {
                    depth: map.view.clone(),
                    size: map.size_px,
                    sample_count: 1,
                    view,
                    // The map does not say how far its casters reach along another axis.
                    range: match settings.depth_axis {
                        DepthAxis::Distance => DepthRange::of_view_by_distance(&view),
                        DepthAxis::Light | DepthAxis::World => None,
                    }
                    .unwrap_or_else(|| DepthRange::of_view(&view))
                    .up_to(&view, &frame.receivers.corners()),
                    settings: *settings,
                    inputs,
                    is_drawn: false,
                }
            }
        };
        let samples = map.sample_count.to_ne_bytes();
        let of = [bytemuck::bytes_of(&map.view), &samples];
        map.is_drawn = self.content.ask(stage.casters().map(|casters| (casters, of.concat())));
        write_uniform(stage, &self.view_uniform, &map.view);
        self.frame_map = Some(map.clone());
        Ok(map)
    }

    /// Allocates the filtered map of `channels` channels and uploads the basis's parameters. `t_step` is the rounding error of
    /// stored depths, in t.
    pub(crate) fn prepare_basis(
        &mut self,
        stage: &Stage<'_>,
        map: &FrameMap,
        channels: u32,
        packing: Packing,
        t_step: f32,
        params: &P,
        buffer: Option<&wgpu::Buffer>,
    ) -> PreparedBasis {
        let settings = map.settings;
        let kernel = settings.kernel();
        let words = channels.div_ceil(packing.channels());
        let packed = self.packed.prepare(stage, map.size, words, packing, &kernel, settings.mips);
        write_uniform(
            stage,
            &self.filter_uniform,
            &FilterUniform {
                packing: packing as u32,
                sample_count: map.sample_count,
                kernel_radius: kernel.radius(),
                max_anisotropy: settings.anisotropy,
                bias_scale: settings.bias_scale,
                t_step,
                near_m: map.range.near_m,
                far_m: map.range.far_m,
                depth_axis: map.range.axis,
                level_count: packed.level_count(),
            },
        );
        write_uniform(stage, &self.params_uniform, params);

        let is_exact = settings.resolve == ResolveBy::Exact;
        self.compile_resolve(stage);
        let pipelines = self.map_pipelines(stage, is_exact);
        let groups = self.bind(stage, &map.depth, &packed, &pipelines, buffer.unwrap_or(&self.no_buffer), is_exact);
        PreparedBasis {
            map: map.clone(),
            groups,
            encode: (!is_exact && !self.is_drawn).then(|| pipelines.encode.clone()),
            packed,
            resolve: pipelines.exact.filter(|_| is_exact).unwrap_or_else(|| self.resolve.clone()),
            encode_layout: pipelines.encode_layout,
            depth_layout: pipelines.depth_layout,
        }
    }

    /// Returns the pipelines that draw the light map of the prepared frame; `None` for a host's map.
    pub(crate) fn casters(&self) -> Option<&CasterDepth> {
        self.casters.get()
    }

    /// Returns the light map of the prepared frame and the pipelines that draw it; `None` for a host's map.
    pub(crate) fn own_depth(&self) -> Option<(&wgpu::TextureView, &CasterDepth)> {
        Some((&self.own_map.as_ref()?.view, self.casters()?))
    }

    /// Returns the uniforms of the light view, the filter and the basis.
    pub(crate) fn uniforms(&self) -> (&wgpu::Buffer, &wgpu::Buffer, &wgpu::Buffer) {
        (&self.view_uniform, &self.filter_uniform, &self.params_uniform)
    }

    /// Returns the layout of group 0 of passes over the receivers.
    pub(crate) fn inputs_layout(&self) -> &wgpu::BindGroupLayout {
        &self.inputs.layout
    }

    /// Whether the prepared frame's light map has several samples per texel.
    pub(crate) fn is_multisampled(&self) -> bool {
        self.frame_map.as_ref().is_some_and(|map| map.sample_count > 1)
    }

    /// Whether the prepared frame's depths are distances to the light.
    pub(crate) fn is_distance(&self) -> bool {
        self.frame_map.as_ref().is_some_and(|map| map.range.is_distance)
    }

    /// Records the light map, unless the host draws it or an earlier frame has drawn it.
    pub(crate) fn record_map(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedBasis) {
        if prepared.map.is_drawn {
            return;
        }
        if let (PreparedCasters::Draws(meshes), Some(map), Some(casters)) =
            (&frame.casters, &self.own_map, self.casters.get())
        {
            recorder.depth_pass("light map", Span::Only, &map.view, CasterDepth::CLEAR_DEPTH, |pass| {
                casters.draw(pass, 0, meshes);
            });
        }
    }

    /// Returns the light map of the frame prepared last, and the levels of the filtered map.
    pub(crate) fn drawn_map(&self) -> Option<DrawnMap> {
        let map = self.frame_map.as_ref()?;
        // The background depth of either convention.
        let empty_depth = if map.view.depth_sign > 0.0 { 0.0 } else { 1.0 };
        // With exact comparisons the filtered map is neither written nor read.
        let levels = if map.settings.resolve == ResolveBy::Exact { Vec::new() } else { self.packed.drawn() };
        Some(DrawnMap { levels, ..map.view.drawn_map(&map.depth, map.sample_count, empty_depth) })
    }

    /// Returns the size of the light map and the filtered map, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let map = self.own_map.as_ref().map_or(0, |map| u64::from(map.size).pow(2) * u64::from(map.sample_count) * 4);
        map + self.packed.memory_bytes()
    }
}
