//! Pipelines of the passes.

use crate::gpu::{Gpu, compute_entry, compute_pipeline};
use crate::receivers::inputs::FrameInputs;
use crate::shaders;

use super::Options;
use super::batches::Surfaces;
use super::groups::Layouts;
use super::settings::{DRAWN, EITHER, WALKED};

/// Condition under which a pass has work, if the device chooses between drawn and walked triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum WorkCondition {
    Either = EITHER,
    Drawn = DRAWN,
    Walked = WALKED,
}

impl WorkCondition {
    /// All values, in the order of their numbers.
    pub(super) const ALL: [Self; 3] = [Self::Either, Self::Drawn, Self::Walked];
}

#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) clear: wgpu::ComputePipeline,
    pub(super) bounds: wgpu::ComputePipeline,
    pub(super) count: wgpu::ComputePipeline,
    pub(super) scatter: wgpu::ComputePipeline,
    /// `scatter` for lists with positions; created when a frame first needs it.
    pub(super) storing_scatter: Option<wgpu::ComputePipeline>,
    /// Pipelines of the device's choice; created when a frame first needs them.
    pub(super) choice: Option<Choice>,
    pub(super) arguments: wgpu::ComputePipeline,
    /// Pipelines by [`WorkCondition`].
    begin: [wgpu::ComputePipeline; WorkCondition::ALL.len()],
    pub(super) advance: wgpu::ComputePipeline,
    pub(super) edge_faces: wgpu::ComputePipeline,
    pub(super) triangle_count: wgpu::ComputePipeline,
    pub(super) triangle_scatter: wgpu::ComputePipeline,
    pub(super) cluster_boxes: wgpu::ComputePipeline,
    pub(super) super_boxes: wgpu::ComputePipeline,
    pub(super) make_lookup: wgpu::ComputePipeline,
}

/// Pipelines that choose between drawing triangles over a window and groups that walk them.
#[derive(Debug)]
pub(super) struct Choice {
    pub(super) choose: wgpu::ComputePipeline,
    /// Counts receivers by cells of space, if groups are chosen.
    pub(super) count_again: wgpu::ComputePipeline,
}

/// Key of an evaluating pipeline; see the shader's `override` constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Evaluator {
    uses_table: bool,
    has_holes: bool,
    has_tint: bool,
    counts: bool,
    is_flat: bool,
}

impl Evaluator {
    pub(super) fn of(surfaces: Surfaces, options: &Options) -> Self {
        Self {
            uses_table: options.lookup_size > 0,
            has_holes: matches!(surfaces, Surfaces::Masked(_)),
            has_tint: matches!(surfaces, Surfaces::Tinted(_)),
            counts: options.counts,
            is_flat: options.points.iter().all(|point| point.at.z == 0.0),
        }
    }

    pub(super) fn pipeline(self, gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) -> wgpu::ComputePipeline {
        compute_entry(
            gpu,
            "view-sample evaluate",
            shaders::EVALUATION_EVALUATE,
            None,
            &self.constants(),
            &[&inputs.layout, &layouts.evaluate, &layouts.surface],
        )
    }

    /// Returns the shader's `override` constants.
    pub(super) fn constants(self) -> [(&'static str, f64); 5] {
        let value = |is_on: bool| f64::from(u8::from(is_on));
        [
            ("USES_TABLE", value(self.uses_table)),
            ("HAS_HOLES", value(self.has_holes)),
            ("HAS_TINT", value(self.has_tint)),
            ("COUNTS", value(self.counts)),
            ("IS_FLAT", value(self.is_flat)),
        ]
    }
}

impl Pipelines {
    pub(super) fn new(gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) -> Self {
        let lists = [&inputs.layout, &layouts.lists];
        let casters = [&layouts.casters, &layouts.mesh];
        let pipeline = |label, wgsl, layouts: &[&wgpu::BindGroupLayout]| compute_pipeline(gpu, label, wgsl, layouts);
        let [clear, arguments, passes, boxes, table] =
            [&layouts.clear, &layouts.arguments, &layouts.passes, &layouts.boxes, &layouts.make_lookup]
                .map(|layout| [layout]);
        Self {
            clear: pipeline("view-sample clear", shaders::RECEIVER_LISTS_CLEAR, &clear),
            bounds: pipeline("view-sample bounds", shaders::LISTS_BOUNDS, &lists),
            count: pipeline("view-sample count", shaders::LISTS_COUNT, &lists),
            scatter: pipeline("view-sample scatter", shaders::LISTS_SCATTER, &lists),
            storing_scatter: None,
            choice: None,
            arguments: pipeline("view-sample arguments", shaders::LISTS_ARGUMENTS, &arguments),
            begin: WorkCondition::ALL.map(|condition| {
                let constants = [("WAY", f64::from(condition as u32))];
                compute_entry(gpu, "view-sample begin", shaders::EVALUATION_BEGIN, None, &constants, &passes)
            }),
            advance: pipeline("view-sample advance", shaders::EVALUATION_ADVANCE, &passes),
            edge_faces: pipeline("edge faces", shaders::TRIANGLES_EDGE_FACES, &casters),
            triangle_count: pipeline("triangle count", shaders::TRIANGLES_COUNT, &casters),
            triangle_scatter: pipeline("triangle scatter", shaders::TRIANGLES_SCATTER, &casters),
            cluster_boxes: pipeline("cluster boxes", shaders::TRIANGLES_CLUSTER_BOXES, &boxes),
            super_boxes: pipeline("super boxes", shaders::TRIANGLES_SUPER_BOXES, &boxes),
            make_lookup: pipeline("view-sample table", shaders::LIGHT_BITS_MAKE_LOOKUP, &table),
        }
    }

    /// Returns the pipeline that prepares the first pass.
    pub(super) fn begin(&self, condition: WorkCondition) -> &wgpu::ComputePipeline {
        &self.begin[condition as usize]
    }

    /// Creates the pipelines that choose between drawn and walked triangles.
    pub(super) fn prepare_choice(&mut self, gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) {
        let lists = [&inputs.layout, &layouts.lists];
        self.choice.get_or_insert_with(|| Choice {
            choose: compute_pipeline(gpu, "view-sample choice", shaders::LISTS_CHOOSE, &lists),
            count_again: compute_entry(
                gpu,
                "view-sample count by cells",
                shaders::LISTS_COUNT,
                None,
                &[("IS_AGAIN", 1.0)],
                &lists,
            ),
        });
    }

    /// Creates the pipeline that stores positions in the lists.
    pub(super) fn prepare_storing(&mut self, gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) {
        self.storing_scatter.get_or_insert_with(|| {
            compute_entry(
                gpu,
                "view-sample scatter of positions",
                shaders::LISTS_SCATTER,
                None,
                &[("STORED_POSITIONS", 1.0)],
                &[&inputs.layout, &layouts.lists],
            )
        });
    }
}
