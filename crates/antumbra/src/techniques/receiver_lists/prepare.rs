//! Preparation of a frame: its plan, then allocations, uploads and bind groups.

use super::buffers::BufferSet;
use super::caster_groups::CasterGroups;
use super::drawn_lists::ListWindows;
use super::evaluation::{Evaluations, PointBatch};
use super::gpu_types::SampleSettings;
use super::groups::FrameGroups;
use super::irradiance::Irradiance;
use super::light_points::WORD;
use super::lookup_table::Table;
use super::pipelines::Evaluator;
use super::plan::FramePlan;
use super::raster::Raster;
use super::settings::{CELL_COUNT, SUBSET_MISSING};
use super::subset::Subset;
use super::{Clears, Options, PreparedBatch, PreparedSamples, ViewSamples, settings_uniform, stride_of};
use crate::contract::{Error, MeshCaster, PreparedFrame};
use crate::gpu::{Gpu, Stage};
use crate::light_map::readable_meshes::readable_meshes;
use crate::mask::sparse_upsample::SparseUpsample;

impl ViewSamples {
    /// Allocates and uploads a frame's data.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        options: &Options,
    ) -> Result<PreparedSamples, Error> {
        let technique = self.technique;
        let meshes = readable_meshes(technique, frame, None)?;
        let binding_limit = stage.device.limits().max_storage_buffer_binding_size;
        let plan = FramePlan::new(technique, frame, meshes, options, binding_limit)?;
        let batches_of_points = options.points.chunks(plan.words * WORD).enumerate();
        let point_batches: Vec<_> = batches_of_points.map(|(i, points)| PointBatch::new(stage, i, points)).collect();
        Table::prepare(&mut self.table, stage, technique, options, point_batches.len())?;
        self.make_programs(stage, &plan, options);
        self.windows = Some(ListWindows::of(&plan));
        Ok(self.prepare_passes(stage, frame, meshes, options, &plan, &point_batches))
    }

    /// Creates missing pipelines of the frame's batches.
    fn make_programs(&mut self, gpu: &Gpu, plan: &FramePlan, options: &Options) {
        for batch in &plan.batches {
            let evaluator = Evaluator::of(batch.surfaces, options);
            let make = || evaluator.pipeline(gpu, &self.inputs, &self.layouts);
            self.evaluators.entry(evaluator).or_insert_with(make);
        }
        if plan.windows.is_none() {
            self.raster = None;
        } else {
            self.raster.get_or_insert_with(|| Raster::new(gpu, &self.inputs, &self.layouts));
        }
        if plan.stores_positions {
            self.pipelines.prepare_storing(gpu, &self.inputs, &self.layouts);
        }
        if plan.chooses() {
            self.pipelines.prepare_choice(gpu, &self.inputs, &self.layouts);
        }
    }

    /// Allocates what the plan needs, and binds it to the passes, whose pipelines exist.
    fn prepare_passes(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        meshes: &[MeshCaster<'_>],
        options: &Options,
        plan: &FramePlan,
        point_batches: &[PointBatch<'_>],
    ) -> PreparedSamples {
        let stride_px = if plan.is_sparse { SparseUpsample::STRIDE_PX } else { 1 };
        let inputs = self.inputs.prepare_known(stage, frame, stride_px);
        let buffers = self.buffers.prepare(stage, plan, &options.points);
        self.list_scan.prepare(stage, buffers.counts, plan.list_count + 1);
        self.cell_scan.prepare(stage, buffers.cells, CELL_COUNT + 1);
        let base = plan.settings(stage, frame, meshes, options);
        let base_uniform = settings_uniform(stage, &base);
        let raster_targets = self.raster.as_mut().map(|raster| raster.prepare(stage, plan.window_side, options.drawn));
        let layouts = &self.layouts;
        let groups = FrameGroups { stage, layouts, buffers };
        let casters = CasterGroups { stage, layouts, meshes, no_texture: &self.no_texture };
        let evaluations = Evaluations {
            groups,
            inputs: &self.inputs,
            evaluators: &self.evaluators,
            plan,
            options,
            base: &base,
            table: self.table.as_ref().map_or(&self.no_table, |table| &table.view),
            raster_targets: raster_targets.as_ref(),
        };
        let raster = &mut self.raster;
        let prepare_batch = |i| PreparedBatch::new(&evaluations, raster.as_mut(), &casters, i, point_batches);
        let batches = (0..plan.batches.len()).map(prepare_batch).collect();
        let irradiance = options.weighs_irradiance.then(|| {
            let irradiance = self.irradiance.get_or_insert_with(|| Irradiance::new(stage, &self.inputs));
            irradiance.prepare(stage, buffers, &base_uniform, &options.points)
        });
        let subset = plan.is_sparse.then(|| {
            let missing = settings_uniform(stage, &SampleSettings { subset: SUBSET_MISSING, ..base });
            let subset = self.subset.get_or_insert_with(|| Subset::new(stage, &self.inputs));
            subset.prepare(stage, &self.inputs, frame, &inputs, (buffers, groups.lists(&missing)))
        });
        if let Some(table) = &mut self.table {
            table.bind(stage, &layouts.make_lookup, &base_uniform, &point_batches[0].words);
        }
        PreparedSamples {
            inputs,
            dispatches: buffers.dispatches.clone(),
            clears: Clears::new(&groups),
            lists: groups.lists(&base_uniform),
            stores_positions: plan.stores_positions,
            chooses: plan.chooses(),
            edge_runs: casters.runs(plan.silhouette_runs()),
            edges: groups.casters(&base_uniform),
            passes: groups.passes(),
            batches,
            irradiance,
            subset,
        }
    }
}

impl Clears {
    fn new(groups: &FrameGroups<'_>) -> Self {
        let BufferSet { state, counts, cells, edges, penumbrae, work, .. } = groups.buffers;
        let [state, counts, cells, edges, penumbrae, work] =
            [state, counts, cells, edges, penumbrae, work].map(|buffer| groups.clear(buffer));
        Self { state, counts, cells, edges, penumbrae, work }
    }
}

impl PreparedBatch {
    /// Returns the passes of the plan's triangle batch `index`.
    fn new(
        evaluations: &Evaluations<'_>,
        mut raster: Option<&mut Raster>,
        casters: &CasterGroups<'_>,
        index: usize,
        point_batches: &[PointBatch<'_>],
    ) -> Self {
        let Evaluations { groups, plan, base, .. } = *evaluations;
        let batch = &plan.batches[index];
        let settings = SampleSettings { triangle_stride: stride_of(batch), ..*base };
        let settings = settings_uniform(groups.stage, &settings);
        let evaluate = |points| evaluations.of(raster.as_deref_mut(), index, points);
        Self {
            evaluate: point_batches.iter().map(evaluate).collect(),
            casters: groups.casters(&settings),
            arguments: groups.arguments(&settings),
            boxes: groups.boxes(&settings),
            surface: casters.surface(batch.surfaces),
            runs: casters.runs(&batch.runs),
            // Drawn triangles need no boxes.
            clusters: if plan.is_drawn(batch) && !plan.chooses() { 0 } else { batch.triangles().div_ceil(64) },
        }
    }
}
