//! Buffers of texel lists.

use std::sync::Arc;

use glam::UVec2;

use super::FRAGMENT_BYTES;
use super::options::{Gather, ListOptions};
use crate::gpu::{Gpu, Lease, NoDepth, Recorder, Scratch};

/// Buffers of lists, with the current options.
#[derive(Debug)]
pub(super) struct Storage {
    pub(super) options: ListOptions,
    pub(super) lease: Arc<Lease>,
    pub(super) cursors: Arc<wgpu::Buffer>,
    pub(super) fragments: Arc<wgpu::Buffer>,
    pub(super) lists: Arc<wgpu::Buffer>,
    pub(super) counters: Arc<wgpu::Buffer>,
    /// Linked fragments; of minimal size for arrays.
    pub(super) nodes: Arc<wgpu::Buffer>,
    /// Links of linked fragments; for arrays, the beginning of each texel's list.
    pub(super) links: Arc<wgpu::Buffer>,
    /// Unused depth attachments of one sample, and of four.
    pub(super) no_depth: NoDepth,
    pub(super) no_covered_depth: Option<NoDepth>,
}

impl Storage {
    pub(super) fn new(gpu: &Gpu, options: &ListOptions) -> Self {
        let texels = u64::from(options.max_texels);
        let node_count = if options.gather == Gather::Linked { u64::from(options.capacity) } else { 0 };
        let limits = gpu.device.limits();
        let max_bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let bytes = [
            texels * 4,
            u64::from(options.capacity) * FRAGMENT_BYTES,
            // The number of the levels' lists changes a little with the map's sides.
            (u64::from(options.list_count) * FRAGMENT_BYTES * 5 / 4).next_multiple_of(FRAGMENT_BYTES).min(max_bytes),
            8,
            node_count * FRAGMENT_BYTES,
            if options.gather == Gather::Linked { node_count * 4 } else { texels * 4 },
        ];
        let lease = Arc::new(Lease::new(&gpu.device, bytes.iter().sum::<u64>() + options.owners_bytes));
        // Rounded sizes, so that lights share buffers.
        let rounded = |bytes: u64| if lease.is_own() { bytes } else { bytes.next_power_of_two().min(max_bytes) };
        let buffer = |scratch, label, bytes: u64| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            let descriptor = wgpu::BufferDescriptor {
                label: Some(label),
                size: rounded(bytes).max(16),
                usage,
                mapped_at_creation: false,
            };
            lease.buffer(&gpu.device, scratch, &descriptor)
        };
        let no_depth = |sample_count| NoDepth::at_least(gpu, options.map_size, sample_count);
        let [cursors, fragments, lists, counters, nodes, links] = bytes;
        Self {
            options: *options,
            cursors: buffer(Scratch::ListCursors, "antumbra list cursors", cursors),
            fragments: buffer(Scratch::ListFragments, "antumbra fragments", fragments),
            lists: buffer(Scratch::Lists, "antumbra lists", lists),
            counters: buffer(Scratch::ListCounters, "antumbra list counters", counters),
            nodes: buffer(Scratch::LinkedFragments, "antumbra linked fragments", nodes),
            links: buffer(Scratch::Links, "antumbra links", links),
            no_depth: no_depth(1),
            no_covered_depth: (options.samples > 1).then(|| no_depth(options.samples)),
            lease,
        }
    }

    /// Records a copy of the scanned counts, where the lists begin, before the cursors move on.
    pub(super) fn record_begins(&self, recorder: &mut Recorder<'_>) {
        let UVec2 { x, y } = self.options.map_size;
        recorder.encoder().copy_buffer_to_buffer(&self.cursors, 0, &self.links, 0, u64::from(x * y) * 4);
    }

    /// Whether the buffers suit other options.
    pub(super) fn fits(&self, options: &ListOptions) -> bool {
        self.options.max_texels == options.max_texels
            && self.options.gather == options.gather
            && self.options.samples == options.samples
            && self.options.capacity == options.capacity
            && self.options.owners_bytes == options.owners_bytes
            && self.lists.size() >= u64::from(options.list_count) * FRAGMENT_BYTES
    }

    /// Enlarges the attachments to the size of the options' map.
    pub(super) fn widen(&mut self, gpu: &Gpu) {
        for no_depth in std::iter::once(&mut self.no_depth).chain(&mut self.no_covered_depth) {
            let needed = no_depth.size().max(self.options.map_size);
            if needed != no_depth.size() {
                *no_depth = NoDepth::at_least(gpu, needed, no_depth.sample_count());
            }
        }
    }
}
