//! Lloyd's relaxation in one dimension: means of the clusters of a weighted histogram, retained on the GPU between frames.
//!
//! Stuart Lloyd 1982; as Lauritzen & McCool 2008, section 4, use it, but on a histogram. A cluster's weighted mean comes from
//! sums of bins instead of a mip pyramid of samples, so the cost of an iteration does not depend on the number of means or
//! samples. Integers have the same sum in any order, so every adapter finds the same means.
//!
//! After each iteration a mean may *teleport*: the cluster whose merging with a neighbour adds the least inertia (weight ×
//! variance) is merged, and the one with the most inertia is split at one standard deviation to both sides, if the gain is more
//! than twice the cost. The paper instead teleports clusters without weight, which are the cheapest to merge, and splits the
//! heaviest ([`Teleport::Weight`]).
//!
//! Means may jump. Splits follow gradually, a fraction of the way per frame, to avoid popping in moving scenes.

use crate::gpu::{
    Bindings, Gpu, Recorder, Span, Stage, bindings, compute_entry, create_uniform, gpu_structs, write_uniform,
};
use crate::shaders;

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;

/// Number of bins of the histogram, which cover [0, 1] evenly.
pub(crate) const BIN_COUNT: u32 = 4096;

/// Maximum number of means.
pub(crate) const MAX_MEANS: usize = 15;

/// Iterations of the first frame, which has no earlier frame to be consistent with: enough to converge.
const FIRST_ITERATIONS: u32 = 32;

/// Fraction of the remaining distance that splits move per frame; after [`GLIDE_FRAMES`] less than a bin remains.
const GLIDE: f32 = 0.25;
const GLIDE_FRAMES: u32 = 30;

gpu_structs! {
    /// Parameters of an update.
    pub(crate) struct LloydUniform {
        cluster_count: u32,
        iterations: u32,
        moved_count: u32,
        moved_first: u32,
        begins: u32,
        shift: f32,
        min_gap: f32,
        glide: f32,
    }
}

bindings! {
    struct Update = "lloyd", COMPUTE, group 0 of [LLOYD_UPDATE] {
        0 lloyd: Uniform,
        1 histogram: Storage,
        2 means: ReadWrite,
        3 splits: ReadWrite,
    }
}

/// Parameters of the relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relaxation {
    /// Iterations per update.
    pub(crate) iterations: u32,
    /// Number of means that move in each iteration, in turn.
    pub(crate) moved_count: u32,
    /// Offset of each split from its mean.
    pub(crate) shift: f32,
    /// Minimum distance of splits from each other and from the ends.
    pub(crate) min_gap: f32,
    /// Choice of the clusters to merge and to split.
    pub(crate) teleport: Teleport,
}

/// Choice of the clusters to merge and to split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Teleport {
    /// Merges the cluster that adds the least inertia, and splits the one with the most, if that pays.
    #[default]
    Inertia,
    /// Merges a cluster without weight, and splits the heaviest, as published by Lauritzen and McCool, section 5.
    Weight,
}

/// Means on the GPU and the pass that updates them.
#[derive(Debug)]
pub(crate) struct Lloyd {
    layout: wgpu::BindGroupLayout,
    pipeline: (Teleport, wgpu::ComputePipeline),
    uniform: wgpu::Buffer,
    histogram: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    splits: wgpu::Buffer,
    /// Number of means of the last prepared frame; `None` if the next one starts anew.
    cluster_count: Option<u32>,
    moved_first: u32,
    /// Number of updates since the one that started anew.
    begun_before: u32,
    /// Number of updates after which means converge from any start.
    converge_in: u32,
}

fn pipeline_of(gpu: &Gpu, layout: &wgpu::BindGroupLayout, teleport: Teleport) -> wgpu::ComputePipeline {
    let constants = [("BY_WEIGHT", f64::from(u8::from(teleport == Teleport::Weight)))];
    compute_entry(gpu, "lloyd", shaders::LLOYD_UPDATE, None, &constants, &[layout])
}

impl Lloyd {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = Update::layout(gpu);
        let buffer = |label, entries: u64| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: 4 * entries,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let uniform = create_uniform::<LloydUniform>(gpu, "antumbra lloyd");
        let histogram = buffer("antumbra lloyd histogram", u64::from(BIN_COUNT));
        let means = buffer("antumbra lloyd means", MAX_MEANS as u64);
        let splits = buffer("antumbra lloyd splits", MAX_MEANS as u64);
        let update = Update { lloyd: &uniform, histogram: &histogram, means: &means, splits: &splits };
        let bind_group = update.cached_group(gpu, &layout);
        Self {
            pipeline: (Teleport::default(), pipeline_of(gpu, &layout, Teleport::default())),
            layout,
            uniform,
            histogram,
            bind_group,
            splits,
            cluster_count: None,
            moved_first: 0,
            begun_before: 0,
            converge_in: 0,
        }
    }

    /// Histogram: [`BIN_COUNT`] weights whose sum is less than 2³². The caller fills it between [`Self::record_clear`] and
    /// [`Self::record`].
    pub(crate) fn histogram(&self) -> &wgpu::Buffer {
        &self.histogram
    }

    /// Splits: up to [`MAX_MEANS`] floats in ascending order.
    pub(crate) fn splits(&self) -> &wgpu::Buffer {
        &self.splits
    }

    /// Sets the splits explicitly; the next [`Self::prepare`] starts anew.
    pub(crate) fn set(&mut self, stage: &Stage<'_>, splits: &[f32]) {
        self.cluster_count = None;
        if !splits.is_empty() {
            stage.upload(&self.splits, 0, bytemuck::cast_slice(splits));
        }
    }

    /// Uploads the next update of `cluster_count` means, 1 to [`MAX_MEANS`]. If their number changes, they start evenly spread
    /// and converge in this update.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, cluster_count: u32, how: &Relaxation) {
        if self.pipeline.0 != how.teleport {
            self.pipeline = (how.teleport, pipeline_of(stage, &self.layout, how.teleport));
            self.cluster_count = None;
        }
        let begins = self.cluster_count != Some(cluster_count);
        let moved_count = if begins { cluster_count } else { how.moved_count.min(cluster_count) };
        let iterations = if begins { FIRST_ITERATIONS.max(how.iterations) } else { how.iterations };
        self.begun_before = if begins { 0 } else { self.begun_before.saturating_add(1) };
        self.converge_in = (FIRST_ITERATIONS * cluster_count).div_ceil(how.iterations.max(1) * moved_count.max(1));
        let uniform = LloydUniform {
            cluster_count,
            iterations,
            moved_count,
            moved_first: self.moved_first % cluster_count,
            begins: begins.into(),
            shift: how.shift,
            min_gap: how.min_gap,
            glide: GLIDE,
        };
        self.write(stage, &uniform);
    }

    /// Whether the splits no longer move after `times` repetitions of the same histogram. They converge at once if its first
    /// update started anew.
    pub(crate) fn is_settled(&self, times: u32) -> bool {
        times >= self.begun_before.min(self.converge_in + GLIDE_FRAMES)
    }

    fn write(&mut self, stage: &Stage<'_>, uniform: &LloydUniform) {
        write_uniform(stage, &self.uniform, uniform);
        self.cluster_count = Some(uniform.cluster_count);
        self.moved_first = (uniform.moved_first + uniform.iterations * uniform.moved_count) % uniform.cluster_count;
    }

    /// Clears the histogram.
    pub(crate) fn record_clear(&self, recorder: &mut Recorder<'_>) {
        recorder.clear_buffer(&self.histogram);
    }

    /// Updates the means and writes the splits.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, label: &'static str, span: Span) {
        recorder.compute(label, span, |pass| {
            pass.set_pipeline(&self.pipeline.1);
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }

    /// Memory of histogram, means and splits, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.histogram.size() + 2 * self.splits.size()
    }
}
