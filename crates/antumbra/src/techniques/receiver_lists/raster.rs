//! Regions of influence by the rasteriser: the paper's own way for triangles to find their receivers.

use std::collections::HashMap;

use glam::UVec2;

use crate::frame::inputs::FrameInputs;
use crate::gpu::{
    Gpu, NoDepth, Recorder, Span, Stage, compute_pipeline, read_write_entry, shader_module, sized_buffer,
    storage_entry, texture_entry, uniform_entry,
};
use crate::shaders;

use super::pipelines::{Evaluator, Layouts};

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
        const VERTEX: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX;
        const FRAGMENT: wgpu::ShaderStages = wgpu::ShaderStages::FRAGMENT;
        const COMPUTE: wgpu::ShaderStages = wgpu::ShaderStages::COMPUTE;
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let table = texture_entry(7, wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D3);
        let arguments_layout = layout(
            "view-sample raster arguments",
            &[
                uniform_entry(0, COMPUTE),
                storage_entry(1, COMPUTE),
                storage_entry(2, COMPUTE),
                read_write_entry(3, COMPUTE),
            ],
        );
        Self {
            layout: layout(
                "view-sample raster",
                &[
                    uniform_entry(0, VERTEX | FRAGMENT),
                    storage_entry(1, FRAGMENT),
                    storage_entry(2, VERTEX | FRAGMENT),
                    storage_entry(3, VERTEX),
                    storage_entry(4, FRAGMENT),
                    read_write_entry(5, FRAGMENT),
                    storage_entry(6, FRAGMENT),
                    wgpu::BindGroupLayoutEntry { visibility: FRAGMENT, ..table },
                    read_write_entry(8, FRAGMENT),
                    storage_entry(9, VERTEX),
                ],
            ),
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
    let module = shader_module(gpu, "view-sample raster", shaders::VIEW_SAMPLES_RASTER);
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("view-sample raster"),
        bind_group_layouts: &layouts.map(Some),
        immediate_size: 0,
    });
    let constants: Vec<_> = evaluator.constants().into_iter().filter(|(name, _)| *name != "HAS_TINT").collect();
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("view-sample raster"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        // Regions seen through a mirrored window turn the other way: nothing is culled.
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(NoDepth::state()),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}
