//! Scatter of the central views' fragments into a batch of integer maps.

use std::sync::Arc;

use antumbra_light::{Aabb, LightPoint};
use glam::UVec2;

use super::central::{GroupRange, Views};
use super::gpu_types::{SplatBatch, ViewGroup};
use super::scatter_program::{PipelineKey, Program, ScatterLayouts, Scattering};
use super::settings::{Settings, Splat};
use super::surfel_list::{Limits, PreparedList, SurfelList};
use crate::contract::MeshCaster;
use crate::gpu::{Bindings, Gpu, NoDepth, Recorder, Span, Stage, bindings, sized_buffer, texels};
use crate::light_map::caster_depth::{CasterDepth, CasterProgram};
use crate::light_map::depth_layers::{DepthLayers, LayersSize};

bindings! {
    struct CentralMap = "central map", COMPUTE | FRAGMENT, group 1 of [REPROJECTION_SPLAT_POINTS, REPROJECTION_SPLAT_SCREEN] {
        0 central_depth: TextureArray(texels::DEPTH),
    }

    /// Bindings of passes over a central map, each into one group of views.
    struct GroupSplat = "splat", COMPUTE | FRAGMENT,
        group 2 of [REPROJECTION_SPLAT_POINTS, REPROJECTION_SPLAT_SURFELS, REPROJECTION_SPLAT_SCREEN]
    {
        0 batch: Uniform,
        1 views: DynamicUniform(size_of::<ViewGroup>()),
        2 targets: ReadWrite,
    }

    /// Bindings of the central rasterisation itself, into all groups.
    struct RasterisedSplat = "splat while rasterising", COMPUTE | FRAGMENT,
        group 2 of [REPROJECTION_SPLAT_OPAQUE, REPROJECTION_SPLAT_CUTOUT]
    {
        0 batch: Uniform,
        1 view_groups: Storage,
        2 targets: ReadWrite,
    }
}

/// Label of the scatter, including its clear.
const REPROJECT: &str = "reprojected depth maps";

/// Texels along each side of a scatter's workgroup: 8 threads of 2 texels each.
const TILE_TEXELS: u32 = 8 * 2;

/// Texels along each side that one fragment scatters, if fragments scatter.
const FRAGMENT_TEXELS: u32 = 2;

/// Half a surfel's side, central texels: a hundredth more than a fragment's. If both maps' texels fall on one grid, texel
/// centres lie on fragments' edges, and rounding would leave cracks. A longer reach closes the last cracks of curved surfaces, and
/// widens every occluder: at .55 the leak on `shanty` falls by a third and the overshadow grows by a half.
pub(crate) const SURFEL_REACH: f32 = 0.505;

/// Integer maps of one batch, row by row and map by map.
#[derive(Debug)]
pub(super) struct Targets {
    pub(super) buffer: wgpu::Buffer,
    pub(super) view_size: u32,
    /// Row pitch, texels: rows start at the alignment of copies to textures.
    pub(super) row_texels: u32,
    pub(super) map_count: u32,
}

/// Passes from central maps to integer maps.
#[derive(Debug)]
pub(super) struct Scatter {
    layouts: ScatterLayouts,
    program: Option<(PipelineKey, Arc<Program>)>,
    /// List of surfels that compute scatters; created on first use.
    list: Option<SurfelList>,
    limits: Limits,
    groups: Option<wgpu::Buffer>,
    /// Depth attachment of a fragment pass over a central map, which is not attached itself while it is read.
    no_depth: Option<NoDepth>,
}

/// Scatter of one frame.
#[derive(Debug)]
pub(super) struct PreparedScatter {
    program: Arc<Program>,
    central: Option<wgpu::BindGroup>,
    list: Option<PreparedList>,
    /// Scatters by batch and central view.
    batches: Vec<Vec<ViewSplat>>,
}

/// Scatter of one central view into one batch.
#[derive(Debug)]
struct ViewSplat {
    bind_group: wgpu::BindGroup,
    groups: GroupRange,
}

impl Scatter {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            layouts: ScatterLayouts {
                central: CentralMap::layout(gpu),
                group: GroupSplat::layout(gpu),
                rasterised: RasterisedSplat::layout(gpu),
            },
            program: None,
            list: None,
            limits: Limits::DEFAULT,
            groups: None,
            no_depth: None,
        }
    }

    /// Uploads `groups` and creates missing objects; `ranges` has the groups of each batch and central view.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        settings: &Settings,
        views: &Views,
        is_affine: bool,
        (groups, ranges): (&[ViewGroup], &[Vec<GroupRange>]),
        layers: &DepthLayers,
        targets: &Targets,
        points: &[LightPoint],
        receivers: Option<Aabb>,
    ) -> PreparedScatter {
        let bytes = bytemuck::cast_slice::<ViewGroup, u8>(groups);
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let buffer =
            sized_buffer(stage, &mut self.groups, "antumbra targets from central", bytes.len() as u64, usage).clone();
        stage.upload(&buffer, 0, bytes);
        let key = PipelineKey::of(settings, views, is_affine);
        let is_listed = key.scattering == Scattering::Compute && key.is_surfel;
        if is_listed {
            self.list.get_or_insert_with(|| SurfelList::new(stage, &self.layouts.group));
        } else {
            self.list = None;
        }
        let made = self.program.take().filter(|(made, _)| *made == key);
        let make = || Arc::new(Program::new(stage, &self.layouts, layers, self.list.as_ref(), key));
        let program = made.map_or_else(make, |(_, program)| program);
        self.program = Some((key, Arc::clone(&program)));
        let screen_size = UVec2::splat(layers.size().size.div_ceil(FRAGMENT_TEXELS));
        self.no_depth = (key.scattering == Scattering::Screen).then(|| match self.no_depth.take() {
            Some(no_depth) if no_depth.size() == screen_size => no_depth,
            _ => NoDepth::new(stage, screen_size, 1),
        });
        let bind_splat = |view: usize, groups: GroupRange| {
            let batch = splat_batch(settings, views, view, groups, layers, targets, points, receivers);
            let uniform = stage.uniform("antumbra splat", &batch);
            let (batch, targets) = (&uniform, &targets.buffer);
            let bind_group = match key.scattering {
                Scattering::Raster { .. } => {
                    RasterisedSplat { batch, view_groups: &buffer, targets }.group(stage, &self.layouts.rasterised)
                }
                _ => GroupSplat { batch, views: &buffer, targets }.group(stage, &self.layouts.group),
            };
            ViewSplat { bind_group, groups }
        };
        let of_batch = |of_views: &Vec<GroupRange>| {
            of_views.iter().enumerate().map(|(view, groups)| bind_splat(view, *groups)).collect()
        };
        let batches = ranges.iter().map(of_batch).collect();
        let list = self.list.as_mut().map(|list| list.prepare(stage, layers, self.limits));
        let central = (settings.source.needs_central_map() && !is_listed)
            .then(|| CentralMap { central_depth: layers.depth_array() }.group(stage, &self.layouts.central));
        PreparedScatter { program, central, list, batches }
    }

    /// Clears the maps and scatters all central views into batch `index`.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        layers: &DepthLayers,
        targets: &Targets,
        prepared: &PreparedScatter,
        index: usize,
        meshes: &[MeshCaster<'_>],
    ) {
        let program = &*prepared.program;
        let splats = &prepared.batches[index];
        let clear = |recorder: &mut Recorder<'_>| {
            recorder.commands(REPROJECT, Span::First, |encoder| encoder.clear_buffer(&targets.buffer, 0, None));
        };
        if let (Program::Surfels(pipeline), Some(list), Some(of_frame)) = (program, &self.list, &prepared.list) {
            let splats: Vec<_> = splats.iter().map(|splat| (&splat.bind_group, splat.offsets().collect())).collect();
            list.record_collect(recorder, of_frame, index == 0, &splats);
            clear(recorder);
            list.record_scatter(recorder, REPROJECT, of_frame, pipeline, &splats);
            return;
        }
        clear(recorder);
        let central = prepared.central.as_ref();
        match program {
            Program::Surfels(_) => {}
            Program::Points(pipeline) => record_points(recorder, pipeline, layers.size(), central, splats),
            Program::Screen(pipeline) => self.record_screen(recorder, pipeline, central, splats),
            Program::Raster(program) => record_raster(recorder, program, layers, splats, meshes),
        }
    }

    /// Records the scatter by fragments that cover the central maps.
    fn record_screen(
        &self,
        recorder: &mut Recorder<'_>,
        pipeline: &wgpu::RenderPipeline,
        central: Option<&wgpu::BindGroup>,
        splats: &[ViewSplat],
    ) {
        let no_depth = self.no_depth.as_ref().expect("`prepare` creates it for this path");
        for (view, splat) in splats.iter().enumerate() {
            recorder.render_pass(REPROJECT, span_of(view, splats), &[], no_depth.view(), None, |pass| {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, central, &[]);
                for offset in splat.offsets() {
                    pass.set_bind_group(2, &splat.bind_group, &[offset]);
                    pass.draw(0..3, 0..1);
                }
            });
        }
    }

    /// List of surfels and its counts, if there is one.
    #[cfg(test)]
    pub(super) fn list_buffers(&self) -> Option<[&wgpu::Buffer; 2]> {
        self.list.as_ref()?.buffers()
    }

    /// Limits the list for a test.
    #[cfg(test)]
    pub(super) fn limit(&mut self, limits: Limits) {
        self.limits = limits;
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.groups.as_ref().map_or(0, wgpu::Buffer::size) + self.list.as_ref().map_or(0, SurfelList::memory_bytes)
    }
}

impl ViewSplat {
    /// Offset of each group's views, bytes.
    fn offsets(&self) -> impl Iterator<Item = u32> {
        let GroupRange { first, count } = self.groups;
        (first..first + count).map(|group| group * size_of::<ViewGroup>() as u32)
    }
}

/// Records the scatter by a thread per 2 × 2 texels.
fn record_points(
    recorder: &mut Recorder<'_>,
    pipeline: &wgpu::ComputePipeline,
    size: LayersSize,
    central: Option<&wgpu::BindGroup>,
    splats: &[ViewSplat],
) {
    recorder.compute(REPROJECT, Span::Last, |pass| {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, central, &[]);
        let tiles = size.size.div_ceil(TILE_TEXELS);
        for splat in splats {
            for offset in splat.offsets() {
                pass.set_bind_group(2, &splat.bind_group, &[offset]);
                pass.dispatch_workgroups(tiles, tiles, size.layers);
            }
        }
    });
}

/// Records the scatter by the fragments of the casters, drawn in the central views.
fn record_raster(
    recorder: &mut Recorder<'_>,
    program: &CasterProgram,
    layers: &DepthLayers,
    splats: &[ViewSplat],
    meshes: &[MeshCaster<'_>],
) {
    for (view, splat) in splats.iter().enumerate() {
        let slice = &layers.depth_slices()[view * layers.size().layers as usize];
        let ops =
            wgpu::Operations { load: wgpu::LoadOp::Clear(CasterDepth::CLEAR_DEPTH), store: wgpu::StoreOp::Discard };
        recorder.render_pass(REPROJECT, span_of(view, splats), &[], slice, Some(ops), |pass| {
            pass.set_bind_group(2, &splat.bind_group, &[]);
            layers.casters().draw_with(program, pass, view as u32, meshes);
        });
    }
}

/// Returns the span of a view's pass, after the clear.
fn span_of(view: usize, splats: &[ViewSplat]) -> Span {
    if view + 1 == splats.len() { Span::Last } else { Span::Middle }
}

fn splat_batch(
    settings: &Settings,
    views: &Views,
    view: usize,
    groups: GroupRange,
    layers: &DepthLayers,
    targets: &Targets,
    points: &[LightPoint],
    receivers: Option<Aabb>,
) -> SplatBatch {
    let (reach, steepest) = match settings.splat {
        Splat::Point => (0.0, 0.0),
        Splat::NearCentre(texels) => (texels, 0.0),
        Splat::Surfel(slope) => (SURFEL_REACH, slope),
    };
    let (width_of_depth, width) = views.central[view].depth_per_texel(views.central_size, 1.0);
    let middle = views.central[0].frame.center;
    let light_radius_m = points.iter().map(|point| point.xyz.distance(middle)).fold(0.0, f32::max);
    // The centre of a flat piece may lie a texel beyond the texels that it covers.
    let face_half_size = views.central[0].window.half_size.x * (1.0 + 4.0 / views.view_size as f32);
    SplatBatch {
        view_size: targets.view_size,
        row_texels: targets.row_texels,
        first_group: groups.first,
        group_count: groups.count,
        first_slice: view as u32 * layers.size().layers,
        has_receivers: receivers.is_some().into(),
        reach,
        steepest,
        width_of_depth,
        width,
        face_half_size,
        face_slack_m: (1.0 + 2.0 * face_half_size) * light_radius_m,
        light_front: views.light_front_in_central(view),
        receivers: receivers.map_or_else(Default::default, |bounds| views.in_central(view, bounds)),
        ..views.light_in_central(view, points)
    }
}
