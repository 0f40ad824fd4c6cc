//! Times of a side's frames: every pass on the GPU, and the CPU.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use antumbra::{Gpu, PassTime, PassTimer};

/// Maximum number of frames in medians and in the graph.
pub const FRAMES: usize = 120;

/// One frame's times, milliseconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameTimes {
    /// GPU time by pass, in recording order; empty if the device has no timestamps.
    pub passes: Vec<PassTime>,
    /// CPU time of preparing and recording.
    pub processor_ms: f64,
    /// Whether the frame created wgpu resources: pipelines to compile, maps of another size.
    pub has_made: bool,
}

impl FrameTimes {
    /// Sum over passes.
    pub fn gpu_ms(&self) -> f64 {
        self.passes.iter().map(|pass| pass.ms).sum()
    }
}

/// Number of warm-up frames after one that created resources: drivers compile a pipeline at its first use.
const WARM_UP: u32 = 1;

/// Times of the last frames of one technique with one set of parameters.
#[derive(Debug, Default)]
pub struct Times {
    frames: VecDeque<FrameTimes>,
    /// Number of earlier frames that do not count.
    warm_up: u32,
    /// Number of remaining warm-up frames.
    cold: u32,
}

impl Times {
    /// Adds a frame's times. A frame that created resources discards the earlier frames, which had another technique, size
    /// or scene; it and the warm-up frames after it do not count.
    pub fn push(&mut self, frame: FrameTimes) {
        if frame.has_made {
            self.clear();
            self.cold = 1 + WARM_UP;
        }
        if self.cold > 0 {
            self.cold -= 1;
            self.warm_up += 1;
            return;
        }
        if self.frames.len() == FRAMES {
            self.frames.pop_front();
        }
        self.frames.push_back(frame);
    }

    /// Discards all frames.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Number of frames in the medians, and number of earlier frames that do not count.
    pub fn counts(&self) -> (usize, u32) {
        (self.frames.len(), self.warm_up)
    }

    /// Last frames, oldest first.
    pub fn frames(&self) -> impl Iterator<Item = &FrameTimes> {
        self.frames.iter()
    }

    /// Median of a number over the frames; `None` without frames.
    pub fn median(&self, number: impl Fn(&FrameTimes) -> f64) -> Option<f64> {
        let mut values: Vec<f64> = self.frames.iter().map(number).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    }

    /// Median time of each pass of the newest frame, milliseconds.
    pub fn pass_medians(&self) -> Vec<(&'static str, f64)> {
        let labels = self.frames.back().map_or(&[][..], |frame| frame.passes.as_slice());
        let of = |frame: &FrameTimes, label| frame.passes.iter().find(|p| p.label == label).map_or(0.0, |p| p.ms);
        labels.iter().map(|p| (p.label, self.median(|frame| of(frame, p.label)).unwrap_or(0.0))).collect()
    }
}

/// Measures one frame at a time; frames in between are not measured.
#[derive(Debug)]
pub struct FrameClock {
    timer: Option<PassTimer>,
    pending: Option<(FrameTimes, Arc<AtomicU8>)>,
}

const WAITING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

impl FrameClock {
    /// Creates a clock; it measures only CPU time if the device has no timestamps.
    pub fn new(gpu: &Gpu) -> Self {
        Self { timer: PassTimer::new(gpu), pending: None }
    }

    /// The timer to record with; `None` while a frame's times are in flight.
    pub fn timer(&mut self) -> Option<&mut PassTimer> {
        if self.pending.is_some() { None } else { self.timer.as_mut() }
    }

    /// Whether a frame's times are in flight.
    pub fn is_busy(&self) -> bool {
        self.pending.is_some()
    }

    /// Records the readback of the pass times that complete `frame`, after it was recorded with [`timer`](Self::timer).
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, frame: FrameTimes) {
        let Some(timer) = self.timer.as_ref().filter(|_| self.pending.is_none()) else { return };
        let bytes = timer.readback_bytes();
        if bytes == 0 {
            return;
        }
        timer.resolve(encoder);
        let outcome = Arc::new(AtomicU8::new(WAITING));
        let told = outcome.clone();
        encoder.map_buffer_on_submit(timer.readback(), wgpu::MapMode::Read, ..bytes, move |result| {
            told.store(if result.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
        });
        self.pending = Some((frame, outcome));
    }

    /// Returns the measured frame once its times are read back.
    pub fn take(&mut self) -> Option<FrameTimes> {
        let outcome = self.pending.as_ref()?.1.load(Ordering::Acquire);
        if outcome == WAITING {
            return None;
        }
        let (frame, _) = self.pending.take()?;
        let timer = self.timer.as_ref()?;
        if outcome == FAILED {
            return None;
        }
        let buffer = timer.readback();
        let passes = buffer.get_mapped_range(..timer.readback_bytes()).map(|mapped| timer.read(&mapped)).ok()?;
        buffer.unmap();
        Some(FrameTimes { passes, ..frame })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_over_the_last_frames() {
        let mut times = Times::default();
        assert_eq!(times.median(FrameTimes::gpu_ms), None);
        for i in 0..2 * FRAMES {
            let ms = if i < FRAMES { 100.0 } else { (i % 3) as f64 };
            let passes = vec![PassTime { label: "a", ms }];
            times.push(FrameTimes { passes, processor_ms: 2.0 * ms, has_made: false });
        }
        assert_eq!(times.frames().count(), FRAMES);
        assert_eq!(times.median(FrameTimes::gpu_ms), Some(1.0));
        assert_eq!(times.pass_medians(), [("a", 1.0)]);
    }

    /// Frames that create resources, and those before them, are in no median.
    #[test]
    fn frames_that_create_resources_are_not_timed() {
        let mut times = Times::default();
        let frame = |processor_ms, has_made| FrameTimes { passes: Vec::new(), processor_ms, has_made };
        let median = |times: &Times| times.median(|frame| frame.processor_ms);
        times.push(frame(3.0, false));
        times.push(frame(30_000.0, true));
        times.push(frame(900.0, false));
        assert_eq!((median(&times), times.counts()), (None, (0, 2)));
        (0..3).for_each(|_| times.push(frame(5.0, false)));
        assert_eq!((median(&times), times.counts()), (Some(5.0), (3, 2)));
        times.push(frame(400.0, true));
        times.push(frame(300.0, true));
        times.push(frame(9.0, false));
        times.push(frame(8.0, false));
        assert_eq!((median(&times), times.counts()), (Some(8.0), (1, 2)));
    }
}
