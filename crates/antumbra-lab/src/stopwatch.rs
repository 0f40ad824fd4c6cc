//! Choice of the frames to time: those after all compilation, allocation and resizing.
//!
//! Drivers compile when a pipeline is created, when it first runs, and again when a texture's format or a number changes. Techniques find
//! the size of their lists over some frames. No event marks the end of this, so it is detected from frame times. A frame counts once
//!
//! - it has created no wgpu resource of the library,
//! - it took about as long as the previous one ([`ALIKE`]),
//! - the requested number of frames preceded it, or those took all the available time, and
//! - the adapter has worked for long enough to raise its clock ([`clock_rise`]).
//!
//! A later frame that creates a resource restarts this. So the second frame is the first that can count, however long frames are; on a
//! graphics card, the first one after a frame that only rendered.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::limits::End;

/// Number of frames and time limits of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Minimum number of warm-up frames. At least one is drawn, and more until frame times have settled
    /// and a graphics card's clock has risen.
    pub warm_up: u32,
    /// Number of timed frames, if time permits.
    pub frames: u32,
    /// Minimum total time of the timed frames, for which short frames are repeated, because a scheduler takes milliseconds at a time.
    pub at_least: Duration,
    /// Total time of timed frames after which no further one is started; at least one is timed.
    pub at_most: Duration,
    /// Time after which no frame is started, timed or not.
    pub end: Option<End>,
}

/// Numbers of timed and warm-up frames of a median, printed with every time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameCount {
    /// Number of timed frames.
    pub frames: u32,
    /// Number of warm-up frames.
    pub warm_up: u32,
}

impl FrameCount {
    /// Returns the minimum of both numbers over some counts; `None` without counts.
    pub(crate) fn least(counts: impl IntoIterator<Item = Self>) -> Option<Self> {
        let fewer = |a: Self, b: Self| Self { frames: a.frames.min(b.frames), warm_up: a.warm_up.min(b.warm_up) };
        counts.into_iter().reduce(fewer)
    }
}

impl fmt::Display for FrameCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frames, warm_up } = self;
        match frames {
            1 => write!(f, "one frame after {warm_up}"),
            _ => write!(f, "median of {frames} frames after {warm_up}"),
        }
    }
}

/// Maximum ratio of the times of two consecutive frames that are alike. Compilation takes many times as long; the scheduler mostly takes
/// less than half of a frame of some milliseconds.
const ALIKE: f64 = 1.5;

/// Maximum number of warm-up frames beyond the requested ones and those in which a clock rises. On some machines frame times never settle.
const MAX_WARM_UP: u32 = 16;

/// Multiple of the clock's rise time after which frames count even if they create resources.
const ENDLESS: f64 = 20.0;

/// Maximum number of timed frames, unless more are requested.
const MAX_TIMED: u32 = 200;

/// Returns how long an adapter works before its times count. An idle graphics card runs at a fraction of its clock, and frames of a
/// millisecond end long before the clock rises: on an NVIDIA H200, five of them took four times as long after a pause as without one.
pub(crate) fn clock_rise(is_software: bool) -> Duration {
    Duration::from_millis(if is_software { 0 } else { 150 })
}

/// Measurement of one frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameMeasurement {
    /// Time from preparation to completion, on the CPU's clock, milliseconds.
    pub(crate) ms: f64,
    /// Whether the frame created pipelines, buffers, textures, views or bind groups.
    pub(crate) has_made: bool,
}

/// State that decides which frames count and when there are enough.
#[derive(Debug)]
pub(crate) struct Stopwatch {
    timing: Timing,
    clock_rise: Duration,
    before_ms: Option<f64>,
    /// Number of frames, and of those before the first that counts.
    seen: u32,
    warm_up: u32,
    is_warm: bool,
    warming_ms: f64,
    /// Time of warm-up frames that created nothing, because compilation does not load a graphics card.
    worked_ms: f64,
    timed_ms: f64,
}

impl Stopwatch {
    /// Creates the state for an adapter with the given rise time of its clock, see [`clock_rise`].
    pub(crate) fn new(timing: Timing, clock_rise: Duration) -> Self {
        let Timing { frames, .. } = timing;
        let timing = Timing { frames: frames.max(1), ..timing };
        Self {
            timing,
            clock_rise,
            before_ms: None,
            seen: 0,
            warm_up: 0,
            is_warm: false,
            warming_ms: 0.0,
            worked_ms: 0.0,
            timed_ms: 0.0,
        }
    }

    /// Adds a frame.
    pub(crate) fn see(&mut self, FrameMeasurement { ms, has_made }: FrameMeasurement) {
        let before_ms = self.before_ms.replace(ms);
        self.seen += 1;
        let ms_of = |duration: Duration| duration.as_secs_f64() * 1e3;
        let at_most_ms = ms_of(self.timing.at_most);
        let rise_ms = ms_of(self.clock_rise).min(at_most_ms);
        // Ends even if a technique creates a resource in every frame.
        let is_roused = self.worked_ms >= rise_ms || self.warming_ms >= ENDLESS * rise_ms;
        let is_last_chance = self.seen > self.timing.warm_up + MAX_WARM_UP && is_roused;
        if self.is_warm && has_made && !is_last_chance {
            // The frames timed so far were not representative.
            (self.is_warm, self.timed_ms, self.worked_ms) = (false, 0.0, 0.0);
        }
        if !self.is_warm {
            let is_long_enough = self.seen > self.timing.warm_up || self.warming_ms >= at_most_ms;
            let is_alike = before_ms.is_some_and(|before_ms| are_alike(before_ms, ms));
            self.is_warm = (is_alike && !has_made && is_long_enough && is_roused) || is_last_chance;
            self.warm_up = self.seen - u32::from(self.is_warm);
            // The first frame includes driver compilation, so its time is not counted.
            let counts_ms = if before_ms.is_some() { ms } else { 0.0 };
            self.warming_ms += counts_ms;
            self.worked_ms += if has_made { 0.0 } else { counts_ms };
        }
        if self.is_warm {
            self.timed_ms += ms;
        }
    }

    /// Restarts, because the previous frames had other work.
    pub(crate) fn begin_anew(&mut self) {
        *self = Self::new(self.timing, self.clock_rise);
    }

    /// Returns whether enough frames are timed.
    pub(crate) fn is_done(&self) -> bool {
        let timed = self.seen - self.warm_up;
        let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
        let is_over = self.timed_ms >= ms(self.timing.at_most);
        let is_enough =
            timed >= self.timing.frames && (self.timed_ms >= ms(self.timing.at_least) || timed >= MAX_TIMED);
        self.is_warm && (is_enough || is_over)
    }

    /// Returns whether the end time has passed, with or without enough frames.
    pub(crate) fn is_over(&self) -> bool {
        self.timing.end.is_some_and(|end| end.is_past())
    }

    /// Returns whether at least one frame counts.
    pub(crate) fn has_timed(&self) -> bool {
        self.seen > self.warm_up
    }

    /// Returns whether the end time passed before there were enough frames.
    pub(crate) fn is_cut_short(&self) -> bool {
        !self.is_done() && self.is_over()
    }

    /// Returns the number of frames before the first that counts.
    pub(crate) fn warm_up(&self) -> u32 {
        self.warm_up
    }
}

fn are_alike(a_ms: f64, b_ms: f64) -> bool {
    a_ms.max(b_ms) <= ALIKE * a_ms.min(b_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMING: Timing =
        Timing { warm_up: 1, frames: 3, at_least: Duration::ZERO, at_most: Duration::from_secs(3), end: None };

    /// Adds frames until done. Returns the number of warm-up frames and the frames that count. Negative
    /// numbers are frames that create resources.
    fn counted(timing: Timing, frames_ms: &[f64]) -> (u32, Vec<f64>) {
        let mut watch = Stopwatch::new(timing, Duration::ZERO);
        for (i, ms) in frames_ms.iter().enumerate() {
            watch.see(FrameMeasurement { ms: ms.abs(), has_made: *ms < 0.0 });
            if watch.is_done() {
                let warm_up = watch.warm_up() as usize;
                return (watch.warm_up(), frames_ms[warm_up..=i].to_vec());
            }
        }
        panic!("{frames_ms:?}: it is not done");
    }

    #[test]
    fn what_compiles_does_not_count() {
        assert_eq!(counted(TIMING, &[-30_907.0, 24.0, 25.0, 23.0, 24.0]), (2, vec![25.0, 23.0, 24.0]));
        // Pipelines run first, and are compiled, over several frames.
        assert_eq!(counted(TIMING, &[-900.0, -400.0, 80.0, 20.0, 21.0, 20.0, 22.0]), (4, vec![21.0, 20.0, 22.0]));
        // Two compiling frames may take equally long, and create resources.
        assert_eq!(counted(TIMING, &[-900.0, -900.0, 20.0, 20.0, 20.0, 20.0]), (3, vec![20.0; 3]));
        // Everything was compiled before.
        assert_eq!(counted(TIMING, &[-26.0, 24.0, 24.0, 24.0]), (1, vec![24.0; 3]));
    }

    #[test]
    fn what_is_found_later_begins_anew() {
        let (warm_up, timed) = counted(TIMING, &[-25.0, 24.0, 24.0, -500.0, 30.0, 31.0, 30.0, 31.0]);
        assert_eq!((warm_up, timed), (5, vec![31.0, 30.0, 31.0]));
    }

    /// Even if frames are long, a second one is drawn and suffices.
    #[test]
    fn long_frames_are_two() {
        assert_eq!(counted(TIMING, &[-41_000.0, 40_000.0]), (1, vec![40_000.0]));
        assert_eq!(counted(Timing { warm_up: 3, ..TIMING }, &[-5_000.0, 4_000.0, 4_000.0]), (2, vec![4_000.0]));
        let no_time = Timing { at_most: Duration::ZERO, ..TIMING };
        assert_eq!(counted(no_time, &[-9.0, 3.0, 3.0]), (2, vec![3.0]));
    }

    #[test]
    fn short_frames_are_timed_more_often() {
        let timing = Timing { at_least: Duration::from_millis(100), ..TIMING };
        assert_eq!(counted(timing, &[10.0; 20]), (1, vec![10.0; 10]));
        assert_eq!(counted(timing, &[90.0; 20]), (1, vec![90.0; 3]));
        assert_eq!(counted(timing, &[1e-3; 300]).1.len(), 200);
        assert_eq!(counted(Timing { frames: 250, ..timing }, &[1e-3; 300]).1.len(), 250);
    }

    /// Frames of a graphics card that are alike at a low clock do not count.
    #[test]
    fn warm_up_waits_for_the_clock_to_rise() {
        let mut watch = Stopwatch::new(TIMING, Duration::from_millis(100));
        let mut frames = 0;
        while !watch.is_done() {
            watch.see(FrameMeasurement { ms: if frames < 10 { 8.0 } else { 2.0 }, has_made: frames == 0 });
            frames += 1;
        }
        // Nine of 8 ms after the first, and fourteen of 2 ms.
        assert_eq!((watch.warm_up(), frames), (24, 27));
        let mut short_of_time = Stopwatch::new(Timing { at_most: Duration::ZERO, ..TIMING }, Duration::from_secs(1));
        (0..3).for_each(|_| short_of_time.see(FrameMeasurement { ms: 2.0, has_made: false }));
        assert!(short_of_time.is_done(), "where there is no time, it is not waited for");
    }

    #[test]
    fn as_many_warm_up_as_are_asked_for() {
        assert_eq!(counted(Timing { warm_up: 3, frames: 1, ..TIMING }, &[5.0; 4]), (3, vec![5.0]));
        assert_eq!(counted(Timing { warm_up: 0, frames: 2, ..TIMING }, &[5.0; 3]), (1, vec![5.0; 2]));
        assert_eq!(counted(Timing { frames: 0, ..TIMING }, &[5.0; 3]), (1, vec![5.0]), "one is always timed");
    }

    /// The measurement ends even if no two frames are alike, or if every frame creates a resource.
    #[test]
    fn warm_up_ends_for_unstable_frames() {
        let frames: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 10.0 } else { 30.0 }).collect();
        assert_eq!(counted(TIMING, &frames), (17, vec![30.0, 10.0, 30.0]));
        assert_eq!(counted(TIMING, &[-10.0; 30]), (17, vec![-10.0; 3]));
    }

    #[test]
    fn frames_with_overflow_are_discarded() {
        let mut watch = Stopwatch::new(TIMING, Duration::ZERO);
        (0..2).for_each(|_| watch.see(FrameMeasurement { ms: 5.0, has_made: false }));
        watch.begin_anew();
        assert_eq!((watch.warm_up(), watch.is_done()), (0, false));
        (0..4).for_each(|_| watch.see(FrameMeasurement { ms: 9.0, has_made: false }));
        assert_eq!((watch.warm_up(), watch.is_done()), (1, true));
    }
}
