//! Splits between layers, found on the GPU: a histogram of where splits are needed, then Lloyd's relaxation on it.

use glam::UVec2;

use super::gpu_types::{LvsmHistogramUniform, LvsmUniform};
use super::params::{LvsmParams, LvsmTeleport, RelaxOver};
use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_entry, create_uniform, write_uniform};
use crate::primitives::lloyd::{Lloyd, Relaxation, Teleport};
use crate::shaders;
use crate::techniques::filterable::{Filterable, FrameMap, PreparedBasis, pipelines_index};

bindings! {
    /// Histogram and its parameters: group 1 of the pass over the map, group 2 of the pass over the receivers.
    struct Wanted = "wanted splits", COMPUTE {
        /// Grid of neighbourhoods or of receivers that add to the histogram.
        0 grid: Uniform,
        1 histogram: ReadWrite,
    }
}

/// Maximum number of threads along a side that fill the histogram from the map; its integers hold the sum of that many.
const MAX_NEIGHBOURHOODS: u32 = 512;

/// Maximum number of receivers along a side that fill the histogram from the view.
const MAX_RECEIVERS: u32 = 128;

/// Smallest width of a layer as published, in t: two bins of the histogram. A layer without depth would have no moments.
const MIN_LAYER: f32 = 2.0 / 4096.0;

/// Threads along each side of a workgroup of the histogram.
const TILE: u32 = 8;

/// Key of the pass that fills the histogram in the prepared frame.
#[derive(Clone, Copy, Debug)]
struct Gathering {
    source: RelaxOver,
    multisampled: bool,
    is_distance: bool,
    counts_background: bool,
    /// Number of threads.
    grid: UVec2,
}

impl Gathering {
    fn shader(self) -> &'static str {
        match (self.source, self.multisampled) {
            (RelaxOver::Map | RelaxOver::MapAsPublished, false) => shaders::LVSM_HISTOGRAM,
            (RelaxOver::Map | RelaxOver::MapAsPublished, true) => shaders::LVSM_HISTOGRAM_MULTISAMPLED,
            (RelaxOver::View, false) => shaders::LVSM_BLEEDING,
            (RelaxOver::View, true) => shaders::LVSM_BLEEDING_MULTISAMPLED,
        }
    }

    fn index(self) -> usize {
        let source = 2 * self.source as usize + usize::from(self.counts_background);
        4 * source + pipelines_index(self.multisampled, self.is_distance)
    }
}

/// Splits between layers, and the passes that move them.
#[derive(Debug)]
pub(super) struct LayerRelaxation {
    lloyd: Lloyd,
    layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    /// Pipelines indexed by [`Gathering::index`], created on first use.
    pipelines: [Option<wgpu::ComputePipeline>; 24],
    /// Histogram pass of the prepared frame; `None` if the splits are given.
    gathering: Option<Gathering>,
}

/// Pass that fills the histogram of one frame.
#[derive(Debug)]
pub(super) struct PreparedRelaxation {
    gathering: Gathering,
    pipeline: wgpu::ComputePipeline,
}

impl LayerRelaxation {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let lloyd = Lloyd::new(gpu);
        let layout = Wanted::layout(gpu);
        let uniform = create_uniform::<LvsmHistogramUniform>(gpu, "antumbra wanted splits");
        let bind_group = Wanted { grid: &uniform, histogram: lloyd.histogram() }.cached_group(gpu, &layout);
        Self { lloyd, layout, uniform, bind_group, pipelines: [const { None }; 24], gathering: None }
    }

    /// Returns the buffer of splits: floats in ascending order, in t.
    pub(super) fn splits(&self) -> &wgpu::Buffer {
        self.lloyd.splits()
    }

    /// Sets the splits of the next frame.
    pub(super) fn set(&mut self, stage: &Stage<'_>, splits: &[f32]) {
        self.gathering = None;
        self.lloyd.set(stage, splits);
    }

    /// Prepares the relaxation of the next frame's splits; `basis` is that frame's map, prepared by `passes`.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        passes: &Filterable<LvsmUniform>,
        basis: &PreparedBasis,
        map: &FrameMap,
        view_size: UVec2,
        params: &LvsmParams,
        overlap: f32,
    ) -> PreparedRelaxation {
        let multisampled = map.sample_count > 1;
        let (size, most) = match params.relax_over {
            RelaxOver::Map | RelaxOver::MapAsPublished => (map.size, MAX_NEIGHBOURHOODS),
            RelaxOver::View => (view_size, MAX_RECEIVERS),
        };
        let stride = size.max_element().div_ceil(most);
        let grid = size.map(|texels| texels.div_ceil(stride));
        let is_distance = passes.is_distance();
        let (source, counts_background) = (params.relax_over, params.relax_background);
        let gathering = Gathering { source, multisampled, is_distance, counts_background, grid };
        self.gathering = Some(gathering);
        let uniform = LvsmHistogramUniform {
            stride,
            overlap,
            kernel_size: params.kernel_size,
            min_weight: params.relax_from.powi(2),
            max_weight: params.relax_up_to.powi(2),
            ..LvsmHistogramUniform::default()
        };
        write_uniform(stage, &self.uniform, &uniform);
        self.lloyd.prepare(stage, params.layers - 1, &relaxation_of(params, overlap));
        let (layout, pipeline) = (&self.layout, &mut self.pipelines[gathering.index()]);
        let [distance] = passes.distance_constant();
        let pipeline = pipeline.get_or_insert_with(|| match params.relax_over {
            RelaxOver::Map | RelaxOver::MapAsPublished => {
                let as_published =
                    ("AS_PUBLISHED", f64::from(u8::from(params.relax_over == RelaxOver::MapAsPublished)));
                let background = ("COUNTS_BACKGROUND", f64::from(u8::from(params.relax_background)));
                let constants = [as_published, background, distance];
                let layouts = [basis.encode_layout(), layout];
                compute_entry(stage, "second occluders", gathering.shader(), None, &constants, &layouts)
            }
            RelaxOver::View => {
                let layouts = [passes.inputs_layout(), basis.depth_layout(), layout];
                compute_entry(stage, "bleeding", gathering.shader(), None, &[distance], &layouts)
            }
        });
        PreparedRelaxation { gathering, pipeline: pipeline.clone() }
    }

    /// Whether the GPU finds the prepared frame's splits from its light map.
    pub(super) fn is_due(&self) -> bool {
        self.gathering.is_some()
    }

    /// Whether the splits no longer move after `still_frames` equal frames.
    pub(super) fn is_settled(&self, still_frames: u32) -> bool {
        !self.is_due() || self.lloyd.is_settled(still_frames)
    }

    /// Records the passes that move the splits: after the light map, before the passes that read them.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, basis: &PreparedBasis, prepared: &PreparedRelaxation) {
        let PreparedRelaxation { gathering, pipeline } = prepared;
        self.lloyd.record_clear(recorder);
        recorder.compute("splits", Span::First, |pass| {
            pass.set_pipeline(pipeline);
            match gathering.source {
                RelaxOver::Map | RelaxOver::MapAsPublished => {
                    pass.set_bind_group(0, basis.encode_group(), &[]);
                    pass.set_bind_group(1, &self.bind_group, &[]);
                }
                RelaxOver::View => {
                    basis.inputs().bind(pass);
                    pass.set_bind_group(1, basis.depth_group(), &[]);
                    pass.set_bind_group(2, &self.bind_group, &[]);
                }
            }
            pass.dispatch_workgroups(gathering.grid.x.div_ceil(TILE), gathering.grid.y.div_ceil(TILE), 1);
        });
        self.lloyd.record(recorder, "splits", Span::Last);
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.gathering.map_or(0, |_| self.lloyd.memory_bytes())
    }
}

/// Returns how a frame relaxes the splits.
fn relaxation_of(params: &LvsmParams, overlap: f32) -> Relaxation {
    Relaxation {
        iterations: 1,
        moved_count: params.splits_per_frame,
        // A second occluder needs a split behind it; a receiver names the split itself.
        shift: if params.relax_over == RelaxOver::Map { 1.5 * overlap } else { 0.0 },
        min_gap: if params.relax_over == RelaxOver::MapAsPublished { MIN_LAYER } else { 3.0 * overlap },
        teleport: match params.teleport {
            LvsmTeleport::Inertia => Teleport::Inertia,
            LvsmTeleport::Weight => Teleport::Weight,
        },
    }
}
