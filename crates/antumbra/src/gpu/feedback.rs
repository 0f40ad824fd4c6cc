//! Feedback counters written by shaders: copied to mappable memory, and read in a later frame once they have arrived.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use super::{Gpu, Recorder};

/// Reads back a few numbers without waiting.
///
/// [`record`](Self::record) copies the numbers of a frame; [`collect`](Self::collect) returns them in a later frame.
/// Frames recorded while no slot is free are not read back.
#[derive(Debug)]
pub(crate) struct Feedback {
    slots: Vec<Slot>,
    bytes: u64,
    /// Whether the last recorded frame found no free slot.
    is_missing: AtomicBool,
}

#[derive(Debug)]
struct Slot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

/// Number of slots: frames that may be in flight at once.
const SLOTS: usize = 3;

// States of a slot, in order.
const FREE: u8 = 0;
const UNDER_WAY: u8 = 1;
const ARRIVED: u8 = 2;

/// Guard that frees a slot if its commands are dropped or its buffer cannot be mapped.
struct SlotGuard(Arc<AtomicU8>);

impl Drop for SlotGuard {
    fn drop(&mut self) {
        let _ = self.0.compare_exchange(UNDER_WAY, FREE, Ordering::AcqRel, Ordering::Acquire);
    }
}

impl Feedback {
    /// Creates slots for `count` numbers.
    pub(crate) fn new(gpu: &Gpu, count: u32) -> Self {
        let bytes = u64::from(count) * 4;
        let slot = || Slot {
            buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra feedback"),
                size: bytes,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
            state: Arc::new(AtomicU8::new(FREE)),
        };
        Self { slots: (0..SLOTS).map(|_| slot()).collect(), bytes, is_missing: AtomicBool::new(false) }
    }

    /// Copies the first numbers of `source`, a buffer with usage `COPY_SRC`. They are mapped once the host has
    /// submitted the commands.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, source: &wgpu::Buffer) {
        let free =
            |slot: &&Slot| slot.state.compare_exchange(FREE, UNDER_WAY, Ordering::AcqRel, Ordering::Acquire).is_ok();
        let slot = self.slots.iter().find(free);
        self.is_missing.store(slot.is_none(), Ordering::Release);
        let Some(slot) = slot else { return };
        let under_way = SlotGuard(Arc::clone(&slot.state));
        recorder.read_back(source, &slot.buffer, self.bytes, move |result| {
            if result.is_ok() {
                under_way.0.store(ARRIVED, Ordering::Release);
            }
        });
    }

    /// Returns the newest numbers that arrived since the last call, or `None`; older ones are discarded.
    pub(crate) fn collect(&self, gpu: &Gpu) -> Option<Vec<u32>> {
        // Never waits. A lost device is reported where the host submits.
        let _ = gpu.device().poll(wgpu::PollType::Poll);
        let mut newest = None;
        for slot in self.slots.iter().filter(|slot| slot.state.load(Ordering::Acquire) == ARRIVED) {
            if let Ok(mapped) = slot.buffer.get_mapped_range(..) {
                newest = Some(bytemuck::pod_collect_to_vec(&mapped));
            }
            slot.buffer.unmap();
            slot.state.store(FREE, Ordering::Release);
        }
        newest
    }

    /// Whether the last recorded frame was not read back because no slot was free.
    pub(crate) fn is_missing(&self) -> bool {
        self.is_missing.load(Ordering::Acquire)
    }

    /// Whether numbers of a recorded frame are missing or still to be read.
    pub(crate) fn is_awaited(&self) -> bool {
        self.is_missing() || self.slots.iter().any(|slot| slot.state.load(Ordering::Acquire) != FREE)
    }

    /// Memory of the slots, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.bytes * SLOTS as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gpu;

    #[test]
    fn numbers_arrive_in_a_later_frame() {
        let Some(gpu) = gpu() else { return };
        let source = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test counters"),
            size: 8,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let feedback = Feedback::new(gpu, 2);
        assert_eq!(feedback.collect(gpu), None);
        for frame in 0..8_u32 {
            gpu.queue.write_buffer(&source, 0, bytemuck::cast_slice(&[frame, 7 * frame]));
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            feedback.record(&mut Recorder::new(&mut encoder, None), &source);
            gpu.queue.submit([encoder.finish()]);
            gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
            assert_eq!(feedback.collect(gpu), Some(vec![frame, 7 * frame]));
            assert_eq!(feedback.collect(gpu), None, "read once");
        }
    }

    #[test]
    fn frames_beyond_the_slots_leave_nothing() {
        let Some(gpu) = gpu() else { return };
        let source = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test counters"),
            size: 4,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let feedback = Feedback::new(gpu, 1);
        for frame in 1..=5_u32 {
            gpu.queue.write_buffer(&source, 0, bytemuck::bytes_of(&frame));
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            feedback.record(&mut Recorder::new(&mut encoder, None), &source);
            gpu.queue.submit([encoder.finish()]);
        }
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
        assert_eq!(feedback.collect(gpu), Some(vec![SLOTS as u32]));
    }
}
