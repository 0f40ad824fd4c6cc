//! Recording of a frame's passes: lists, then the triangles and evaluation of each batch.

use super::caster_groups::over_runs;
use super::evaluation::{Evaluation, OverGroups};
use super::pipelines::Pipelines;
use super::{PreparedBatch, PreparedSamples, ViewSamples};
use crate::gpu::{Recorder, Span};

/// Number of workgroups that clear a buffer.
const CLEAR_GROUPS: u32 = 64;

/// Group 1 of the passes that build a round's lists, and whether it is the frame's first round.
type Listed<'a> = (&'a wgpu::BindGroup, bool);

impl ViewSamples {
    /// Records every pass of a frame.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedSamples) {
        self.record_table(recorder);
        self.record_round(recorder, frame, (&frame.lists, true));
        if let Some(subset) = &frame.subset {
            subset.record(recorder, &frame.inputs);
            self.record_round(recorder, frame, (&subset.lists, false));
        }
    }

    /// Records the passes for the receivers of these lists.
    fn record_round(&self, recorder: &mut Recorder<'_>, frame: &PreparedSamples, listed: Listed<'_>) {
        self.record_lists(recorder, frame, listed);
        if !frame.edge_runs.is_empty() {
            recorder.compute("silhouettes", Span::Only, |pass| {
                clear(pass, &self.pipelines, &frame.clears.edges);
                pass.set_bind_group(0, &frame.edges, &[]);
                over_runs(pass, &self.pipelines.edge_faces, &frame.edge_runs);
            });
        }
        for step in 0..frame.batches[0].evaluate.len() {
            for batch in &frame.batches {
                // A single batch stays sorted.
                if step == 0 || frame.batches.len() > 1 {
                    self.record_sort(recorder, batch, frame);
                }
                self.record_evaluation(recorder, &batch.evaluate[step], &batch.surface, frame);
            }
        }
        if let Some(irradiance) = &frame.irradiance {
            irradiance.record(recorder, &frame.inputs);
        }
    }

    /// Records the computation of the table of section 4.2.
    fn record_table(&self, recorder: &mut Recorder<'_>) {
        if let Some(table) = &self.table
            && let Some(group) = &table.bind_group
        {
            recorder.compute("lookup table", Span::Only, |pass| {
                pass.set_pipeline(&self.pipelines.make_lookup);
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(table.groups[0], table.groups[1], table.groups[2]);
            });
        }
    }

    /// Records the sort of receivers into lists (section 3.1).
    fn record_lists(&self, recorder: &mut Recorder<'_>, frame: &PreparedSamples, (lists, is_first): Listed<'_>) {
        let pipelines = &self.pipelines;
        let over_pixels = |pass: &mut wgpu::ComputePass<'_>, pipeline: &wgpu::ComputePipeline| {
            pass.set_pipeline(pipeline);
            frame.inputs.bind(pass);
            pass.set_bind_group(1, lists, &[]);
            frame.inputs.dispatch(pass);
        };
        recorder.compute("view-sample lists", Span::Only, |pass| {
            clear(pass, pipelines, &frame.clears.state);
            clear(pass, pipelines, &frame.clears.counts);
            if is_first {
                // Counters continue from round to round.
                clear(pass, pipelines, &frame.clears.work);
            }
            over_pixels(pass, &pipelines.bounds);
            over_pixels(pass, &pipelines.count);
            if let Some(choice) = pipelines.choice.as_ref().filter(|_| frame.chooses) {
                pass.set_pipeline(&choice.choose);
                pass.dispatch_workgroups(CLEAR_GROUPS, 1, 1);
                over_pixels(pass, &choice.count_again);
            }
        });
        self.list_scan.record(recorder, "view-sample lists");
        let storing = pipelines.storing_scatter.as_ref().filter(|_| frame.stores_positions);
        let scatter = storing.unwrap_or(&pipelines.scatter);
        recorder.compute("view-sample lists", Span::Only, |pass| over_pixels(pass, scatter));
    }

    /// Records the tests of a batch of triangles against a batch of light points.
    fn record_evaluation(
        &self,
        recorder: &mut Recorder<'_>,
        evaluation: &Evaluation,
        surface: &wgpu::BindGroup,
        frame: &PreparedSamples,
    ) {
        match evaluation {
            Evaluation::Groups(over) => self.record_groups(recorder, over, surface, frame),
            Evaluation::Raster { walked, before, draw, after } => {
                for over in [walked, before].into_iter().flatten() {
                    self.record_groups(recorder, over, surface, frame);
                }
                if draw.silhouettes.is_some() {
                    recorder.compute("silhouettes", Span::Only, |pass| {
                        clear(pass, &self.pipelines, &frame.clears.penumbrae);
                    });
                }
                draw.record(recorder, &frame.inputs, surface);
                if let Some(over) = after {
                    self.record_groups(recorder, over, surface, frame);
                }
            }
        }
    }

    /// Records passes over the groups of receivers until each group is done.
    fn record_groups(
        &self,
        recorder: &mut Recorder<'_>,
        over: &OverGroups,
        surface: &wgpu::BindGroup,
        frame: &PreparedSamples,
    ) {
        recorder.compute("visibility", Span::Only, |pass| {
            for i in 0..over.passes {
                pass.set_pipeline(if i == 0 { self.pipelines.begin(over.condition) } else { &self.pipelines.advance });
                pass.set_bind_group(0, &frame.passes, &[]);
                pass.dispatch_workgroups(1, 1, 1);
                pass.set_pipeline(&over.pipeline);
                frame.inputs.bind(pass);
                pass.set_bind_group(1, &over.group, &[]);
                pass.set_bind_group(2, surface, &[]);
                pass.dispatch_workgroups_indirect(&frame.dispatches, 0);
            }
        });
    }

    /// Records the sort of a batch's triangles.
    fn record_sort(&self, recorder: &mut Recorder<'_>, batch: &PreparedBatch, frame: &PreparedSamples) {
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
}

/// Clears a buffer to zero.
fn clear(pass: &mut wgpu::ComputePass<'_>, pipelines: &Pipelines, group: &wgpu::BindGroup) {
    pass.set_pipeline(&pipelines.clear);
    pass.set_bind_group(0, group, &[]);
    pass.dispatch_workgroups(CLEAR_GROUPS, 1, 1);
}
