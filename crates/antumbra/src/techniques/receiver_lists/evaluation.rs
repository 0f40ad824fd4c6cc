//! Evaluation of a batch of triangles against a batch of light points: passes over groups of receivers, or triangles drawn over the
//! windows between two such passes.

use std::collections::HashMap;

use super::batches::{Batch, Surfaces};
use super::buffers::BufferSet;
use super::gpu_types::SampleSettings;
use super::groups::{DrawArguments, Evaluated, FrameGroups, RegionHulls, Window};
use super::light_points::{
    LocalPoint, MAX_SINGLED_OUT, MAX_WORDS, WORD, cells_across, max_cells, packed_cells, packed_words,
};
use super::pipelines::{Evaluator, WorkCondition};
use super::plan::FramePlan;
use super::raster::{Draw, Hulls, Raster, RasterTargets};
use super::settings::{FIRST_POINTS, FIRST_TRIANGLES, KEEP_BITS, LAST_TRIANGLES};
use super::windows::Windows;
use super::{Options, settings_uniform, stride_of};
use crate::gpu::{Bindings, Stage, shared_constants};
use crate::receivers::inputs::FrameInputs;

shared_constants! {
    /// Largest number of triangles that are tested together.
    const MAX_WAITING: u32 = 128, as in EVALUATION_EVALUATE;

    /// Largest number of rows of cells in a shadow whose light points are tested one by one.
    const MAX_ROWS: u32 = 4, as in EVALUATION_EVALUATE;
}

#[derive(Debug)]
pub(super) enum Evaluation {
    Groups(OverGroups),
    Raster {
        /// Passes that replace all others if the device chooses so.
        walked: Option<OverGroups>,
        /// Before the first batch: opens the light points in front of each receiver's own surface.
        before: Option<OverGroups>,
        draw: Box<Draw>,
        /// After the last batch: sums the weights of the remaining bits.
        after: Option<OverGroups>,
    },
}

/// Passes over the groups of receivers.
#[derive(Debug)]
pub(super) struct OverGroups {
    pub(super) condition: WorkCondition,
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) group: wgpu::BindGroup,
    /// Number of passes after which every group is done in any scene; passes without work find an empty queue.
    pub(super) passes: u32,
}

/// Batch of light points.
#[derive(Clone, Debug)]
pub(super) struct PointBatch<'a> {
    /// Index among the batches.
    pub(super) index: usize,
    pub(super) points: &'a [LocalPoint],
    /// See [`max_cells`].
    max_cells: u32,
    pub(super) words: wgpu::Buffer,
    cells: wgpu::Buffer,
}

impl<'a> PointBatch<'a> {
    /// Uploads the batch of this index.
    pub(super) fn new(stage: &Stage<'_>, index: usize, points: &'a [LocalPoint]) -> Self {
        let words = stage.uniform_array("view-sample light words", &packed_words(points));
        let cells = stage.storage("view-sample light cells", &packed_cells(points));
        Self { index, points, max_cells: max_cells(points), words, cells }
    }
}

/// Inputs that all evaluations of a frame share.
#[derive(Debug)]
pub(super) struct Evaluations<'a> {
    pub(super) groups: FrameGroups<'a>,
    pub(super) inputs: &'a FrameInputs,
    /// Pipelines for every batch of the frame.
    pub(super) evaluators: &'a HashMap<Evaluator, wgpu::ComputePipeline>,
    pub(super) plan: &'a FramePlan,
    pub(super) options: &'a Options,
    pub(super) base: &'a SampleSettings,
    pub(super) table: &'a wgpu::TextureView,
    /// Render targets; `None` if triangles are not drawn.
    pub(super) raster_targets: Option<&'a RasterTargets>,
}

/// Batch of triangles against a batch of light points.
#[derive(Clone, Copy, Debug)]
struct Step<'a> {
    batch: &'a Batch,
    light: &'a PointBatch<'a>,
    settings: SampleSettings,
}

impl Evaluations<'_> {
    /// Returns the evaluation of the plan's triangle batch `index` with a batch of light points.
    pub(super) fn of(&self, raster: Option<&mut Raster>, index: usize, light: &PointBatch<'_>) -> Evaluation {
        let plan = self.plan;
        let batch = &plan.batches[index];
        let step = Step { batch, light, settings: self.settings(index, light) };
        let drawn = raster.zip(self.raster_targets).zip(plan.windows);
        let Some(((raster, targets), windows)) = drawn.filter(|_| plan.is_drawn(batch)) else {
            return Evaluation::Groups(self.walk(WorkCondition::Either, &step));
        };
        let without_triangles = |pipeline| self.over_groups(WorkCondition::Drawn, &step, pipeline, 1);
        Evaluation::Raster {
            walked: plan.chooses().then(|| self.walk(WorkCondition::Walked, &step)),
            before: (index == 0).then(|| without_triangles(&raster.before)),
            after: (index + 1 == plan.opaque_batches()).then(|| without_triangles(&raster.after)),
            draw: Box::new(self.draw(&step, raster, targets, &windows)),
        }
    }

    /// Returns the passes in which groups of receivers walk the triangles.
    fn walk(&self, condition: WorkCondition, step: &Step<'_>) -> OverGroups {
        let Step { batch, settings, .. } = step;
        let turns = u64::from(batch.triangles()) * u64::from(settings.iterations_per_triangle)
            + u64::from(batch.triangles().div_ceil(64)) * u64::from(48 + 2 * settings.word_count);
        let passes = turns.div_ceil(u64::from(settings.max_iterations)).max(1) as u32;
        let evaluator = Evaluator::of(batch.surfaces, self.options);
        self.over_groups(condition, step, &self.evaluators[&evaluator], passes)
    }

    /// Returns the draws of the triangles over all windows.
    fn draw(&self, step: &Step<'_>, raster: &mut Raster, targets: &RasterTargets, windows: &Windows) -> Draw {
        let (plan, drawn) = (self.plan, self.options.drawn);
        let FrameGroups { stage, layouts, buffers: BufferSet { state, totals, .. } } = self.groups;
        let settings = settings_uniform(stage, &step.settings);
        let arguments = DrawArguments { settings: &settings, state, totals, draw: &targets.arguments };
        let evaluator = Evaluator::of(step.batch.surfaces, self.options);
        Draw {
            targets: targets.clone(),
            make_arguments: raster.arguments.clone(),
            windows: (0..windows.count).map(|window| self.window_group(step, &raster.layout, window)).collect(),
            arguments: arguments.group(stage, &raster.arguments_layout),
            hulls: plan.makes_hulls.then(|| self.hulls(step, raster, windows)),
            silhouettes: plan.draws_silhouettes().then(|| raster.silhouettes(stage, self.inputs)),
            stencil: drawn.stencil.then(|| raster.stencil(stage)),
            pipeline: raster.pipeline(stage, self.inputs, layouts, evaluator, drawn),
        }
    }

    /// Returns group 1 of the draws over a window.
    fn window_group(&self, step: &Step<'_>, layout: &wgpu::BindGroupLayout, window: u32) -> wgpu::BindGroup {
        let FrameGroups { stage, buffers, .. } = self.groups;
        let BufferSet { state, counts, list, positions, penumbrae, hulls, triangles, totals, work, bits, .. } = buffers;
        let window = Window {
            settings: &settings_uniform(stage, &SampleSettings { window, ..step.settings }),
            list,
            triangles,
            state,
            light_words: &step.light.words,
            bits,
            firsts: counts,
            lookup: self.table,
            work,
            totals,
            positions,
            penumbrae,
            hulls,
            snapped_texels: stage.snapped_texels(),
        };
        window.group(stage, layout)
    }

    /// Returns the computation of the triangles' hulls of hexagons.
    fn hulls(&self, step: &Step<'_>, raster: &mut Raster, windows: &Windows) -> Hulls {
        let FrameGroups { stage, buffers: BufferSet { triangles, state, totals, hulls, .. }, .. } = self.groups;
        let (layout, pipeline) = raster.hulls(stage, self.inputs);
        let ellipsoid = &stage.storage("view-sample light ellipsoid", &windows.ellipsoid);
        let group = |window| {
            let settings = &settings_uniform(stage, &SampleSettings { window, ..step.settings });
            RegionHulls { settings, triangles, state, totals, hulls, ellipsoid }.group(stage, layout)
        };
        let windows = (0..windows.count).map(group).collect();
        Hulls { pipeline: pipeline.clone(), windows, triangles: step.batch.triangles() }
    }

    fn settings(&self, index: usize, light: &PointBatch<'_>) -> SampleSettings {
        let (plan, options) = (self.plan, self.options);
        let batch = &plan.batches[index];
        let mut switches = plan.switches;
        let mut switch = |bit, on: bool| switches |= if on { bit } else { 0 };
        switch(FIRST_TRIANGLES, index == 0);
        switch(LAST_TRIANGLES, index + 1 == plan.opaque_batches());
        switch(FIRST_POINTS, light.index == 0);
        switch(KEEP_BITS, plan.batches.len() > 1 || options.keep_bits);
        let word_count = light.points.len().div_ceil(WORD) as u32;
        let iterations_per_triangle = iterations_per_triangle(batch, word_count, light.max_cells);
        // Iterations per receiver: itself, its words twice (any open, which are hidden), and the ends of these loops.
        let iterations_per_receiver = 3 + word_count * (1 + iterations_per_word(batch));
        // No pass runs long in any scene.
        let max_iterations = self.groups.stage.device.max_iterations();
        SampleSettings {
            triangle_stride: stride_of(batch),
            iterations_per_triangle,
            max_iterations: max_iterations - MAX_WAITING * iterations_per_triangle - 4 * MAX_WORDS as u32 * 10,
            point_count: light.points.len() as u32,
            word_count,
            cells_across: cells_across(light.points),
            max_cells: light.max_cells,
            first_word: if options.keep_bits { (light.index * plan.words) as u32 } else { 0 },
            switches,
            receivers_per_instance: max_iterations / iterations_per_receiver,
            ..*self.base
        }
    }

    fn over_groups(
        &self,
        condition: WorkCondition,
        step: &Step<'_>,
        pipeline: &wgpu::ComputePipeline,
        passes: u32,
    ) -> OverGroups {
        let FrameGroups { stage, layouts, buffers } = self.groups;
        let BufferSet { list, triangles, boxes, totals, work, bits, .. } = buffers;
        let settings = &settings_uniform(stage, &step.settings);
        let lookup = self.table;
        let (light_words, light_cells) = (&step.light.words, &step.light.cells);
        let snapped_texels = stage.snapped_texels();
        let evaluated = Evaluated {
            settings,
            list,
            triangles,
            boxes,
            light_words,
            bits,
            totals,
            lookup,
            work,
            light_cells,
            snapped_texels,
        };
        OverGroups { condition, pipeline: pipeline.clone(), group: evaluated.group(stage, &layouts.evaluate), passes }
    }
}

/// Returns the largest number of loop iterations for a triangle: its shadow's box, then words, or rows of cells and their light points.
fn iterations_per_triangle(batch: &Batch, word_count: u32, max_cells: u32) -> u32 {
    // Two light points per iteration, each of which may loop.
    let singled_out = if max_cells == 0 { 0 } else { 2 * MAX_ROWS + MAX_SINGLED_OUT / 2 };
    let of_points = if batch.surfaces == Surfaces::Opaque { 0 } else { MAX_SINGLED_OUT };
    2 + (word_count * iterations_per_word(batch)).max(singled_out + of_points)
}

/// Returns the largest number of loop iterations for a word of light points: its box, and its points.
fn iterations_per_word(batch: &Batch) -> u32 {
    match batch.surfaces {
        Surfaces::Opaque => 2,
        Surfaces::Masked(_) => 2 + WORD as u32,
        // Four light points per iteration.
        Surfaces::Tinted(_) => 2 + WORD as u32 / 4,
    }
}
