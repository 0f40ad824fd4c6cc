//! Resolve pass of a batch of integer maps, which are made filterable if requested, and added to the mask.

use std::sync::Arc;

use super::gpu_types::DrawMaps;
use super::scatter::Targets;
use super::settings::ReprojectionFilter;
use crate::gpu::{
    Bindings, DrawPipeline, Gpu, Lease, Recorder, Scratch, Span, Stage, array_view, bindings, compute_pipeline,
    depth_state, samples, slice_views, texels,
};
use crate::light_map::caster_depth::CasterDepth;
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;
use crate::techniques::light_views::{Batch, BatchBindings, DepthMapsBatch, MapSamplers, SampleViews};

bindings! {
    struct IntegerMapsBatch = "reprojected maps", COMPUTE, group 1 of [REPROJECTION_ACCUMULATE_MANUAL],
        with views: BatchBindings
    {
        3 maps: Storage,
    }

    struct CopiedMapsBatch = "copied reprojected maps", COMPUTE, group 1 of [REPROJECTION_ACCUMULATE_COPIED],
        with views: BatchBindings
    {
        3 maps: TextureArray(texels::FLOAT),
        4 gather_sampler: Sampler(samples::TAKES),
    }

    struct DrawnMaps = "draw maps", FRAGMENT, group 0 of [REPROJECTION_DRAW] {
        0 draw_maps: Uniform,
        1 stored: Storage,
    }
}

/// Passes from integer maps to the mask.
#[derive(Debug)]
pub(super) struct Resolve {
    technique: &'static str,
    accumulate: Option<(ReprojectionFilter, Accumulate)>,
    filterable: Option<Filterable>,
}

/// Pipelines of a [`ReprojectionFilter`]; created on first use, since a host uses one.
#[derive(Debug)]
struct Accumulate {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    samplers: MapSamplers,
    draw: Option<(wgpu::BindGroupLayout, wgpu::RenderPipeline)>,
}

/// Texture that the integers are copied or drawn into.
#[derive(Debug)]
struct Filterable {
    lease: Lease,
    texture: Arc<wgpu::Texture>,
    array: wgpu::TextureView,
    slices: Vec<wgpu::TextureView>,
}

/// Resolve pass of one frame.
#[derive(Debug)]
pub(super) struct PreparedResolve {
    accumulate: wgpu::ComputePipeline,
    /// Bind groups of `accumulate`, one per batch.
    batches: Vec<wgpu::BindGroup>,
    /// Pipeline and bind group that draw integer maps into textures.
    draw: Option<(wgpu::RenderPipeline, wgpu::BindGroup)>,
}

impl Resolve {
    pub(super) fn new(technique: &'static str) -> Self {
        Self { technique, accumulate: None, filterable: None }
    }

    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        filter: ReprojectionFilter,
        inputs: &FrameInputs,
        sample_views: &SampleViews,
        targets: &Targets,
    ) -> PreparedResolve {
        self.make_filterable(stage, filter, targets);
        let technique = self.technique;
        if self.accumulate.as_ref().is_some_and(|(made, _)| *made != filter) {
            self.accumulate = None;
        }
        let (_, accumulate) =
            self.accumulate.get_or_insert_with(|| (filter, Accumulate::new(stage, technique, filter, inputs)));
        let filterable = self.filterable.as_ref();
        let MapSamplers { gather: gather_sampler, comparison: comparison_sampler } = &accumulate.samplers;
        let bind_accumulate = |batch: &Batch| {
            let (layout, views) = (&accumulate.layout, batch.bindings());
            match (filterable.map(|filterable| &filterable.array), &accumulate.draw) {
                (None, _) => IntegerMapsBatch { views, maps: &targets.buffer }.group(stage, layout),
                (Some(maps), None) => CopiedMapsBatch { views, maps, gather_sampler }.group(stage, layout),
                (Some(maps), Some(_)) => {
                    DepthMapsBatch { views, maps, gather_sampler, comparison_sampler }.group(stage, layout)
                }
            }
        };
        let draw = accumulate.draw.as_ref().map(|(layout, pipeline)| {
            let draw_maps =
                DrawMaps { view_size: targets.view_size, row_texels: targets.row_texels, ..DrawMaps::default() };
            let uniform = stage.uniform("antumbra draw maps", &draw_maps);
            (pipeline.clone(), DrawnMaps { draw_maps: &uniform, stored: &targets.buffer }.group(stage, layout))
        });
        let batches = sample_views.batches().iter().map(bind_accumulate).collect();
        PreparedResolve { accumulate: accumulate.pipeline.clone(), batches, draw }
    }

    fn make_filterable(&mut self, stage: &Stage<'_>, filter: ReprojectionFilter, targets: &Targets) {
        let (format, usage) = match filter {
            ReprojectionFilter::Manual => {
                self.filterable = None;
                return;
            }
            ReprojectionFilter::Copy => (wgpu::TextureFormat::R32Float, wgpu::TextureUsages::COPY_DST),
            ReprojectionFilter::Draw => (CasterDepth::FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT),
        };
        let size = wgpu::Extent3d {
            width: targets.view_size,
            height: targets.view_size,
            depth_or_array_layers: targets.map_count,
        };
        if self.filterable.as_ref().is_some_and(|f| f.texture.size() == size && f.texture.format() == format) {
            return;
        }
        // The old texture goes back to the budget before a new one is taken.
        self.filterable = None;
        let bytes = u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers) * 4;
        let lease = Lease::new(&stage.device, bytes);
        let descriptor = wgpu::TextureDescriptor {
            label: Some("antumbra filterable reprojected maps"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let texture = lease.texture(&stage.device, Scratch::FilterableMaps, &descriptor);
        let (array, slices) = (array_view(stage, &texture), slice_views(stage, &texture));
        self.filterable = Some(Filterable { lease, texture, array, slices });
    }

    /// Adds batch `index`, of `map_count` maps, to the mask.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &PreparedInputs,
        targets: &Targets,
        prepared: &PreparedResolve,
        index: usize,
        map_count: u32,
    ) {
        if let Some(filterable) = &self.filterable {
            match &prepared.draw {
                Some((pipeline, bind_group)) => record_draw(recorder, filterable, pipeline, bind_group, map_count),
                None => record_copy(recorder, filterable, targets, map_count),
            }
        }
        recorder.compute("accumulate", Span::Only, |pass| {
            pass.set_pipeline(&prepared.accumulate);
            inputs.bind(pass);
            pass.set_bind_group(1, &prepared.batches[index], &[]);
            inputs.dispatch(pass);
        });
    }

    /// Bytes of the texture that the integers are copied or drawn into.
    pub(super) fn memory_bytes(&self) -> u64 {
        self.filterable.as_ref().map_or(0, |filterable| filterable.lease.own_bytes())
    }
}

fn record_copy(recorder: &mut Recorder<'_>, filterable: &Filterable, targets: &Targets, map_count: u32) {
    recorder.commands("filterable depth maps", Span::Only, |encoder| {
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo {
                buffer: &targets.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(targets.row_texels * 4),
                    rows_per_image: Some(targets.view_size),
                },
            },
            filterable.texture.as_image_copy(),
            wgpu::Extent3d { width: targets.view_size, height: targets.view_size, depth_or_array_layers: map_count },
        );
    });
}

fn record_draw(
    recorder: &mut Recorder<'_>,
    filterable: &Filterable,
    pipeline: &wgpu::RenderPipeline,
    bind_group: &wgpu::BindGroup,
    map_count: u32,
) {
    for map in 0..map_count {
        let span = Span::of(map as usize, map_count as usize);
        let target = &filterable.slices[map as usize];
        recorder.depth_pass("filterable depth maps", span, target, CasterDepth::CLEAR_DEPTH, |pass| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind_group, &[]);
            pass.draw(0..3, map..map + 1);
        });
    }
}

impl Accumulate {
    fn new(gpu: &Gpu, technique: &'static str, filter: ReprojectionFilter, inputs: &FrameInputs) -> Self {
        let (wgsl, layout) = match filter {
            ReprojectionFilter::Manual => (shaders::REPROJECTION_ACCUMULATE_MANUAL, IntegerMapsBatch::layout(gpu)),
            ReprojectionFilter::Copy => (shaders::REPROJECTION_ACCUMULATE_COPIED, CopiedMapsBatch::layout(gpu)),
            ReprojectionFilter::Draw => (shaders::MULTI_VIEW_ACCUMULATE, DepthMapsBatch::layout(gpu)),
        };
        let draw = (filter == ReprojectionFilter::Draw).then(|| {
            let layout = DrawnMaps::layout(gpu);
            let screen = DrawPipeline {
                label: "antumbra draw maps",
                wgsl: shaders::REPROJECTION_DRAW,
                layouts: &[Some(&layout)],
                fragment: Some("draw"),
                depth: Some(depth_state(CasterDepth::FORMAT, wgpu::CompareFunction::Always, true)),
                ..DrawPipeline::default()
            };
            let pipeline = screen.create(gpu);
            (layout, pipeline)
        });
        Self {
            pipeline: compute_pipeline(gpu, technique, wgsl, &[&inputs.layout, &layout]),
            layout,
            samplers: MapSamplers::new(gpu),
            draw,
        }
    }
}
