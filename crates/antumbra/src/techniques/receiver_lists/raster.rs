//! Regions of influence drawn by the rasteriser: the published way for triangles to find their receivers.

use std::collections::HashMap;
use std::sync::LazyLock;

use glam::UVec2;

use crate::gpu::{
    Bindings, DrawPipeline, Gpu, NoDepth, Recorder, Span, Stage, compute_pipeline, depth_state, dispatch_threads,
    sized_buffer, with_early_depth_test,
};
use crate::receivers::inputs::{FrameInputs, PreparedInputs};
use crate::shaders;

use super::groups::{DrawArguments, Layouts, RegionHulls, Window};
use super::pipelines::Evaluator;
use super::region::Region;

/// Options of drawn triangles that the paper uses and the default leaves out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct RasterOptions {
    pub(crate) region: Region,
    /// Whether planes are those of the triangle and the light, for a light of one point; otherwise of the triangle and each receiver.
    pub(crate) light_planes: bool,
    /// Whether lists store the receivers' positions.
    pub(crate) stored_positions: bool,
    /// Whether a depth test discards fragments over empty lists, if the device supports an early depth test.
    pub(crate) stencil: bool,
}

/// Pipelines and targets that draw triangles into the windows of the light's map.
#[derive(Debug)]
pub(super) struct Raster {
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) arguments_layout: wgpu::BindGroupLayout,
    pub(super) arguments: wgpu::ComputePipeline,
    /// Passes over the listed receivers before all draws, and after them.
    pub(super) before: wgpu::ComputePipeline,
    pub(super) after: wgpu::ComputePipeline,
    /// Pipelines, created when a frame first needs them.
    pipelines: HashMap<(Evaluator, RasterOptions), wgpu::RenderPipeline>,
    silhouettes: Option<wgpu::RenderPipeline>,
    stencil: Option<wgpu::RenderPipeline>,
    hulls: Option<(wgpu::BindGroupLayout, wgpu::ComputePipeline)>,
    no_depth: Option<NoDepth>,
    stencil_map: Option<StencilMap>,
    draw: Option<wgpu::Buffer>,
}

/// Attachments of a frame's draws, and the buffer of their arguments.
#[derive(Clone, Debug)]
pub(super) struct RasterTargets {
    no_depth: wgpu::TextureView,
    /// Depth map of the lists' stencil; `None` if the stencil is off.
    stencil_map: Option<wgpu::TextureView>,
    pub(super) arguments: wgpu::Buffer,
}

/// Draws of a batch's triangles over all windows.
#[derive(Debug)]
pub(super) struct Draw {
    pub(super) targets: RasterTargets,
    /// Writes the indirect arguments.
    pub(super) make_arguments: wgpu::ComputePipeline,
    pub(super) pipeline: wgpu::RenderPipeline,
    /// Marks the texels that penumbrae can reach.
    pub(super) silhouettes: Option<wgpu::RenderPipeline>,
    /// Marks the texels whose lists contain receivers.
    pub(super) stencil: Option<wgpu::RenderPipeline>,
    pub(super) arguments: wgpu::BindGroup,
    /// Computes the triangles' regions, if they are hulls of hexagons.
    pub(super) hulls: Option<Hulls>,
    /// Group 1 of each window.
    pub(super) windows: Vec<wgpu::BindGroup>,
}

/// Computation of the hulls of a batch's triangles.
#[derive(Debug)]
pub(super) struct Hulls {
    pub(super) pipeline: wgpu::ComputePipeline,
    /// Group 1 of each window.
    pub(super) windows: Vec<wgpu::BindGroup>,
    /// Largest number of triangles.
    pub(super) triangles: u32,
}

/// Depth map in place of the paper's stencil: farthest where a list contains receivers, nearest elsewhere.
#[derive(Debug)]
struct StencilMap {
    size: UVec2,
    view: wgpu::TextureView,
}

impl StencilMap {
    /// Smallest depth format that every device can render to; the map has only two values.
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
    pub(super) fn new(gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) -> Self {
        let over_receivers = [&inputs.layout, &layouts.evaluate, &layouts.surface];
        let arguments_layout = DrawArguments::layout(gpu);
        Self {
            layout: Window::layout(gpu),
            arguments: compute_pipeline(
                gpu,
                "view-sample raster arguments",
                shaders::RASTER_ARGUMENTS,
                &[&arguments_layout],
            ),
            before: compute_pipeline(gpu, "view-sample before", shaders::RASTER_OPEN_POINTS, &over_receivers),
            after: compute_pipeline(gpu, "view-sample after", shaders::RASTER_SUM_VISIBLE, &over_receivers),
            arguments_layout,
            pipelines: HashMap::new(),
            silhouettes: None,
            stencil: None,
            hulls: None,
            no_depth: None,
            stencil_map: None,
            draw: None,
        }
    }

    /// Prepares targets for windows of a given width, texels.
    pub(super) fn prepare(&mut self, stage: &Stage<'_>, window_side: u32, drawn: RasterOptions) -> RasterTargets {
        let size = UVec2::splat(window_side);
        let made = self.no_depth.take().filter(|no_depth| no_depth.size() == size);
        let no_depth = self.no_depth.insert(made.unwrap_or_else(|| NoDepth::new(stage, size, 1))).view().clone();
        let made = self.stencil_map.take().filter(|map| map.size == size);
        self.stencil_map = drawn.stencil.then(|| made.unwrap_or_else(|| StencilMap::new(stage, size)));
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        RasterTargets {
            no_depth,
            stencil_map: self.stencil_map.as_ref().map(|map| map.view.clone()),
            arguments: sized_buffer(stage, &mut self.draw, "view-sample draw", 16, usage).clone(),
        }
    }

    /// Returns the pipeline for casters of the given kind.
    pub(super) fn pipeline(
        &mut self,
        gpu: &Gpu,
        inputs: &FrameInputs,
        layouts: &Layouts,
        evaluator: Evaluator,
        drawn: RasterOptions,
    ) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || pipeline(gpu, &[&inputs.layout, layout, &layouts.surface], evaluator, drawn);
        self.pipelines.entry((evaluator, drawn)).or_insert_with(make).clone()
    }

    /// Returns the pipeline that marks the texels that penumbrae can reach.
    pub(super) fn silhouettes(&mut self, gpu: &Gpu, inputs: &FrameInputs) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || {
            DrawPipeline {
                label: "view-sample silhouettes",
                wgsl: shaders::RASTER_SILHOUETTES,
                layouts: &[Some(&inputs.layout), Some(layout)],
                primitive: STRIP,
                depth: Some(NoDepth::state()),
                ..DrawPipeline::default()
            }
            .create(gpu)
        };
        self.silhouettes.get_or_insert_with(make).clone()
    }

    /// Returns the pipeline that marks the texels whose lists contain receivers.
    pub(super) fn stencil(&mut self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let layout = &self.layout;
        let make = || {
            DrawPipeline {
                label: "view-sample stencil",
                wgsl: shaders::RASTER_STENCIL,
                layouts: &[None, Some(layout)],
                depth: Some(depth_state(StencilMap::FORMAT, wgpu::CompareFunction::Always, true)),
                ..DrawPipeline::default()
            }
            .create(gpu)
        };
        self.stencil.get_or_insert_with(make).clone()
    }

    /// Returns the pipeline that computes hulls, and the layout of its group 1.
    pub(super) fn hulls(&mut self, gpu: &Gpu, inputs: &FrameInputs) -> &(wgpu::BindGroupLayout, wgpu::ComputePipeline) {
        self.hulls.get_or_insert_with(|| {
            let layout = RegionHulls::layout(gpu);
            let wgsl = shaders::RASTER_HULLS;
            let pipeline = compute_pipeline(gpu, "view-sample region hulls", wgsl, &[&inputs.layout, &layout]);
            (layout, pipeline)
        })
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.stencil_map.as_ref().map_or(0, StencilMap::memory_bytes) + self.draw.as_ref().map_or(0, wgpu::Buffer::size)
    }
}

impl Draw {
    /// Records a batch's draws.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, inputs: &PreparedInputs, surface: &wgpu::BindGroup) {
        let RasterTargets { no_depth, stencil_map, arguments } = &self.targets;
        recorder.compute("regions of influence", Span::Only, |pass| {
            pass.set_pipeline(&self.make_arguments);
            pass.set_bind_group(0, &self.arguments, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
        for (i, window) in self.windows.iter().enumerate() {
            if let Some(hulls) = &self.hulls {
                recorder.compute("regions' hulls", Span::Only, |pass| {
                    pass.set_pipeline(&hulls.pipeline);
                    inputs.bind(pass);
                    pass.set_bind_group(1, &hulls.windows[i], &[]);
                    dispatch_threads(pass, hulls.triangles);
                });
            }
            if let Some(pipeline) = &self.silhouettes {
                recorder.render_pass("silhouettes", Span::Only, &[], no_depth, None, |pass| {
                    pass.set_pipeline(pipeline);
                    inputs.bind_drawn(pass);
                    pass.set_bind_group(1, window, &[]);
                    pass.draw_indirect(arguments, 0);
                });
            }
            let stencil = self.stencil.as_ref().zip(stencil_map.as_ref());
            if let Some((pipeline, map)) = stencil {
                let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
                recorder.render_pass("lists' stencil", Span::Only, &[], map, Some(ops), |pass| {
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(1, window, &[]);
                    pass.draw(0..3, 0..1);
                });
            }
            let depth = stencil.map_or(no_depth, |(_, map)| map);
            recorder.render_pass("regions of influence", Span::Only, &[], depth, None, |pass| {
                pass.set_pipeline(&self.pipeline);
                inputs.bind_drawn(pass);
                pass.set_bind_group(1, window, &[]);
                pass.set_bind_group(2, surface, &[]);
                pass.draw_indirect(arguments, 0);
            });
        }
    }
}

/// Triangle strip without culling, because mirrored windows reverse the regions' orientation.
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
    drawn: RasterOptions,
) -> wgpu::RenderPipeline {
    let is_early = drawn.stencil && gpu.has(wgpu::Features::SHADER_EARLY_DEPTH_TEST);
    let wgsl = match (drawn.light_planes, is_early) {
        (false, false) => shaders::RASTER_DRAW,
        (false, true) => &EARLY_RASTER,
        (true, false) => shaders::RASTER_DRAW_BY_LIGHT_PLANES,
        (true, true) => &EARLY_LIGHT_PLANES,
    };
    let has = |name: &str| match name {
        "HAS_TINT" => false,
        // A single light point has no counters and no lookup table.
        "USES_TABLE" | "COUNTS" | "IS_FLAT" => !drawn.light_planes,
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

/// Shaders with the depth test before the fragment stage.
static EARLY_RASTER: LazyLock<String> = LazyLock::new(|| with_early_depth_test(shaders::RASTER_DRAW));
static EARLY_LIGHT_PLANES: LazyLock<String> =
    LazyLock::new(|| with_early_depth_test(shaders::RASTER_DRAW_BY_LIGHT_PLANES));
