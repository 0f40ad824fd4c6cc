//! Bindings and pipelines of the passes over a light map and its receivers.

use super::Filterable;
use crate::gpu::{Bindings, Gpu, GpuStruct, Stage, bindings, compute_entry, compute_pipeline, samples, texels};
use crate::primitives::packed_map::{PackedMap, PreparedPackedMap};
use crate::shaders;

bindings! {
    /// Inputs and target of passes over the light map. Depth may have several samples per texel, here and below.
    struct Encoded = "encode", COMPUTE, group 0 of [VSM_ENCODE, VSM_ENCODE_MULTISAMPLED] {
        0 map_view: Uniform,
        1 settings: Uniform,
        2 light_map: Texture(texels::DEPTH),
        3 packed_target: WrittenArray(PackedMap::FORMAT),
    }

    /// Uniforms of passes over the receivers that look up the map.
    pub(super) struct Lookup = "lookup", COMPUTE {
        0 light_view: Uniform,
        1 settings: Uniform,
        5 snapped_texels: Uniform,
    }

    /// Inputs of passes over the receivers that read the filtered map.
    pub(super) struct Filtered = "filtered map", COMPUTE, group 1 of [VSM_RESOLVE], with lookup: Lookup {
        2 packed_map: TextureArray(texels::UINT),
        6 packed_mips: TextureArray(texels::UINT),
        7 gather_sampler: Sampler(samples::TAKES),
    }

    /// Inputs of the exact pass: the light map's depth and the weights of the blur.
    struct Exact = "exact", COMPUTE, group 1 of [FILTERABLE_EXACT, FILTERABLE_EXACT_MULTISAMPLED], with lookup: Lookup {
        3 depth_map: Texture(texels::DEPTH),
        4 weights: Storage,
    }

    /// Inputs of passes over the receivers that read only depth.
    struct Depth = "depth of receivers' map", COMPUTE, group 1 of [LVSM_BLEEDING, LVSM_BLEEDING_MULTISAMPLED] {
        0 light_view: Uniform,
        1 settings: Uniform,
        3 depth_map: Texture(texels::DEPTH),
    }

    /// Parameters and buffer of a basis. Each basis has its own name for the first.
    pub(super) struct Basis = "basis parameters", COMPUTE {
        0 parameters: Uniform,
        1 buffer: Storage,
    }
}

/// Pipelines for maps of one sample per texel, or of several.
#[derive(Clone, Debug)]
pub(super) struct MapPipelines {
    pub(super) encode_layout: wgpu::BindGroupLayout,
    pub(super) encode: wgpu::ComputePipeline,
    pub(super) exact_layout: wgpu::BindGroupLayout,
    pub(super) depth_layout: wgpu::BindGroupLayout,
    /// Pipeline of the exact pass, created on first use.
    pub(super) exact: Option<wgpu::ComputePipeline>,
}

/// Bind groups of the passes of one frame.
#[derive(Debug)]
pub(super) struct BindGroups {
    pub(super) encode: wgpu::BindGroup,
    pub(super) depth: wgpu::BindGroup,
    /// Group of the basis's resolve pass, or of the exact pass.
    pub(super) resolve: wgpu::BindGroup,
    pub(super) params: wgpu::BindGroup,
}

impl<P: GpuStruct> Filterable<P> {
    /// Creates the bind groups of a frame.
    pub(super) fn bind(
        &self,
        stage: &Stage<'_>,
        light_map: &wgpu::TextureView,
        packed: &PreparedPackedMap,
        pipelines: &MapPipelines,
        buffer: &wgpu::Buffer,
        is_exact: bool,
    ) -> BindGroups {
        let (view, settings) = (&self.view_uniform, &self.filter_uniform);
        let lookup = Lookup { light_view: view, settings, snapped_texels: stage.snapped_texels() };
        let encoded = Encoded { map_view: view, settings, light_map, packed_target: packed.first() };
        BindGroups {
            encode: encoded.group(stage, &pipelines.encode_layout),
            depth: Depth { light_view: view, settings, depth_map: light_map }.group(stage, &pipelines.depth_layout),
            resolve: if is_exact {
                Exact { lookup, depth_map: light_map, weights: packed.weights() }.group(stage, &pipelines.exact_layout)
            } else {
                let (packed_map, packed_mips) = (packed.first(), packed.mips());
                Filtered { lookup, packed_map, packed_mips, gather_sampler: &self.gather_sampler }
                    .group(stage, &self.resolve_layout)
            },
            params: Basis { parameters: &self.params_uniform, buffer }.group(stage, &self.params_layout),
        }
    }

    /// Returns the pipelines for the frame's kind of map, and compiles those that are missing.
    pub(super) fn map_pipelines(&mut self, gpu: &Gpu, with_exact: bool) -> MapPipelines {
        let (multisampled, constants) = (self.is_multisampled(), self.distance_constant());
        let index = pipelines_index(multisampled, self.is_distance());
        let pipelines = self.map_pipelines[index].get_or_insert_with(|| {
            let encode_layout = Encoded::layout_of_samples(gpu, multisampled);
            let wgsl = if multisampled { self.shaders.encode_multisampled } else { self.shaders.encode };
            MapPipelines {
                encode: compute_entry(gpu, "encode", wgsl, None, &constants, &[&encode_layout, &self.params_layout]),
                encode_layout,
                exact_layout: Exact::layout_of_samples(gpu, multisampled),
                depth_layout: Depth::layout_of_samples(gpu, multisampled),
                exact: None,
            }
        });
        if with_exact && pipelines.exact.is_none() {
            let wgsl = if multisampled { shaders::FILTERABLE_EXACT_MULTISAMPLED } else { shaders::FILTERABLE_EXACT };
            let layouts = [&self.inputs.layout, &pipelines.exact_layout, &self.params_layout];
            pipelines.exact = Some(compute_pipeline(gpu, "exact", wgsl, &layouts));
        }
        pipelines.clone()
    }
}

/// Returns the index of the pipelines for a sample count of one or more, and for depths along an axis or as distances.
pub(crate) fn pipelines_index(is_multisampled: bool, is_distance: bool) -> usize {
    usize::from(is_multisampled) + 2 * usize::from(is_distance)
}
