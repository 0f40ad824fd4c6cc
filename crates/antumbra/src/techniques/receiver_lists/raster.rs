//! Regions of influence by the rasteriser: the paper's own way for triangles to find their receivers.

use std::collections::HashMap;

use glam::UVec2;

use crate::frame::inputs::FrameInputs;
use crate::gpu::{Bindings, DrawPipeline, Gpu, NoDepth, Recorder, Span, Stage, compute_pipeline, sized_buffer};
use crate::shaders;

use super::groups::{DrawArguments, Layouts, Window};
use super::pipelines::Evaluator;

/// What draws triangles into the windows of the light's map.
#[derive(Debug)]
pub(super) struct Raster {
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) arguments_layout: wgpu::BindGroupLayout,
    arguments: wgpu::ComputePipeline,
    /// Made when a frame first needs them.
    pipelines: HashMap<Evaluator, wgpu::RenderPipeline>,
    no_depth: Option<NoDepth>,
    draw: Option<wgpu::Buffer>,
}

/// A batch's triangles over all windows.
#[derive(Debug)]
pub(super) struct Draw {
    pub(super) pipeline: wgpu::RenderPipeline,
    pub(super) arguments: wgpu::BindGroup,
    /// Group 1, for each window.
    pub(super) windows: Vec<wgpu::BindGroup>,
}

impl Raster {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let arguments_layout = DrawArguments::layout(gpu);
        Self {
            layout: Window::layout(gpu),
            arguments: compute_pipeline(
                gpu,
                "view-sample raster arguments",
                shaders::VIEW_SAMPLES_RASTER_ARGUMENTS,
                &[&arguments_layout],
            ),
            arguments_layout,
            pipelines: HashMap::new(),
            no_depth: None,
            draw: None,
        }
    }

    /// Makes room for windows of so many texels a side; the buffer is of the draw's arguments.
    pub(super) fn prepare(&mut self, stage: &Stage<'_>, window_side: u32) -> &wgpu::Buffer {
        let size = UVec2::splat(window_side);
        if self.no_depth.as_ref().is_none_or(|no_depth| no_depth.size() != size) {
            self.no_depth = Some(NoDepth::new(stage, size, 1));
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        sized_buffer(stage, &mut self.draw, "view-sample draw", 16, usage)
    }

    /// The pipeline for such casters.
    pub(super) fn pipeline(
        &mut self,
        gpu: &Gpu,
        inputs: &FrameInputs,
        layouts: &Layouts,
        evaluator: Evaluator,
    ) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || pipeline(gpu, &[&inputs.layout, layout, &layouts.surface], evaluator);
        self.pipelines.entry(evaluator).or_insert_with(make).clone()
    }

    /// Records a batch's draws.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &FrameInputs,
        surface: &wgpu::BindGroup,
        draw: &Draw,
    ) {
        let (Some(no_depth), Some(arguments)) = (&self.no_depth, &self.draw) else {
            unreachable!("prepare comes before record");
        };
        recorder.compute("regions of influence", Span::Only, |pass| {
            pass.set_pipeline(&self.arguments);
            pass.set_bind_group(0, &draw.arguments, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
        for window in &draw.windows {
            recorder.render_pass("regions of influence", Span::Only, &[], &no_depth.view, None, |pass| {
                pass.set_pipeline(&draw.pipeline);
                inputs.bind_drawn(pass);
                pass.set_bind_group(1, window, &[]);
                pass.set_bind_group(2, surface, &[]);
                pass.draw_indirect(arguments, 0);
            });
        }
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.no_depth.as_ref().map_or(0, NoDepth::memory_bytes) + self.draw.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

fn pipeline(gpu: &Gpu, layouts: &[&wgpu::BindGroupLayout; 3], evaluator: Evaluator) -> wgpu::RenderPipeline {
    let constants: Vec<_> = evaluator.constants().into_iter().filter(|(name, _)| *name != "HAS_TINT").collect();
    DrawPipeline {
        label: "view-sample raster",
        wgsl: shaders::VIEW_SAMPLES_RASTER,
        layouts: &layouts.map(Some),
        constants: &constants,
        // Regions seen through a mirrored window turn the other way: nothing is culled.
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..wgpu::PrimitiveState::default()
        },
        depth: Some(NoDepth::state()),
        ..DrawPipeline::default()
    }
    .create(gpu)
}
