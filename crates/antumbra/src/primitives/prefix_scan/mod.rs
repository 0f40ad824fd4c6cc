//! Exclusive prefix sums of `u32`, in place, for example to turn counts into storage offsets.
//!
//! Blocks of 2048 items are scanned separately, then their sums likewise, until one sum is left, the total. On the way
//! back each block adds the sum of the blocks before it (Blelloch 1990, CMU-CS-90-190, section 1.3). Every item is read
//! and written twice. Sums wrap as `u32` does, so callers must bound the total.

use std::num::NonZeroU64;

use crate::gpu::{Bindings, Gpu, Recorder, Span, Stage, bindings, compute_pipeline, shared_constants};
use crate::shaders;

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;

shared_constants! {
    /// Number of items that one workgroup scans.
    const ITEMS_PER_BLOCK: u32 = 2048, as in PREFIX_SCAN_ADD;
}

bindings! {
    struct Level = "prefix scan", COMPUTE, group 0 of [PREFIX_SCAN] {
        /// Items; the shader derives their number from the size of the binding.
        0 items: ReadWritePart,
        /// Sum of each block; in the second phase, the sum of all blocks before it.
        1 block_sums: ReadWrite,
    }
}

/// Scans arrays of `u32`.
#[derive(Debug)]
pub(crate) struct PrefixScan {
    layout: wgpu::BindGroupLayout,
    scan: wgpu::ComputePipeline,
    add: wgpu::ComputePipeline,
    levels: Option<Levels>,
}

/// Sums of blocks, of blocks of blocks, and so on up to the total.
#[derive(Debug)]
struct Levels {
    count: u32,
    sums: Vec<wgpu::Buffer>,
    /// Steps, level by level: its items and the sums of its blocks.
    steps: Vec<Step>,
}

#[derive(Debug)]
struct Step {
    bind_group: wgpu::BindGroup,
    block_count: u32,
}

impl PrefixScan {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = Level::layout(gpu);
        Self {
            scan: compute_pipeline(gpu, "prefix scan", shaders::PREFIX_SCAN, &[&layout]),
            add: compute_pipeline(gpu, "prefix scan add", shaders::PREFIX_SCAN_ADD, &[&layout]),
            layout,
            levels: None,
        }
    }

    /// Prepares a scan of the first `count` items of `items`, a buffer with usage `STORAGE`; `count` must not be 0.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, items: &wgpu::Buffer, count: u32) {
        let sums = match self.levels.take() {
            Some(levels) if levels.count == count => levels.sums,
            _ => level_counts(count)
                .into_iter()
                .map(|count| {
                    stage.device.create_buffer(&wgpu::BufferDescriptor {
                        label: Some("antumbra prefix scan sums"),
                        size: u64::from(count) * 4,
                        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                        mapped_at_creation: false,
                    })
                })
                .collect(),
        };
        let steps = std::iter::once(items)
            .chain(&sums)
            .zip(&sums)
            .zip(std::iter::once(count).chain(level_counts(count)))
            .map(|((items, sums), count)| Step {
                bind_group: Level { items: first(items, count), block_sums: sums }.group(stage, &self.layout),
                block_count: count.div_ceil(ITEMS_PER_BLOCK),
            })
            .collect();
        self.levels = Some(Levels { count, sums, steps });
    }

    /// Scans the items in a pass with this label.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, label: &'static str) {
        recorder.compute(label, Span::Only, |pass| self.dispatch(pass));
    }

    /// Scans the items in an existing pass.
    pub(crate) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>) {
        let Some(levels) = &self.levels else { return };
        let mut step = |pipeline, step: &Step| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &step.bind_group, &[]);
            pass.dispatch_workgroups(step.block_count, 1, 1);
        };
        levels.steps.iter().for_each(|level| step(&self.scan, level));
        // The last level is one block, which has no block before it.
        levels.steps.iter().rev().skip(1).for_each(|level| step(&self.add, level));
    }

    /// Sum of all items, a `u32` at offset 0, with usages `STORAGE` and `COPY_SRC`; `None` before [`Self::prepare`].
    #[allow(dead_code, reason = "for scans whose last item is not the total")]
    pub(crate) fn total(&self) -> Option<&wgpu::Buffer> {
        self.levels.as_ref().and_then(|levels| levels.sums.last())
    }

    /// Memory of the sums, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.levels.as_ref().map_or(0, |levels| levels.sums.iter().map(wgpu::Buffer::size).sum())
    }
}

/// Binding of the first items of a buffer.
fn first(items: &wgpu::Buffer, count: u32) -> wgpu::BufferBinding<'_> {
    wgpu::BufferBinding { buffer: items, offset: 0, size: NonZeroU64::new(u64::from(count) * 4) }
}

/// Number of sums of each level, down to the total.
fn level_counts(count: u32) -> Vec<u32> {
    let mut counts = vec![count.div_ceil(ITEMS_PER_BLOCK)];
    while let Some(&count @ 2..) = counts.last() {
        counts.push(count.div_ceil(ITEMS_PER_BLOCK));
    }
    counts
}
