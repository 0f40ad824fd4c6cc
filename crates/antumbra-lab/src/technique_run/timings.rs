//! Times of a technique: medians and percentiles over frames, per pass and in total.

use antumbra::PassTime;
use serde::{Deserialize, Serialize};

use crate::stopwatch::FrameCount;

/// Times of a pass over the timed frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassStatistics {
    /// Label of the pass.
    pub label: String,
    /// Median time, milliseconds.
    pub ms: f64,
    /// 10th percentile of the time, milliseconds.
    pub p10_ms: f64,
    /// 90th percentile of the time, milliseconds.
    pub p90_ms: f64,
}

/// Clock of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// GPU timestamps around every pass.
    GpuTimestamps,
    /// CPU clock from submission to completion, because the device has no timestamps.
    SubmitToDone,
    /// Device timestamps for passes, CPU clock for the frame. A software device may date the ends of passes late, so some passes take zero
    /// time and their sum is too small.
    SoftwareTimestamps,
}

/// Times of one technique.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timings {
    /// Passes in the order of recording; empty if the device has no timestamps.
    pub passes: Vec<PassStatistics>,
    /// Median time of a whole frame, milliseconds.
    pub total_ms: f64,
    /// 10th percentile of the frames' times, milliseconds.
    pub total_p10_ms: f64,
    /// 90th percentile of the frames' times, milliseconds.
    pub total_p90_ms: f64,
    /// Median CPU time for preparing and recording a frame, milliseconds.
    pub processor_ms: f64,
    /// Clock of the measurement.
    pub clock: Clock,
    /// Number of warm-up frames.
    pub warm_up: u32,
    /// Number of timed frames.
    pub frames: u32,
}

impl Timings {
    /// Returns the numbers of timed and warm-up frames.
    pub fn count(&self) -> FrameCount {
        FrameCount { frames: self.frames, warm_up: self.warm_up }
    }
}

/// Times of one frame.
pub(super) struct FrameTimes {
    pub(super) passes: Option<Vec<PassTime>>,
    pub(super) submit_to_done_ms: f64,
    /// CPU time for preparing and recording, milliseconds.
    pub(super) processor_ms: f64,
    /// Whether the frame created wgpu resources of the library.
    pub(super) has_made: bool,
}

pub(super) fn medians(frames: &[FrameTimes], warm_up: u32, is_software: bool) -> Timings {
    let submit_to_done = || frames.iter().map(|frame| frame.submit_to_done_ms).collect();
    let timed: Option<Vec<&Vec<PassTime>>> = frames.iter().map(|frame| frame.passes.as_ref()).collect();
    let (passes, totals, clock) = match timed {
        Some(timed) => {
            let labels = timed.first().map_or(&[][..], |passes| passes.as_slice());
            let passes = labels
                .iter()
                .map(|first| {
                    let same = timed.iter().flat_map(|passes| passes.iter()).filter(|pass| pass.label == first.label);
                    PassStatistics::of(first.label, same.map(|pass| pass.ms).collect())
                })
                .collect();
            let totals = timed.iter().map(|passes| passes.iter().map(|pass| pass.ms).sum()).collect();
            if is_software {
                (passes, submit_to_done(), Clock::SoftwareTimestamps)
            } else {
                (passes, totals, Clock::GpuTimestamps)
            }
        }
        None => (Vec::new(), submit_to_done(), Clock::SubmitToDone),
    };
    let totals = sorted(totals);
    let [total_ms, total_p10_ms, total_p90_ms] = [0.5, 0.1, 0.9].map(|fraction| percentile(&totals, fraction));
    let processor_ms = percentile(&sorted(frames.iter().map(|frame| frame.processor_ms).collect()), 0.5);
    let frames = frames.len() as u32;
    Timings { passes, total_ms, total_p10_ms, total_p90_ms, processor_ms, clock, warm_up, frames }
}

impl PassStatistics {
    fn of(label: &str, times_ms: Vec<f64>) -> Self {
        let times_ms = sorted(times_ms);
        let at = |fraction| percentile(&times_ms, fraction);
        Self { label: label.to_owned(), ms: at(0.5), p10_ms: at(0.1), p90_ms: at(0.9) }
    }
}

/// Returns the median of some values; 0 if empty.
pub(crate) fn median(values: Vec<f64>) -> f64 {
    percentile(&sorted(values), 0.5)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Returns the value at rank `fraction · (n − 1)` of sorted values, interpolated between its neighbours; 0 if empty.
fn percentile(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let rank = fraction * last as f64;
    let below = rank.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (rank - below as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_by_label() {
        let frame = |a, b| FrameTimes {
            passes: Some(vec![PassTime { label: "a", ms: a }, PassTime { label: "b", ms: b }]),
            submit_to_done_ms: 9.0,
            processor_ms: a,
            has_made: false,
        };
        let timings = medians(&[frame(1.0, 10.0), frame(3.0, 30.0), frame(2.0, 80.0)], 4, false);
        assert_eq!(timings.passes.iter().map(|pass| pass.ms).collect::<Vec<_>>(), [2.0, 30.0]);
        assert_eq!(
            (timings.total_ms, timings.processor_ms, timings.clock, timings.frames),
            (33.0, 2.0, Clock::GpuTimestamps, 3)
        );
    }

    #[test]
    fn a_software_device_s_frames_are_timed_whole() {
        let passes = Some(vec![PassTime { label: "a", ms: 1.0 }]);
        let frame = FrameTimes { passes, submit_to_done_ms: 9.0, processor_ms: 0.0, has_made: false };
        let timings = medians(&[frame], 1, true);
        assert_eq!((timings.passes[0].ms, timings.total_ms, timings.clock), (1.0, 9.0, Clock::SoftwareTimestamps));
    }

    #[test]
    fn percentiles_interpolate() {
        let pass = PassStatistics::of("a", (0..=10).rev().map(f64::from).collect());
        assert_eq!((pass.p10_ms, pass.ms, pass.p90_ms), (1.0, 5.0, 9.0));
        assert_eq!(percentile(&[1.0, 2.0], 0.5), 1.5);
    }

    #[test]
    fn without_timestamps_the_frame_counts() {
        let frame = |ms| FrameTimes { passes: None, submit_to_done_ms: ms, processor_ms: 0.0, has_made: false };
        let timings = medians(&[frame(4.0), frame(8.0)], 0, true);
        assert!(timings.passes.is_empty());
        assert_eq!((timings.total_ms, timings.clock), (6.0, Clock::SubmitToDone));
    }
}
