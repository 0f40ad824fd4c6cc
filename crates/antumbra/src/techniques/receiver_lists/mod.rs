//! Passes of `alias_free` and `sample_based`: view-samples (receivers) in lists by their position as seen from the light,
//! triangles sorted by position, and one bit for each view-sample and light point.
//!
//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, "Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps",
//! EGSR 2008.
//!
//! ```text
//! depth ──► bounds ──► count ──► scan ──► scatter ──► lists ─────┐
//!              └► hull of receivers and light ─┐                 ▼
//! meshes ──► cull ──► count ──► scan ──► scatter ──► boxes ──► evaluate ──► mask
//!                                           └─► or drawn over the windows ──┘
//! ```
//!
//! | folder | contents | section |
//! |---|---|---|
//! | `lists` | receivers sorted into lists; the windows of the light's map | 3.1 |
//! | `triangles` | triangles that can matter, sorted into a grid, in clusters of 64 and clusters of clusters | |
//! | `light_bits` | the light's points, and which of them a triangle hides from a receiver | 3.3, 4.2 |
//! | `evaluation` | groups of 64 receivers that walk the triangles: `traversal=groups` | |
//! | `raster` | regions of influence, drawn over the windows: `traversal=raster`, as published | 3.2, 4.1 |
//!
//! # Groups of receivers
//! The paper rasterises each triangle's region of influence, and its fragments walk the lists. Its time has no bound that follows from a
//! scene's size: in a street under a sun the receivers of the first metres share a few texels of a map of two kilometres, and each triangle
//! over these texels walks them all. `traversal=groups` exchanges the loops. Sixty-four receivers that are neighbours in the lists share a
//! workgroup, and its *shaft*, the hull of their box and the light's, replaces the regions of influence. Lists may be of any length and
//! triangles of any number, nothing is stored per pair of the two, and a bit never leaves its thread.
//!
//! Three things keep the tests few:
//! 1. Lists are sorted by direction *and distance* from the light, so that a group holds neighbours in space.
//! 2. For each triangle that the group's shaft meets, a thread determines which of eight blocks of eight receivers it
//!    can affect (`evaluation/block_shafts.wesl`).
//! 3. Each receiver projects a triangle onto the light first (`light_bits/shadow_window.wesl`), and tests only the light points in the
//!    cells of a grid that the projection touches.
//!
//! For a single light point drawing is faster if lists are short. `alias_free` lets the device choose after the lists are counted
//! (`lists/choose.wesl`), and sorts them again by cells of space if many receivers share a texel. For hundreds of light points groups are
//! faster on every measured scene, and the default of `sample_based`. `bench/measurements.md` has the figures.
//!
//! # Drawn regions
//! Every triangle is drawn over the texels whose receivers it can shade (`raster/region.wesl`): the convex hull of three boxes, each of a
//! corner and of its shadows from the whole light on the farthest receivers, enlarged by half a texel, so that plain rasterisation is
//! conservative. The paper's own regions are options: six vertices for a single light point (`raster/six_vertices.wesl`), otherwise the
//! hull of hexagons about an ellipsoid's shadows (`raster/hulls.wesl`). Neither misses a bit.
//!
//! - The map is one window fitted to the receivers, or the six of a cube if receivers surround the light. A triangle beside
//!   the light is drawn over the whole window.
//! - WebGPU's fragments have no bitwise blending, so atomics clear bits. Long lists are split, one instance per part.
//! - Groups evaluate tinted casters, because no atomic multiplies their transmittances.
//! - The regions of silhouettes are drawn first, into a word per texel (`raster/silhouettes.wesl`): elsewhere one light point
//!   represents all. A triangle's plane clips its region at the start of a fragment (`raster/supporting_plane.wesl`).
//! - Lists may store positions, and a depth test in place of the paper's stencil may discard fragments over empty lists
//!   (`raster/stencil.wesl`).
//! - A pass before the first batch opens the light points in front of each receiver's own surface, and one after the last sums
//!   the weights of those that are still open (`raster/open_points.wesl`, `raster/sum_visible.wesl`).
//!
//! The bits equal those of the groups, except with planes computed once per triangle (`light_bits/planes.wesl`): they round differently.
//!
//! # Departures from the paper
//! *Section 4.3.* Groups contain listed receivers alone, so empty lists cost nothing. Its other four savings are switches, and change no
//! bit: `cull_facing`, `cut_by_plane`, `stop_when_occluded`, `penumbra_only`. The last is on in `sample_based:paper` alone: no built-in
//! scene that was tried is faster with it.

use std::collections::HashMap;

use antumbra_light::{Light, LightShape};

use crate::contract::param_choice;
use crate::gpu::{Gpu, Stage, white_texture};
use crate::primitives::prefix_scan::PrefixScan;
use crate::receivers::inputs::{FrameInputs, PreparedInputs};

pub mod alias_free;
mod batches;
mod buffers;
mod caster_groups;
mod drawn_lists;
mod evaluation;
pub(crate) mod gpu_types;
mod groups;
mod irradiance;
mod light_points;
mod lookup_table;
mod pipelines;
mod plan;
mod prepare;
mod raster;
mod record;
mod region;
pub mod sample_based;
mod settings;
mod subset;
#[cfg(test)]
mod tests;
mod windows;

use batches::{Batch, Surfaces};
use buffers::Buffers;
use caster_groups::RunGroup;
use drawn_lists::ListWindows;
use evaluation::Evaluation;
use gpu_types::SampleSettings;
use groups::{Layouts, TABLE_FORMAT};
use irradiance::{Irradiance, PreparedIrradiance};
pub(crate) use light_points::{LocalPoint, local_points};
use lookup_table::Table;
use pipelines::{Evaluator, Pipelines};
use raster::Raster;
pub(crate) use raster::RasterOptions;
pub(crate) use region::Region;
pub(crate) use settings::{CULL_FACING, CUT_BY_PLANE, PENUMBRA_ONLY, STOP_WHEN_OCCLUDED};
use subset::{PreparedSubset, Subset};

param_choice! {
    /// Method by which triangles find the receivers that they may shadow.
    pub enum Traversal {
        /// Groups of 64 neighbouring receivers walk the triangles between them and the light.
        Groups = "groups",
        /// Triangles are drawn over the light's map, and fragments walk the lists of its texels, as published.
        Raster = "raster",
        /// Raster if one window holds the receivers and few of them share a texel, otherwise groups. The device chooses in
        /// each frame.
        Chosen = "chosen",
    }
}

/// Options of a frame.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// The light's points.
    pub(crate) points: Vec<LocalPoint>,
    /// Width of a map with as many texels as there are lists; rounded up to a power of two.
    pub(crate) map_size: u32,
    /// Method by which triangles find receivers.
    pub(crate) traversal: Traversal,
    /// Options of drawn triangles.
    pub(crate) drawn: RasterOptions,
    /// Switches of section 4.3.
    pub(crate) switches: u32,
    /// Width of the lookup table; 0 tests each light point.
    pub(crate) lookup_size: u32,
    /// Number of rotations about the light's axis that leave it unchanged, 1 for any; 0: pixels are not rotated.
    pub(crate) rotations: u32,
    /// Offset of every pixel's rotation, as a fraction of a whole turn.
    pub(crate) turn: f32,
    /// Scale of the ray offset at open meshes.
    pub(crate) ray_offset_scale: f32,
    /// Whether every pixel's bits are kept.
    pub(crate) keep_bits: bool,
    /// Whether tests are counted.
    pub(crate) counts: bool,
    /// Whether only every other pixel in both directions is listed, and the rest interpolated.
    pub(crate) is_sparse: bool,
    /// Whether light points are weighted by the irradiance that they give each receiver; every pixel's bits are then kept.
    pub(crate) weighs_irradiance: bool,
}

/// Passes, and their retained state.
#[derive(Debug)]
pub(crate) struct ViewSamples {
    technique: &'static str,
    inputs: FrameInputs,
    layouts: Layouts,
    pipelines: Pipelines,
    /// Pipelines, created when a frame first needs them.
    evaluators: HashMap<Evaluator, wgpu::ComputePipeline>,
    /// Created when a frame first needs it.
    raster: Option<Raster>,
    list_scan: PrefixScan,
    cell_scan: PrefixScan,
    buffers: Buffers,
    no_texture: (wgpu::TextureView, wgpu::Sampler),
    table: Option<Table>,
    no_table: wgpu::TextureView,
    /// Created when a frame first needs it.
    irradiance: Option<Irradiance>,
    /// Created when a frame first needs it.
    subset: Option<Subset>,
    /// Lists of the frame prepared last.
    windows: Option<ListWindows>,
}

/// Passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedSamples {
    inputs: PreparedInputs,
    dispatches: wgpu::Buffer,
    clears: Clears,
    lists: wgpu::BindGroup,
    stores_positions: bool,
    chooses: bool,
    /// Runs of closed meshes; empty unless silhouettes are needed.
    edge_runs: Vec<RunGroup>,
    edges: wgpu::BindGroup,
    passes: wgpu::BindGroup,
    batches: Vec<PreparedBatch>,
    irradiance: Option<PreparedIrradiance>,
    subset: Option<PreparedSubset>,
}

#[derive(Debug)]
struct Clears {
    state: wgpu::BindGroup,
    counts: wgpu::BindGroup,
    cells: wgpu::BindGroup,
    edges: wgpu::BindGroup,
    penumbrae: wgpu::BindGroup,
    work: wgpu::BindGroup,
}

#[derive(Debug)]
struct PreparedBatch {
    casters: wgpu::BindGroup,
    arguments: wgpu::BindGroup,
    boxes: wgpu::BindGroup,
    surface: wgpu::BindGroup,
    runs: Vec<RunGroup>,
    clusters: u32,
    /// One evaluation per batch of light points.
    evaluate: Vec<Evaluation>,
}

impl ViewSamples {
    pub(crate) fn new(gpu: &Gpu, technique: &'static str) -> Self {
        let inputs = FrameInputs::new(gpu);
        let layouts = Layouts::new(gpu);
        let pipelines = Pipelines::new(gpu, &inputs, &layouts);
        let no_table = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra no table"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: TABLE_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        Self {
            technique,
            layouts,
            pipelines,
            evaluators: HashMap::new(),
            raster: None,
            inputs,
            list_scan: PrefixScan::new(gpu),
            cell_scan: PrefixScan::new(gpu),
            buffers: Buffers::default(),
            no_texture: (white_texture(gpu), gpu.device.create_sampler(&wgpu::SamplerDescriptor::default())),
            table: None,
            no_table: gpu.device.create_view(&no_table, &wgpu::TextureViewDescriptor::default()),
            irradiance: None,
            subset: None,
            windows: None,
        }
    }

    /// Bind group 0 of every pass over the receivers.
    pub(crate) fn inputs(&self) -> &FrameInputs {
        &self.inputs
    }

    /// Bits of every pixel, if they are kept: the words of pixel after pixel, row after row.
    pub(crate) fn bits(&self) -> Option<&wgpu::Buffer> {
        self.buffers.bits.as_ref()
    }

    /// Counters, from the buffer's third word on; see `work.wesl`.
    pub(crate) fn counters(&self) -> Option<&wgpu::Buffer> {
        self.buffers.work.as_ref()
    }

    /// Size of lists, triangles, bits and table, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.buffers.bytes()
            + self.list_scan.memory_bytes()
            + self.cell_scan.memory_bytes()
            + self.table.as_ref().map_or(0, |table| table.bytes)
            + self.raster.as_ref().map_or(0, Raster::memory_bytes)
            + self.irradiance.as_ref().map_or(0, Irradiance::memory_bytes)
    }
}

impl PreparedSamples {
    /// Bind group 0 of every pass over the receivers.
    pub(crate) fn inputs(&self) -> &PreparedInputs {
        &self.inputs
    }
}

/// Returns the number of vectors of a triangle in its list: corners, and texture coordinates if the surface has holes or tint.
fn stride_of(batch: &Batch) -> u32 {
    if batch.surfaces == Surfaces::Opaque { 3 } else { 5 }
}

fn settings_uniform(stage: &Stage<'_>, settings: &SampleSettings) -> wgpu::Buffer {
    stage.uniform("view-sample settings", settings)
}

/// Whether the light's points differ in weight.
fn is_weighted(light: &Light) -> bool {
    light.emission.is_some() && matches!(light.shape, LightShape::Rectangle { .. })
}
