//! Lloyd's relaxation in one dimension: means of the clusters of a weighted histogram, kept on the GPU from frame to frame.
//!
//! Stuart Lloyd 1982; as Lauritzen & McCool 2008, section 4, use it, but on a histogram: a cluster's weighted mean comes
//! from sums of bins instead of a mip pyramid of samples, so that an iteration costs the same for one mean or all, whatever
//! the number of samples; and integers add up to the same in any order, so that every adapter finds the same means.
//!
//! After each iteration a mean may *teleport*: the cluster whose merging with a neighbour adds the least inertia (weight ×
//! variance) is merged, and the one with the most inertia is split at one deviation to both sides, where that pays twice.
//! The paper teleports clusters without weight, which are but the cheapest to merge, and splits the heaviest
//! ([`Teleport::Weight`]).
//!
//! Means may jump; splits glide after them, a part of the way in each frame, so that nothing pops where the scene moves.

use crate::gpu::{
    Bindings, Gpu, Recorder, Span, Stage, bindings, compute_entry, create_uniform, gpu_structs, write_uniform,
};
use crate::shaders;

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;

/// Bins of the histogram, evenly over [0, 1].
pub(crate) const BIN_COUNT: u32 = 4096;

/// The most means.
pub(crate) const MAX_MEANS: usize = 15;

/// Iterations of the first frame, which has no picture before it to be like: enough to converge.
const FIRST_ITERATIONS: u32 = 32;

/// The part of the way to their places that splits go in a frame: what is left after [`GLIDE_FRAMES`] is less than a bin.
const GLIDE: f32 = 0.25;
const GLIDE_FRAMES: u32 = 30;

gpu_structs! {
    /// What an update does.
    pub(crate) struct LloydUniform {
        cluster_count: u32,
        iterations: u32,
        moved_count: u32,
        moved_first: u32,
        begins: u32,
        shift: f32,
        least_gap: f32,
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

/// How to relax.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relaxation {
    /// Iterations of an update.
    pub(crate) iterations: u32,
    /// Means that move in each iteration, in turns.
    pub(crate) moved_count: u32,
    /// Added to each mean to give its split.
    pub(crate) shift: f32,
    /// Splits lie no closer to each other and to the ends.
    pub(crate) least_gap: f32,
    /// Which clusters merge, and which is split.
    pub(crate) teleport: Teleport,
}

/// Which clusters merge, and which is split for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Teleport {
    /// The one that adds the least inertia, and the one that has the most, where that pays.
    #[default]
    Inertia,
    /// One without weight, and the one of the largest, as Lauritzen and McCool print it, section 5.
    Weight,
}

/// The means and their pass.
#[derive(Debug)]
pub(crate) struct Lloyd {
    layout: wgpu::BindGroupLayout,
    pipeline: (Teleport, wgpu::ComputePipeline),
    uniform: wgpu::Buffer,
    histogram: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    splits: wgpu::Buffer,
    /// Number of means of the last prepared frame; none before the first.
    cluster_count: Option<u32>,
    moved_first: u32,
    /// Updates since the one that began.
    begun_before: u32,
    /// Updates until means that begin anywhere have converged.
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
        let bind_group = update.kept_group(gpu, &layout);
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

    /// The histogram: [`BIN_COUNT`] weights that sum to less than 2³², for the user to fill between
    /// [`Self::record_clear`] and [`Self::record`].
    pub(crate) fn histogram(&self) -> &wgpu::Buffer {
        &self.histogram
    }

    /// The splits: up to [`MAX_MEANS`] floats in ascending order.
    pub(crate) fn splits(&self) -> &wgpu::Buffer {
        &self.splits
    }

    /// Sets splits by hand; the next [`Self::prepare`] begins anew.
    pub(crate) fn set(&mut self, stage: &Stage<'_>, splits: &[f32]) {
        self.cluster_count = None;
        if !splits.is_empty() {
            stage.upload(&self.splits, 0, bytemuck::cast_slice(splits));
        }
    }

    /// Uploads the next update of `cluster_count` means, 1 to [`MAX_MEANS`]. Where their number changes, they begin evenly
    /// spread and converge at once.
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
            least_gap: how.least_gap,
            glide: GLIDE,
        };
        self.write(stage, &uniform);
    }

    /// Whether splits stay where they are once the same histogram was given so many times after the first: where that one began
    /// they converged at once.
    pub(crate) fn is_settled(&self, times: u32) -> bool {
        times >= self.begun_before.min(self.converge_in + GLIDE_FRAMES)
    }

    fn write(&mut self, stage: &Stage<'_>, uniform: &LloydUniform) {
        write_uniform(stage, &self.uniform, uniform);
        self.cluster_count = Some(uniform.cluster_count);
        self.moved_first = (uniform.moved_first + uniform.iterations * uniform.moved_count) % uniform.cluster_count;
    }

    /// Empties the histogram.
    pub(crate) fn record_clear(&self, recorder: &mut Recorder<'_>) {
        recorder.clear_buffer(&self.histogram);
    }

    /// Moves the means, writes the splits.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, label: &'static str, span: Span) {
        recorder.compute(label, span, |pass| {
            pass.set_pipeline(&self.pipeline.1);
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }

    /// Bytes of histogram, means and splits.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.histogram.size() + 2 * self.splits.size()
    }
}
