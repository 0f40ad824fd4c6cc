//! What `alias_free` and `sample_based` share: view-samples in lists by where they lie as seen from the light, triangles
//! sorted by place, and one bit for each view-sample and light point.
//!
//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, "Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps",
//! EGSR 2008. The paper rasterises each triangle's region of influence and lets its fragments walk the lists: that is
//! `traversal=raster`, `alias_free`'s default. `sample_based`, whose regions are as wide as penumbrae, exchanges the loops:
//! sixty-four view-samples that lie together in the lists take a workgroup, whose *shaft* (the hull of their box and the
//! light's) takes the part of the regions of influence. Triangles are sorted into a grid by a count, a scan and a scatter,
//! in clusters of 64 and clusters of clusters, with boxes that the shaft culls. So lists may be of any length, triangles
//! may be as many as there are, nothing is stored per pair of the two, and a bit never leaves its thread.
//!
//! Two things keep the tests few. The lists take direction *and distance* from the light, so that a group holds neighbours
//! in space: with the paper's texels a group on `knot` holds the lit tube and the floor in its shadow, and meets five times
//! as many triangles. And each view-sample first carries a triangle's corners on to the light (`shadow_window.wesl`): where
//! that box touches few cells of a grid over the light points, only the points in these are tested. On `knot` with 100 000
//! triangles and 256 light points at 320 × 180, view-samples held against triangles fell from 250 to 53 million and light
//! points from 751 to 33 million. Before that, planes tell whether the triangle lies beside the cone from the view-sample
//! to the light, which holds for corners behind it too: among the carvings of Sponza, at 160 × 90, that leaves 0.02 of 25
//! million pairs, where the box alone left 21.
//!
//! # The paper's way
//! Every triangle is drawn over the texels whose receivers it can shade (sections 3.2 and 4.1, `region.wesl`): the convex
//! hull of three boxes, each of a corner and of its shadows from the whole light on the farthest receivers, half a texel
//! wider, so that plain rasterisation is conservative. The map is one window towards the receivers, fitted to them, or the
//! six of a cube where they lie around the light; what comes beside the light is drawn over the whole window. WebGPU's
//! fragments have no bitwise blending, so bits are cleared by atomics. Long lists are walked in parts, an instance each.
//! Tinted casters, whose transmittances no atomics multiply, are left to the groups, and `penumbra_only` and `cut_by_plane`
//! have no say. The bits are those of the groups, tested for every shape of light. On llvmpipe at 320 × 180 it takes
//! .8 to .4 of the groups' time for one light point and 1.8 to 10 times theirs for 256 (`columns`, `hairball`, `knot` with
//! 100 000 triangles, Sponza).
//!
//! # Where this departs from the paper
//! *Section 4.3.* Empty lists cost nothing here: groups are made of listed view-samples alone. The other four are switches,
//! and change no bit. Measured by tests at 64 × 36 with 256 light points on `columns` and `knot` with 20 000 triangles:
//! without `cull_facing` 1.5 and 1.7 times as many triangles are held against groups, and 1 % more of all tests are made;
//! without `cut_by_plane`, up to 1 % more; without `stop_when_occluded`, as many; without `penumbra_only` 22 % and 2 %
//! *fewer* triangles are held against groups, since no group there is far from every silhouette.
//!
//! ```text
//! depth ──► bounds ──► count ──► scan ──► scatter ──► lists ─────┐
//!              └► hull of all that is asked ─┐                   ▼
//! meshes ──► cull ──► count ──► scan ──► scatter ──► boxes ──► evaluate ──► mask
//!                                           └─► or drawn over the windows ──┘
//! ```

use std::collections::HashMap;

use antumbra_light::{Aabb, Light, LightShape};
use glam::Vec3;

use crate::blocks::frame_inputs::FrameInputs;
use crate::blocks::prefix_scan::PrefixScan;
use crate::contract::{Error, Frame, TechniqueKind, param_choice};
use crate::gpu::{Gpu, Recorder, Span, bind_group, create_uniform, sized_buffer, upload_storage, write_uniform};

mod batches;
mod caster_groups;
pub(crate) mod gpu_types;
mod light_points;
mod lookup_table;
mod pipelines;
mod raster;
mod settings;
#[cfg(test)]
mod tests;
mod windows;

use batches::{BATCH_TRIANGLES, Batch, Run, Surfaces, batches_of};
use caster_groups::{RunGroup, over_runs, readable_meshes, run_group, surface_group};
use gpu_types::SampleSettings;
pub(crate) use light_points::{LocalPoint, local_points};
use light_points::{MAX_WORDS, MOST_SINGLED_OUT, WORD, cells_across, first_in_cells, most_cells, packed, world_box};
use lookup_table::Table;
use pipelines::{Evaluator, Layouts, Pipelines};
use raster::{Draw, Raster};
use settings::{
    CELL_COUNT, FIRST_GROUP, FIRST_POINTS, FIRST_TRIANGLES, KEEP_BITS, LAST_TRIANGLES, NO_TRIANGLES, PROJECT_PARALLEL,
    PROJECT_SPHERE, SHAFT_LENGTH, STATE_LENGTH,
};
pub(crate) use settings::{CULL_FACING, CUT_BY_PLANE, PENUMBRA_ONLY, STOP_WHEN_OCCLUDED};
use windows::Windows;

param_choice! {
    /// How triangles find the receivers that they may hide the light from.
    pub enum Traversal {
        /// Sixty-four receivers that lie together walk the triangles between them and the light.
        Groups = "groups",
        /// Triangles are drawn over the light's map, and fragments walk the lists of its texels: the paper's way.
        Raster = "raster",
    }
}

/// The bits of all pixels take at most this; more light points are taken in turn.
const BITS_BUDGET_BYTES: u64 = 120 << 20;

/// Words of light points that are tested together where casters have holes or tint: each bit costs a look at a texture,
/// and no pass may run long.
const TEXTURED_WORDS: usize = 8;

/// Turns of loops in a pass. No pass runs long, whatever the scene; and llvmpipe ends every loop of an invocation after
/// 65 535 turns of all of them.
const MOST_TURNS: u32 = 60_000;

/// Triangles that are tested together, at most; as in `evaluate.wesl`.
const MOST_WAITING: u32 = 128;

/// Rows of cells that a shadow touches whose light points are tested one by one; as in `evaluate.wesl`.
const MOST_ROWS: u32 = 4;

/// What a frame asks for.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// The light's points.
    pub(crate) points: Vec<LocalPoint>,
    /// Texels along a side of a map with as many texels as there are lists; a power of two, or taken up to one.
    pub(crate) map_size: u32,
    /// How triangles find receivers.
    pub(crate) traversal: Traversal,
    /// The switches of section 4.3.
    pub(crate) switches: u32,
    /// Side of the lookup table; 0 tests each light point.
    pub(crate) lookup_size: u32,
    /// Turns about the light's axis that leave it the same, 1 for any; 0: pixels are not turned.
    pub(crate) rotations: u32,
    /// Added to every pixel's turn, as a part of a whole one.
    pub(crate) turn: f32,
    /// Scale of the hair at open meshes.
    pub(crate) hair_scale: f32,
    /// Keeps every pixel's bits.
    pub(crate) keep_bits: bool,
    /// Counts tests.
    pub(crate) counts: bool,
}

/// The passes, and what they keep.
#[derive(Debug)]
pub(crate) struct ViewSamples {
    kind: TechniqueKind,
    inputs: FrameInputs,
    layouts: Layouts,
    pipelines: Pipelines,
    /// Made when a frame first needs them.
    evaluators: HashMap<Evaluator, wgpu::ComputePipeline>,
    /// Made when a frame first needs it.
    raster: Option<Raster>,
    list_scan: PrefixScan,
    cell_scan: PrefixScan,
    buffers: Buffers,
    no_texture: (wgpu::TextureView, wgpu::Sampler),
    table: Option<Table>,
    no_table: wgpu::TextureView,
    frame: Option<Prepared>,
}

/// Buffers that outlive a frame; each is made anew where a frame needs another size.
#[derive(Debug, Default)]
struct Buffers {
    state: Option<wgpu::Buffer>,
    counts: Option<wgpu::Buffer>,
    places: Option<wgpu::Buffer>,
    list: Option<wgpu::Buffer>,
    shaft: Option<wgpu::Buffer>,
    whole_light: Option<wgpu::Buffer>,
    cells: Option<wgpu::Buffer>,
    triangle_places: Option<wgpu::Buffer>,
    triangles: Option<wgpu::Buffer>,
    edges: Option<wgpu::Buffer>,
    boxes: Option<wgpu::Buffer>,
    totals: Option<wgpu::Buffer>,
    dispatches: Option<wgpu::Buffer>,
    work: Option<wgpu::Buffer>,
    bits: Option<wgpu::Buffer>,
}

/// The bind groups of a frame.
#[derive(Debug)]
struct Prepared {
    clears: Clears,
    lists: wgpu::BindGroup,
    /// Where any mesh is closed: the group of every run of one.
    edge_runs: Vec<RunGroup>,
    edges: wgpu::BindGroup,
    passes: wgpu::BindGroup,
    batches: Vec<PreparedBatch>,
}

#[derive(Debug)]
struct Clears {
    state: wgpu::BindGroup,
    counts: wgpu::BindGroup,
    cells: wgpu::BindGroup,
    edges: wgpu::BindGroup,
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
    /// One for each batch of light points.
    evaluate: Vec<Evaluation>,
}

#[derive(Debug)]
enum Evaluation {
    Groups(OverGroups),
    Raster {
        /// Before the first batch: the light points in front of each receiver's own surface.
        before: Option<OverGroups>,
        draw: Draw,
        /// After the last batch: what the bits that are left weigh.
        after: Option<OverGroups>,
    },
}

/// Passes over the groups of receivers.
#[derive(Debug)]
struct OverGroups {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// After so many every group is done, whatever the scene; those after the last that has work find none.
    passes: u32,
}

impl ViewSamples {
    pub(crate) fn new(gpu: &Gpu, kind: TechniqueKind) -> Self {
        let inputs = FrameInputs::new(gpu);
        let layouts = Layouts::new(gpu);
        let pipelines = Pipelines::new(gpu, &inputs, &layouts);
        let texture = |label, format, dimension, usage| {
            gpu.device().create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | usage,
                view_formats: &[],
            })
        };
        let white = texture(
            "antumbra white",
            wgpu::TextureFormat::Rgba8Unorm,
            wgpu::TextureDimension::D2,
            wgpu::TextureUsages::COPY_DST,
        );
        gpu.queue.write_texture(
            white.as_image_copy(),
            &[255; 4],
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None },
            wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        );
        let no_table = texture(
            "antumbra no table",
            wgpu::TextureFormat::Rgba32Uint,
            wgpu::TextureDimension::D3,
            wgpu::TextureUsages::empty(),
        );
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self {
            kind,
            layouts,
            pipelines,
            evaluators: HashMap::new(),
            raster: None,
            inputs,
            list_scan: PrefixScan::new(gpu),
            cell_scan: PrefixScan::new(gpu),
            buffers: Buffers::default(),
            no_texture: (view(&white), gpu.device.create_sampler(&wgpu::SamplerDescriptor::default())),
            table: None,
            no_table: view(&no_table),
            frame: None,
        }
    }

    /// Allocates and uploads all that a frame needs.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, options: &Options) -> Result<(), Error> {
        let technique = self.kind.name();
        let meshes = readable_meshes(technique, frame)?;
        self.inputs.prepare(gpu, technique, frame)?;
        let pixels = u64::from(frame.receivers.size_px.x) * u64::from(frame.receivers.size_px.y);
        let binding_limit = gpu.device.limits().max_storage_buffer_binding_size;
        if pixels * 8 > binding_limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("{} bytes for a list of {pixels} receivers", pixels * 8),
                had: format!("{binding_limit} bytes a binding"),
                remedy: "render the mask in parts",
            });
        }

        // Light points in batches of which a thread holds the bits, and a buffer those of all pixels where they must
        // outlast a batch of triangles.
        let batches = batches_of(meshes, BATCH_TRIANGLES);
        let is_textured = batches.iter().any(|batch| batch.surfaces != Surfaces::Opaque);
        let stored_words = (BITS_BUDGET_BYTES / (4 * pixels)).max(1) as usize;
        let words = stored_words.min(if is_textured { TEXTURED_WORDS } else { MAX_WORDS });
        let point_batches: Vec<&[LocalPoint]> = options.points.chunks(words * WORD).collect();
        let pixel_words =
            options.points.len().div_ceil(WORD).min(if options.keep_bits { usize::MAX } else { words }) as u32;
        if options.keep_bits && pixels * u64::from(pixel_words) * 4 > binding_limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("{} bytes for the bits of every pixel", pixels * u64::from(pixel_words) * 4),
                had: format!("{binding_limit} bytes a binding"),
                remedy: "use fewer light points or a smaller mask, or set `keep_bits` to false",
            });
        }
        if options.lookup_size > 0 {
            Table::prepare(&mut self.table, gpu, technique, options, &point_batches)?;
        } else {
            self.table = None;
        }

        let is_turned = options.rotations > 0;
        let windows = (options.traversal == Traversal::Raster)
            .then(|| Windows::towards(&frame.receivers, frame.light, &options.points, is_turned));
        let window_side = options.map_size.next_power_of_two();
        let list_bits = 2 * window_side.ilog2();
        let list_count = windows.map_or(1, |windows| windows.count) << list_bits;
        let most_triangles = batches.iter().map(Batch::triangles).max().unwrap_or(0).max(1);
        let most_stride = batches.iter().map(stride_of).max().unwrap_or(3);
        let most_clusters = most_triangles.div_ceil(64);
        let most_supers = most_clusters.div_ceil(32);
        let closed_triangles: u32 = batches
            .iter()
            .flat_map(|batch| &batch.runs)
            .filter(|run| run.flags & settings::FLAG_CLOSED != 0)
            .map(Run::triangles)
            .sum();
        // Three edges for two triangles; twice as many slots as edges keep most apart.
        let edge_slots = (3 * closed_triangles.min(1 << 23)).next_power_of_two().max(64);

        let layouts = &self.layouts;
        let buffers = &mut self.buffers;
        let storage = wgpu::BufferUsages::STORAGE;
        let state = sized_buffer(gpu, &mut buffers.state, "view-sample state", STATE_LENGTH * 4, storage);
        let counts =
            sized_buffer(gpu, &mut buffers.counts, "view-sample counts", u64::from(list_count + 1) * 4, storage);
        let places = sized_buffer(gpu, &mut buffers.places, "view-sample places", pixels * 8, storage);
        let list = sized_buffer(gpu, &mut buffers.list, "view-sample lists", pixels * 4, storage);
        let shaft = sized_buffer(
            gpu,
            &mut buffers.shaft,
            "view-sample shaft",
            SHAFT_LENGTH * 16,
            storage | wgpu::BufferUsages::UNIFORM,
        );
        let cells = sized_buffer(gpu, &mut buffers.cells, "triangle cells", u64::from(CELL_COUNT + 1) * 4, storage);
        let triangle_places =
            sized_buffer(gpu, &mut buffers.triangle_places, "triangle places", u64::from(most_triangles) * 8, storage);
        let triangles = sized_buffer(
            gpu,
            &mut buffers.triangles,
            "triangles",
            u64::from(most_triangles) * u64::from(most_stride) * 16,
            storage,
        );
        let edges = sized_buffer(gpu, &mut buffers.edges, "edge faces", u64::from(edge_slots) * 4, storage);
        let boxes = sized_buffer(
            gpu,
            &mut buffers.boxes,
            "cluster boxes",
            u64::from(most_clusters + most_supers) * 32,
            storage,
        );
        let totals = sized_buffer(gpu, &mut buffers.totals, "view-sample totals", 16, storage);
        let dispatches = sized_buffer(
            gpu,
            &mut buffers.dispatches,
            "view-sample dispatches",
            16,
            storage | wgpu::BufferUsages::INDIRECT,
        );
        let most_groups = pixels.div_ceil(64) as u32;
        let work = sized_buffer(
            gpu,
            &mut buffers.work,
            "view-sample work",
            u64::from(FIRST_GROUP + 4 * most_groups) * 4,
            storage | wgpu::BufferUsages::COPY_SRC,
        );
        let is_tinted = batches.iter().any(|batch| matches!(batch.surfaces, Surfaces::Tinted(_)));
        let first_passed = if is_tinted { pixels as u32 * pixel_words } else { 0 };
        let bits_bytes = pixels * u64::from(pixel_words + if is_tinted { 3 } else { 0 }) * 4;
        let bits = sized_buffer(
            gpu,
            &mut buffers.bits,
            "view-sample bits",
            bits_bytes,
            storage | wgpu::BufferUsages::COPY_SRC,
        );
        self.list_scan.prepare(gpu, counts, list_count + 1);
        self.cell_scan.prepare(gpu, cells, CELL_COUNT + 1);

        let light = frame.light;
        let whole = world_box(light, &options.points, is_turned);
        let casters_box = meshes.iter().fold(Aabb::EMPTY, |all, mesh| all.union(mesh.bounds));
        let casters_box = if casters_box.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } } else { casters_box };
        let base = SampleSettings {
            light_min: whole.min,
            point_count: options.points.len() as u32,
            light_max: whole.max,
            word_count: 0,
            casters_min: casters_box.min,
            list_bits,
            casters_max: casters_box.max,
            projection: if light.is_distant() { PROJECT_PARALLEL } else { PROJECT_SPHERE },
            total_weight: options.points.iter().map(|point| point.weight).sum::<f32>().max(f32::MIN_POSITIVE),
            switches: options.switches,
            cell_count: CELL_COUNT,
            list_count,
            super_first: most_clusters,
            is_weighted: is_weighted(light).into(),
            triangle_stride: 3,
            lookup_size: options.lookup_size,
            pixel_words,
            first_passed,
            rotations: options.rotations,
            turn: options.turn,
            hair_scale: options.hair_scale,
            most_groups,
            window_side,
            ..SampleSettings::default()
        };
        let base = windows.map_or(base, |windows| {
            let [window_right, window_up, window_axis] = windows.axes;
            SampleSettings {
                window_count: windows.count,
                window_right,
                window_up,
                window_axis,
                window_light_min: windows.light.min,
                window_light_max: windows.light.max,
                ..base
            }
        });
        let uniform = |value: &SampleSettings| {
            let buffer = create_uniform::<SampleSettings>(gpu, "view-sample settings");
            write_uniform(gpu, &buffer, value);
            buffer
        };
        let base_uniform = uniform(&base);
        let whole_light =
            upload_storage(gpu, &mut buffers.whole_light, "view-sample light", &packed(&options.points)[..2]);

        let clear =
            |buffer: &wgpu::Buffer| group(gpu, "view-sample clear", &self.layouts.clear, &[buffer.as_entire_binding()]);
        let clears = Clears {
            state: clear(state),
            counts: clear(counts),
            cells: clear(cells),
            edges: clear(edges),
            work: clear(work),
        };
        let lists = group(
            gpu,
            "view-sample lists",
            &self.layouts.lists,
            &[&base_uniform, state, counts, places, list, shaft, whole_light].map(wgpu::Buffer::as_entire_binding),
        );
        let caster_group = |settings: &wgpu::Buffer| {
            group(
                gpu,
                "view-sample casters",
                &self.layouts.casters,
                &[settings, shaft, cells, triangle_places, triangles, edges].map(wgpu::Buffer::as_entire_binding),
            )
        };
        let run_group = |run: &Run| run_group(gpu, layouts, &meshes[run.caster], run);

        for batch in &batches {
            let evaluator = Evaluator::of(batch.surfaces, options);
            self.evaluators.entry(evaluator).or_insert_with(|| evaluator.pipeline(gpu, &self.inputs, layouts));
        }
        let evaluators = &self.evaluators;
        if windows.is_none() {
            self.raster = None;
        }
        let mut raster = windows.map(|_| self.raster.take().unwrap_or_else(|| Raster::new(gpu)));
        let draw_arguments = raster.as_mut().map(|raster| raster.prepare(gpu, window_side).clone());
        let light_batches: Vec<wgpu::Buffer> = point_batches
            .iter()
            .map(|points| {
                let mut buffer = None;
                upload_storage(gpu, &mut buffer, "view-sample light points", &packed(points));
                buffer.expect("just uploaded")
            })
            .collect();
        let table = self.table.as_ref().map_or(&self.no_table, |table| &table.view);
        let opaque_batches = batches.iter().filter(|batch| !matches!(batch.surfaces, Surfaces::Tinted(_))).count();
        let is_drawn = |batch: &Batch| windows.is_some() && !matches!(batch.surfaces, Surfaces::Tinted(_));
        let prepared_batches = batches
            .iter()
            .enumerate()
            .map(|(i, batch)| {
                let stride = stride_of(batch);
                let settings = uniform(&SampleSettings { triangle_stride: stride, ..base });
                let evaluate = point_batches
                    .iter()
                    .zip(&light_batches)
                    .enumerate()
                    .map(|(k, (points, light_points))| {
                        let mut switches = options.switches;
                        let mut switch = |bit, on: bool| switches |= if on { bit } else { 0 };
                        switch(FIRST_TRIANGLES, i == 0);
                        switch(LAST_TRIANGLES, i + 1 == opaque_batches);
                        switch(FIRST_POINTS, k == 0);
                        switch(KEEP_BITS, batches.len() > 1 || options.keep_bits);
                        let word_count = points.len().div_ceil(WORD) as u32;
                        let most_cells = most_cells(points);
                        let turns_per_triangle = turns_per_triangle(batch, word_count, most_cells);
                        let most_turns = MOST_TURNS - MOST_WAITING * turns_per_triangle - 4 * MAX_WORDS as u32 * 10;
                        // A turn a receiver, its words twice, are any open and which are hidden, and the ends of these loops.
                        let turns_per_receiver = 3 + word_count * (1 + turns_per_word(batch));
                        let step = SampleSettings {
                            triangle_stride: stride,
                            turns_per_triangle,
                            most_turns,
                            point_count: points.len() as u32,
                            word_count,
                            first_in_cells: first_in_cells(word_count),
                            cells_across: cells_across(points),
                            most_cells,
                            first_word: if options.keep_bits { (k * words) as u32 } else { 0 },
                            switches,
                            receivers_per_instance: MOST_TURNS / turns_per_receiver,
                            ..base
                        };
                        let over_groups = |settings: &SampleSettings, evaluator: Evaluator, passes: u32| {
                            let step = uniform(settings);
                            let mut entries = [&step, list, triangles, boxes, light_points, bits, totals]
                                .map(wgpu::Buffer::as_entire_binding)
                                .to_vec();
                            entries.push(wgpu::BindingResource::TextureView(table));
                            entries.push(work.as_entire_binding());
                            OverGroups {
                                pipeline: evaluators[&evaluator].clone(),
                                group: group(gpu, "view-sample evaluate", &layouts.evaluate, &entries),
                                passes,
                            }
                        };
                        let evaluator = Evaluator::of(batch.surfaces, options);
                        let drawn = raster.as_mut().zip(draw_arguments.as_ref()).zip(windows);
                        let Some(((raster, draw_arguments), windows)) = drawn.filter(|_| is_drawn(batch)) else {
                            let turns = u64::from(batch.triangles()) * u64::from(turns_per_triangle)
                                + u64::from(batch.triangles().div_ceil(64)) * u64::from(48 + 2 * word_count);
                            let passes = turns.div_ceil(u64::from(most_turns)).max(1) as u32;
                            return Evaluation::Groups(over_groups(&step, evaluator, passes));
                        };
                        // The first batch is opaque: its pipeline is there.
                        let plain = Evaluator::of(Surfaces::Opaque, options);
                        let ends = FIRST_TRIANGLES | LAST_TRIANGLES | KEEP_BITS | PENUMBRA_ONLY;
                        let without_triangles = |switches| {
                            let switches = step.switches & !ends | NO_TRIANGLES | switches;
                            over_groups(&SampleSettings { switches, ..step }, plain, 1)
                        };
                        let window_group = |window| {
                            let step = uniform(&SampleSettings { window, ..step });
                            let mut entries = [&step, list, triangles, state, light_points, bits, counts]
                                .map(wgpu::Buffer::as_entire_binding)
                                .to_vec();
                            entries.push(wgpu::BindingResource::TextureView(table));
                            entries.extend([work, totals].map(wgpu::Buffer::as_entire_binding));
                            group(gpu, "view-sample raster", &raster.layout, &entries)
                        };
                        let arguments = [&uniform(&step), state, totals, draw_arguments];
                        Evaluation::Raster {
                            before: (i == 0).then(|| without_triangles(FIRST_TRIANGLES | KEEP_BITS)),
                            after: (i + 1 == opaque_batches).then(|| without_triangles(LAST_TRIANGLES)),
                            draw: Draw {
                                windows: (0..windows.count).map(window_group).collect(),
                                arguments: group(
                                    gpu,
                                    "view-sample raster arguments",
                                    &raster.arguments_layout,
                                    &arguments.map(wgpu::Buffer::as_entire_binding),
                                ),
                                pipeline: raster.pipeline(gpu, &self.inputs, layouts, evaluator),
                            },
                        }
                    })
                    .collect();
                PreparedBatch {
                    casters: caster_group(&settings),
                    arguments: group(
                        gpu,
                        "view-sample arguments",
                        &self.layouts.arguments,
                        &[&settings, counts, cells, totals].map(wgpu::Buffer::as_entire_binding),
                    ),
                    boxes: group(
                        gpu,
                        "view-sample boxes",
                        &self.layouts.boxes,
                        &[&settings, totals, triangles, boxes].map(wgpu::Buffer::as_entire_binding),
                    ),
                    surface: surface_group(gpu, layouts, &self.no_texture, meshes, batch.surfaces),
                    runs: batch.runs.iter().map(run_group).collect(),
                    // Regions of influence look for no boxes.
                    clusters: if is_drawn(batch) { 0 } else { batch.triangles().div_ceil(64) },
                    evaluate,
                }
            })
            .collect();
        self.raster = raster;
        let closed = batches.iter().flat_map(|batch| &batch.runs).filter(|run| run.flags & settings::FLAG_CLOSED != 0);
        let edge_runs = closed.map(run_group).collect();
        if let Some(table) = &mut self.table
            && table.bind_group.is_none()
            && table.groups != [0; 3]
        {
            let entries = [
                base_uniform.as_entire_binding(),
                light_batches[0].as_entire_binding(),
                wgpu::BindingResource::TextureView(&table.view),
            ];
            table.bind_group = Some(group(gpu, "view-sample table", &self.layouts.make_lookup, &entries));
        }
        let passes = group(
            gpu,
            "view-sample passes",
            &self.layouts.passes,
            &[totals, dispatches, work].map(wgpu::Buffer::as_entire_binding),
        );
        self.frame = Some(Prepared {
            clears,
            lists,
            passes,
            edge_runs,
            edges: caster_group(&base_uniform),
            batches: prepared_batches,
        });
        Ok(())
    }

    /// Records every pass of the frame that [`Self::prepare`] saw last.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let frame = self.frame.as_ref().expect("prepare comes before record");
        let pipelines = &self.pipelines;
        if let Some(table) = &self.table
            && let Some(group) = &table.bind_group
        {
            recorder.compute("lookup table", Span::Only, |pass| {
                pass.set_pipeline(&pipelines.make_lookup);
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(table.groups[0], table.groups[1], table.groups[2]);
            });
        }
        let over_pixels = |pass: &mut wgpu::ComputePass<'_>, pipeline: &wgpu::ComputePipeline| {
            pass.set_pipeline(pipeline);
            self.inputs.bind(pass);
            pass.set_bind_group(1, &frame.lists, &[]);
            self.inputs.dispatch(pass);
        };
        recorder.compute("view-sample lists", Span::Only, |pass| {
            clear(pass, pipelines, &frame.clears.state);
            clear(pass, pipelines, &frame.clears.counts);
            clear(pass, pipelines, &frame.clears.work);
            over_pixels(pass, &pipelines.bounds);
            over_pixels(pass, &pipelines.count);
        });
        self.list_scan.record(recorder, "view-sample lists");
        recorder.compute("view-sample lists", Span::Only, |pass| over_pixels(pass, &pipelines.scatter));

        if !frame.edge_runs.is_empty() {
            recorder.compute("silhouettes", Span::Only, |pass| {
                clear(pass, pipelines, &frame.clears.edges);
                pass.set_bind_group(0, &frame.edges, &[]);
                over_runs(pass, &pipelines.edge_faces, &frame.edge_runs);
            });
        }
        let steps = frame.batches[0].evaluate.len();
        for step in 0..steps {
            for batch in &frame.batches {
                // One batch stays sorted.
                if step == 0 || frame.batches.len() > 1 {
                    self.record_sort(recorder, batch, frame);
                }
                match &batch.evaluate[step] {
                    Evaluation::Groups(over) => self.record_groups(recorder, over, &batch.surface, frame),
                    Evaluation::Raster { before, draw, after } => {
                        if let Some(over) = before {
                            self.record_groups(recorder, over, &batch.surface, frame);
                        }
                        let raster = self.raster.as_ref().expect("made by prepare");
                        raster.record(recorder, &self.inputs, &batch.surface, draw);
                        if let Some(over) = after {
                            self.record_groups(recorder, over, &batch.surface, frame);
                        }
                    }
                }
            }
        }
    }

    /// Passes over the groups of receivers until each is done.
    fn record_groups(
        &self,
        recorder: &mut Recorder<'_>,
        over: &OverGroups,
        surface: &wgpu::BindGroup,
        frame: &Prepared,
    ) {
        let dispatches = self.buffers.dispatches.as_ref().expect("made by prepare");
        recorder.compute("visibility", Span::Only, |pass| {
            for i in 0..over.passes {
                pass.set_pipeline(if i == 0 { &self.pipelines.begin } else { &self.pipelines.advance });
                pass.set_bind_group(0, &frame.passes, &[]);
                pass.dispatch_workgroups(1, 1, 1);
                pass.set_pipeline(&over.pipeline);
                self.inputs.bind(pass);
                pass.set_bind_group(1, &over.group, &[]);
                pass.set_bind_group(2, surface, &[]);
                pass.dispatch_workgroups_indirect(dispatches, 0);
            }
        });
    }

    /// Sorts a batch's triangles.
    fn record_sort(&self, recorder: &mut Recorder<'_>, batch: &PreparedBatch, frame: &Prepared) {
        let pipelines = &self.pipelines;
        recorder.compute("triangles", Span::Only, |pass| {
            clear(pass, pipelines, &frame.clears.cells);
            pass.set_bind_group(0, &batch.casters, &[]);
            over_runs(pass, &pipelines.triangle_count, &batch.runs);
        });
        self.cell_scan.record(recorder, "triangles");
        recorder.compute("triangles", Span::Only, |pass| {
            pass.set_bind_group(0, &batch.casters, &[]);
            over_runs(pass, &pipelines.triangle_scatter, &batch.runs);
            pass.set_pipeline(&pipelines.arguments);
            pass.set_bind_group(0, &batch.arguments, &[]);
            pass.dispatch_workgroups(1, 1, 1);
            if batch.clusters > 0 {
                pass.set_pipeline(&pipelines.cluster_boxes);
                pass.set_bind_group(0, &batch.boxes, &[]);
                pass.dispatch_workgroups(batch.clusters.div_ceil(64), 1, 1);
                pass.set_pipeline(&pipelines.super_boxes);
                pass.dispatch_workgroups(batch.clusters.div_ceil(64 * 32), 1, 1);
            }
        });
    }

    /// What group 0 of every pass over the receivers is; prepared with the frame.
    pub(crate) fn inputs(&self) -> &FrameInputs {
        &self.inputs
    }

    /// The bits of every pixel, where they are kept: words of pixel after pixel, row after row.
    pub(crate) fn bits(&self) -> Option<&wgpu::Buffer> {
        self.buffers.bits.as_ref()
    }

    /// What was counted, from the buffer's third word on; see `work.wesl`.
    pub(crate) fn counters(&self) -> Option<&wgpu::Buffer> {
        self.buffers.work.as_ref()
    }

    /// Bytes of lists, triangles, bits and table.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let b = &self.buffers;
        let all = [
            &b.state,
            &b.counts,
            &b.places,
            &b.list,
            &b.shaft,
            &b.whole_light,
            &b.cells,
            &b.triangle_places,
            &b.triangles,
            &b.edges,
            &b.boxes,
            &b.totals,
            &b.dispatches,
            &b.work,
            &b.bits,
        ];
        all.into_iter().flatten().map(wgpu::Buffer::size).sum::<u64>()
            + self.list_scan.memory_bytes()
            + self.cell_scan.memory_bytes()
            + self.table.as_ref().map_or(0, |table| table.bytes)
            + self.raster.as_ref().map_or(0, Raster::memory_bytes)
    }
}

/// Zeroes a buffer.
fn clear(pass: &mut wgpu::ComputePass<'_>, pipelines: &Pipelines, group: &wgpu::BindGroup) {
    pass.set_pipeline(&pipelines.clear);
    pass.set_bind_group(0, group, &[]);
    pass.dispatch_workgroups(CLEAR_GROUPS, 1, 1);
}

/// Workgroups that clear a buffer between them.
const CLEAR_GROUPS: u32 = 64;

/// Vectors of a triangle in its list: corners, and texture coordinates where the surface has holes or tint.
fn stride_of(batch: &Batch) -> u32 {
    if batch.surfaces == Surfaces::Opaque { 3 } else { 5 }
}

/// Turns of loops that a triangle takes at most: its shadow's box, then words, or rows of cells and light points in them.
fn turns_per_triangle(batch: &Batch, word_count: u32, most_cells: u32) -> u32 {
    // Two light points a turn, and those may have turns of their own.
    let singled_out = if most_cells == 0 { 0 } else { 2 * MOST_ROWS + MOST_SINGLED_OUT / 2 };
    let of_points = if batch.surfaces == Surfaces::Opaque { 0 } else { MOST_SINGLED_OUT };
    2 + (word_count * turns_per_word(batch)).max(singled_out + of_points)
}

/// Turns of loops that a word of a triangle's light points takes at most.
fn turns_per_word(batch: &Batch) -> u32 {
    match batch.surfaces {
        Surfaces::Opaque => 1,
        Surfaces::Masked(_) => 1 + WORD as u32,
        // Four light points a turn.
        Surfaces::Tinted(_) => 1 + WORD as u32 / 4,
    }
}

/// Whether the light's points differ in weight.
fn is_weighted(light: &Light) -> bool {
    light.emission.is_some() && matches!(light.shape, LightShape::Rectangle { .. })
}

/// A bind group of consecutive bindings.
fn group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    bind_group(gpu, label, layout, resources.iter().cloned())
}
