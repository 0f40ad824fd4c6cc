//! Buffers that many meshes share: ranges of items that are allocated and freed, but never moved.

use std::ops::Range;

use range_alloc::RangeAllocator;

use crate::gpu::Gpu;

/// Allocator of ranges of items, each with data in one or several buffers.
#[derive(Debug)]
pub(super) struct Arena {
    usage: wgpu::BufferUsages,
    ranges: RangeAllocator<u64>,
    columns: Vec<Column>,
}

/// Buffer with one kind of data for every item.
#[derive(Debug)]
struct Column {
    label: &'static str,
    item_bytes: u64,
    buffer: Option<wgpu::Buffer>,
}

/// Minimum number of items of a buffer.
const MIN_ITEMS: u64 = 1024;

impl Arena {
    /// Creates an arena with one buffer per label, without allocating them yet. The second values are bytes per item.
    pub(super) fn new(columns: &[(&'static str, u64)], usage: wgpu::BufferUsages) -> Self {
        let usage = usage | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let column =
            |(label, item_bytes): &(&'static str, u64)| Column { label, item_bytes: *item_bytes, buffer: None };
        let columns = columns.iter().map(column).collect();
        Self { usage, ranges: RangeAllocator::new(0..MIN_ITEMS), columns }
    }

    /// Allocates a range of `count` items. If the arena must grow, no buffer exceeds `max_bytes`. Returns the number
    /// of bytes needed as the error.
    pub(super) fn take(&mut self, count: u64, max_bytes: u64) -> Result<Range<u32>, u64> {
        let item_bytes = self.columns.iter().map(|column| column.item_bytes).max().unwrap_or(1);
        loop {
            if let Ok(range) = self.ranges.allocate_range(count.max(1)) {
                return Ok(range.start as u32..range.start as u32 + count as u32);
            }
            let held = self.ranges.initial_range().end;
            let max_items = max_bytes / item_bytes;
            let wanted = (held + count).next_power_of_two().min(max_items);
            if wanted <= held {
                return Err((held + count) * item_bytes);
            }
            self.ranges.grow_to(wanted);
        }
    }

    /// Frees a range.
    pub(super) fn give_back(&mut self, range: &Range<u32>) {
        let start = u64::from(range.start);
        self.ranges.free_range(start..start + u64::from(range.end - range.start).max(1));
    }

    /// Resizes the buffers to the size of the arena; `encoder` copies their content.
    pub(super) fn grow(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        let items = self.ranges.initial_range().end;
        for Column { label, item_bytes, buffer } in &mut self.columns {
            let bytes = items * *item_bytes;
            if buffer.as_ref().is_some_and(|buffer| buffer.size() == bytes) {
                continue;
            }
            let larger = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: self.usage,
                mapped_at_creation: false,
            });
            if let Some(buffer) = buffer.replace(larger.clone()) {
                encoder.copy_buffer_to_buffer(&buffer, 0, &larger, 0, buffer.size());
            }
        }
    }

    /// First buffer; `None` before [`grow`](Self::grow).
    pub(super) fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.column(0)
    }

    /// Buffer of a column; `None` before [`grow`](Self::grow), or if there are fewer columns.
    pub(super) fn column(&self, index: usize) -> Option<&wgpu::Buffer> {
        self.columns.get(index)?.buffer.as_ref()
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.columns.iter().filter_map(|column| column.buffer.as_ref()).map(wgpu::Buffer::size).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_apart_and_come_back() {
        let mut arena = Arena::new(&[("test", 4)], wgpu::BufferUsages::empty());
        let max_bytes = 4 * 4096;
        let a = arena.take(1000, max_bytes).expect("room");
        let b = arena.take(2000, max_bytes).expect("the arena has grown");
        assert!(a.end <= b.start || b.end <= a.start, "{a:?} {b:?}");
        assert_eq!(arena.take(4000, max_bytes), Err(4 * (4096 + 4000)));
        arena.give_back(&b);
        assert!(arena.take(3000, max_bytes).is_ok(), "a freed range is reused");
    }

    #[test]
    fn empty_ranges_are_allocated_and_freed() {
        let mut arena = Arena::new(&[("test", 4)], wgpu::BufferUsages::empty());
        let none = arena.take(0, 4096).expect("room");
        assert!(none.is_empty());
        arena.give_back(&none);
    }
}
