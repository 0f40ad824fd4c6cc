//! Addition of a batch of maps to the mask: a pipeline for each comparison, and its bind groups.

use super::bands::Band;
use super::params::MultiViewCompare;
use crate::gpu::{Bindings, Gpu, Stage, bindings, compute_pipeline, samples, texels};
use crate::light_map::caster_triangles::maps::TriangleMaps;
use crate::light_map::depth_layers::DepthLayers;
use crate::receivers::inputs::FrameInputs;
use crate::shaders;
use crate::techniques::light_views::{Batch, BatchBindings, DepthMapsBatch, MapSamplers};

bindings! {
    struct SharpBatch = "multi_view batch with slopes", COMPUTE, group 1 of [MULTI_VIEW_ACCUMULATE_SHARP],
        with views: BatchBindings
    {
        3 maps: TextureArray(texels::DEPTH),
        4 gather_sampler: Sampler(samples::TAKES),
        6 edge_sums: ReadWrite,
        7 gradients: TextureArray(texels::FLOAT),
        9 band: Uniform,
        10 snapped_texels: Uniform,
    }

    struct TrianglesBatch = "multi_view batch by triangles", COMPUTE, group 1 of [MULTI_VIEW_ACCUMULATE_TRIANGLES],
        with views: BatchBindings
    {
        3 maps: TextureArray(texels::DEPTH),
        4 gather_sampler: Sampler(samples::TAKES),
        6 life_tables: ReadWrite,
        7 triangle_maps: TextureArray(texels::UINT),
        8 caster_triangles: Storage,
        9 band: Uniform,
        10 snapped_texels: Uniform,
    }
}

/// Pipelines that add a batch to the mask, by comparison.
#[derive(Debug)]
pub(super) struct Accumulations {
    by_depths: Accumulation,
    by_slopes: Accumulation,
    by_triangles: Accumulation,
}

/// Pipeline that adds a batch to the mask, and the layout of its bind group 1.
#[derive(Debug)]
pub(super) struct Accumulation {
    layout: wgpu::BindGroupLayout,
    pub(super) pipeline: wgpu::ComputePipeline,
}

/// Maps of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct BatchMaps<'a> {
    /// Depth maps, with slopes for sharp comparisons.
    pub(super) layers: &'a DepthLayers,
    /// Maps of triangles, if triangles are compared.
    pub(super) triangles: Option<&'a TriangleMaps>,
    pub(super) samplers: &'a MapSamplers,
}

/// Bind group 1 for rows of the image.
#[derive(Clone, Debug)]
pub(super) struct BandGroup {
    pub(super) rows: u32,
    pub(super) group: wgpu::BindGroup,
}

impl Accumulations {
    pub(super) fn new(gpu: &Gpu, inputs: &FrameInputs) -> Self {
        let accumulation = |wgsl, layout: wgpu::BindGroupLayout| {
            let pipeline = compute_pipeline(gpu, "multi_view accumulate", wgsl, &[&inputs.layout, &layout]);
            Accumulation { layout, pipeline }
        };
        Self {
            by_depths: accumulation(shaders::MULTI_VIEW_ACCUMULATE, DepthMapsBatch::layout(gpu)),
            by_slopes: accumulation(shaders::MULTI_VIEW_ACCUMULATE_SHARP, SharpBatch::layout(gpu)),
            by_triangles: accumulation(shaders::MULTI_VIEW_ACCUMULATE_TRIANGLES, TrianglesBatch::layout(gpu)),
        }
    }

    pub(super) fn of(&self, compare: MultiViewCompare) -> &Accumulation {
        match compare {
            MultiViewCompare::Triangles => &self.by_triangles,
            MultiViewCompare::Sharp => &self.by_slopes,
            MultiViewCompare::Gather | MultiViewCompare::Hardware => &self.by_depths,
        }
    }
}

impl Accumulation {
    /// Returns the bind groups of a batch: one per band, or one for all of the image's rows if only depths are compared.
    pub(super) fn bind(
        &self,
        stage: &Stage<'_>,
        batch: &Batch,
        maps: &BatchMaps<'_>,
        rows: u32,
        bands: &[Band],
    ) -> Vec<BandGroup> {
        let BatchMaps { layers, triangles, samplers } = *maps;
        let MapSamplers { gather: gather_sampler, comparison: comparison_sampler } = samplers;
        if bands.is_empty() {
            let (views, maps) = (batch.bindings(), layers.depth_array());
            let group = DepthMapsBatch { views, maps, gather_sampler, comparison_sampler }.group(stage, &self.layout);
            return vec![BandGroup { rows, group }];
        }
        let snapped_texels = stage.snapped_texels();
        let of_band = |Band { rows, uniform: band, pixels }: &Band| {
            let views = batch.bindings();
            let group = if let Some(triangles) = triangles {
                let triangles_batch = TrianglesBatch {
                    views,
                    maps: triangles.depth_array(),
                    gather_sampler,
                    life_tables: pixels,
                    triangle_maps: triangles.id_array(),
                    caster_triangles: triangles.triangles().buffer(),
                    band,
                    snapped_texels,
                };
                triangles_batch.group(stage, &self.layout)
            } else {
                let (maps, gradients) = (layers.depth_array(), layers.gradient_array());
                SharpBatch { views, maps, gather_sampler, edge_sums: pixels, gradients, band, snapped_texels }
                    .group(stage, &self.layout)
            };
            BandGroup { rows: *rows, group }
        };
        bands.iter().map(of_band).collect()
    }
}
