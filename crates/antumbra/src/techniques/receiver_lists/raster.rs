//! Regions of influence by the rasteriser: the paper's own way for triangles to find their receivers.

use std::collections::HashMap;
use std::sync::LazyLock;

use glam::UVec2;

use crate::frame::inputs::FrameInputs;
use crate::gpu::{
    Bindings, DrawPipeline, Gpu, NoDepth, Recorder, Span, Stage, compute_pipeline, depth_state, sized_buffer,
    with_early_depth_test,
};
use crate::shaders;

use super::groups::{DrawArguments, Layouts, Window};
use super::pipelines::Evaluator;

/// What the paper does to drawn triangles and their receivers, of what ours leaves out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Drawn {
    /// Six vertices a region, for a light of one point; else the twelve of three boxes.
    pub(crate) six_vertices: bool,
    /// Planes of the triangle and the light, for a light of one point; else of the triangle and each receiver.
    pub(crate) light_planes: bool,
    /// Lists with the receivers' positions.
    pub(crate) stored_positions: bool,
    /// A depth test that drops fragments over empty lists, where the device tests before the fragment stage.
    pub(crate) stencil: bool,
}

impl Drawn {
    /// As `SampleSettings::region_corners`.
    pub(super) fn region_corners(self) -> u32 {
        if self.six_vertices { 6 } else { 12 }
    }
}

/// What draws triangles into the windows of the light's map.
#[derive(Debug)]
pub(super) struct Raster {
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) arguments_layout: wgpu::BindGroupLayout,
    arguments: wgpu::ComputePipeline,
    /// Made when a frame first needs them.
    pipelines: HashMap<(Evaluator, Drawn), wgpu::RenderPipeline>,
    silhouettes: Option<wgpu::RenderPipeline>,
    stencil: Option<wgpu::RenderPipeline>,
    no_depth: Option<NoDepth>,
    stencil_map: Option<StencilMap>,
    draw: Option<wgpu::Buffer>,
}

/// A batch's triangles over all windows.
#[derive(Debug)]
pub(super) struct Draw {
    pub(super) pipeline: wgpu::RenderPipeline,
    /// Tells where penumbrae can fall.
    pub(super) silhouettes: Option<wgpu::RenderPipeline>,
    /// Tells where lists hold receivers.
    pub(super) stencil: Option<wgpu::RenderPipeline>,
    pub(super) arguments: wgpu::BindGroup,
    /// Group 1, for each window.
    pub(super) windows: Vec<wgpu::BindGroup>,
}

/// The depth map that stands for the paper's stencil: farthest where a list holds receivers, else nearest.
#[derive(Debug)]
struct StencilMap {
    size: UVec2,
    view: wgpu::TextureView,
}

impl StencilMap {
    /// Two values are all that it must tell apart: of the fewest bytes that every device can render to.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

    fn new(gpu: &Gpu, size: UVec2) -> Self {
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("view-sample stencil"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        Self { size, view: gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default()) }
    }

    fn memory_bytes(&self) -> u64 {
        2 * u64::from(self.size.element_product())
    }
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
            silhouettes: None,
            stencil: None,
            no_depth: None,
            stencil_map: None,
            draw: None,
        }
    }

    /// Makes room for windows of so many texels a side; the buffer is of the draw's arguments.
    pub(super) fn prepare(&mut self, stage: &Stage<'_>, window_side: u32, drawn: Drawn) -> &wgpu::Buffer {
        let size = UVec2::splat(window_side);
        if self.no_depth.as_ref().is_none_or(|no_depth| no_depth.size() != size) {
            self.no_depth = Some(NoDepth::new(stage, size, 1));
        }
        if !drawn.stencil {
            self.stencil_map = None;
        } else if self.stencil_map.as_ref().is_none_or(|map| map.size != size) {
            self.stencil_map = Some(StencilMap::new(stage, size));
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
        drawn: Drawn,
    ) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || pipeline(gpu, &[&inputs.layout, layout, &layouts.surface], evaluator, drawn);
        self.pipelines.entry((evaluator, drawn)).or_insert_with(make).clone()
    }

    /// The pipeline that tells where penumbrae can fall.
    pub(super) fn silhouettes(&mut self, gpu: &Gpu, inputs: &FrameInputs) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || {
            DrawPipeline {
                label: "view-sample silhouettes",
                wgsl: shaders::VIEW_SAMPLES_RASTER_SILHOUETTES,
                layouts: &[Some(&inputs.layout), Some(layout)],
                primitive: STRIP,
                depth: Some(NoDepth::state()),
                ..DrawPipeline::default()
            }
            .create(gpu)
        };
        self.silhouettes.get_or_insert_with(make).clone()
    }

    /// The pipeline that tells where lists hold receivers.
    pub(super) fn stencil(&mut self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || {
            DrawPipeline {
                label: "view-sample stencil",
                wgsl: shaders::VIEW_SAMPLES_RASTER_STENCIL,
                layouts: &[None, Some(layout)],
                depth: Some(depth_state(StencilMap::FORMAT, wgpu::CompareFunction::Always, true)),
                ..DrawPipeline::default()
            }
            .create(gpu)
        };
        self.stencil.get_or_insert_with(make).clone()
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
            if let Some(pipeline) = &draw.silhouettes {
                recorder.render_pass("silhouettes", Span::Only, &[], &no_depth.view, None, |pass| {
                    pass.set_pipeline(pipeline);
                    inputs.bind_drawn(pass);
                    pass.set_bind_group(1, window, &[]);
                    pass.draw_indirect(arguments, 0);
                });
            }
            let stencil = draw.stencil.as_ref().zip(self.stencil_map.as_ref());
            if let Some((pipeline, map)) = stencil {
                let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
                recorder.render_pass("lists' stencil", Span::Only, &[], &map.view, Some(ops), |pass| {
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(1, window, &[]);
                    pass.draw(0..3, 0..1);
                });
            }
            let depth = stencil.map_or(&no_depth.view, |(_, map)| &map.view);
            recorder.render_pass("regions of influence", Span::Only, &[], depth, None, |pass| {
                pass.set_pipeline(&draw.pipeline);
                inputs.bind_drawn(pass);
                pass.set_bind_group(1, window, &[]);
                pass.set_bind_group(2, surface, &[]);
                pass.draw_indirect(arguments, 0);
            });
        }
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.no_depth.as_ref().map_or(0, NoDepth::memory_bytes)
            + self.stencil_map.as_ref().map_or(0, StencilMap::memory_bytes)
            + self.draw.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

/// Regions seen through a mirrored window turn the other way: nothing is culled.
const STRIP: wgpu::PrimitiveState = wgpu::PrimitiveState {
    topology: wgpu::PrimitiveTopology::TriangleStrip,
    strip_index_format: None,
    front_face: wgpu::FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: wgpu::PolygonMode::Fill,
    conservative: false,
};

fn pipeline(
    gpu: &Gpu,
    layouts: &[&wgpu::BindGroupLayout; 3],
    evaluator: Evaluator,
    drawn: Drawn,
) -> wgpu::RenderPipeline {
    let is_early = drawn.stencil && gpu.has(wgpu::Features::SHADER_EARLY_DEPTH_TEST);
    let wgsl = match (drawn.light_planes, is_early) {
        (false, false) => shaders::VIEW_SAMPLES_RASTER,
        (false, true) => &EARLY_RASTER,
        (true, false) => shaders::VIEW_SAMPLES_RASTER_LIGHT_PLANES,
        (true, true) => &EARLY_LIGHT_PLANES,
    };
    let has = |name: &str| match name {
        "HAS_TINT" => false,
        "USES_TABLE" => !drawn.light_planes,
        _ => true,
    };
    let mut constants: Vec<_> = evaluator.constants().into_iter().filter(|(name, _)| has(name)).collect();
    constants.push(("STORED_POSITIONS", f64::from(u8::from(drawn.stored_positions))));
    DrawPipeline {
        label: "view-sample raster",
        wgsl,
        layouts: &layouts.map(Some),
        constants: &constants,
        primitive: STRIP,
        depth: Some(if drawn.stencil {
            depth_state(StencilMap::FORMAT, wgpu::CompareFunction::Less, false)
        } else {
            NoDepth::state()
        }),
        ..DrawPipeline::default()
    }
    .create(gpu)
}

/// The shaders with the depth test before the fragment stage.
static EARLY_RASTER: LazyLock<String> = LazyLock::new(|| with_early_depth_test(shaders::VIEW_SAMPLES_RASTER));
static EARLY_LIGHT_PLANES: LazyLock<String> =
    LazyLock::new(|| with_early_depth_test(shaders::VIEW_SAMPLES_RASTER_LIGHT_PLANES));
