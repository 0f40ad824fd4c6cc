//! Choice of the frames to time: those after which nothing new is compiled, created or found.
//!
//! Drivers compile when a program is made, when it first runs, and once more where a texture's format or a number is another one;
//! techniques find the room for their lists over some frames. None of that tells when it is over, so that it is seen by what frames
//! take: a frame counts once
//!
//! - it has made no object of the library's,
//! - it took about as long as the one before it ([`ALIKE`]),
//! - as many frames as asked for came before it, or those took all the time that there is, and
//! - the processor that draws them has been at work for long enough to have raised its clock ([`clock_rise`]).
//!
//! A frame that makes an object later begins all of it anew. So the second frame is the first that can count, however long frames are;
//! on a graphics card the first that follows one that only drew.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::limits::End;

/// How long and how often to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Frames before the timed ones, at least; one is always drawn, and as many more as it takes until frames are alike and a graphics card's
    /// clock has risen.
    pub warm_up: u32,
    /// Timed frames, where there is time.
    pub frames: u32,
    /// Short ones are timed more often, until they took this long together: a scheduler takes away milliseconds at a time.
    pub at_least: Duration,
    /// Once timed frames took this long together, no further one is begun; one is always timed.
    pub at_most: Duration,
    /// No frame is begun after it, be one timed or not.
    pub end: Option<End>,
}

/// How many frames a time is the median of, and after how many: what stands beside every time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameCount {
    /// Timed frames.
    pub frames: u32,
    /// Frames before them.
    pub warm_up: u32,
}

impl FrameCount {
    /// The fewest frames, and the fewest before them, of some counts; `None` of none.
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

/// Two frames after one another are alike where one takes at most so many times as long as the other. What compiles takes many
/// times as long; what the scheduler takes away from a frame of some milliseconds is less than half of it, but now and then.
const ALIKE: f64 = 1.5;

/// Beyond those that are asked for, and those in which a clock rises, no more frames are drawn to warm up: some machine's frames are never
/// alike.
const MOST_WARM_UP: u32 = 16;

/// After so many times as long as a clock takes to rise, frames count though they make something.
const ENDLESS: f64 = 20.0;

/// However short frames are, no more are timed than this or what is asked for.
const MOST_TIMED: u32 = 200;

/// How long an adapter works before its times count. A graphics card that waited runs at a fraction of its clock, and frames of a
/// millisecond are over long before it has noticed that there is work: on an NVIDIA H200 five of them took four times as long after
/// a pause as without.
pub(crate) fn clock_rise(is_software: bool) -> Duration {
    Duration::from_millis(if is_software { 0 } else { 150 })
}

/// What a frame took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// From its preparation to its completion, by the processor's clock, milliseconds.
    pub(crate) ms: f64,
    /// It made programs, buffers, textures, views or bind groups.
    pub(crate) has_made: bool,
}

/// Watches frames go by and says when there are enough.
#[derive(Debug)]
pub(crate) struct Stopwatch {
    timing: Timing,
    clock_rise: Duration,
    before_ms: Option<f64>,
    /// Frames that were seen, and of those the ones before the first that counts.
    seen: u32,
    warm_up: u32,
    is_warm: bool,
    warming_ms: f64,
    /// Of that, frames that made nothing: a driver that compiles keeps no graphics card at work.
    worked_ms: f64,
    timed_ms: f64,
}

impl Stopwatch {
    /// On an adapter that works for so long before its times count: see [`clock_rise`].
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

    /// Takes a frame in.
    pub(crate) fn see(&mut self, Seen { ms, has_made }: Seen) {
        let before_ms = self.before_ms.replace(ms);
        self.seen += 1;
        let ms_of = |duration: Duration| duration.as_secs_f64() * 1e3;
        let at_most_ms = ms_of(self.timing.at_most);
        let rise_ms = ms_of(self.clock_rise).min(at_most_ms);
        // A technique that makes something in every frame ends, too.
        let is_roused = self.worked_ms >= rise_ms || self.warming_ms >= ENDLESS * rise_ms;
        let is_last_chance = self.seen > self.timing.warm_up + MOST_WARM_UP && is_roused;
        if self.is_warm && has_made && !is_last_chance {
            // What had been timed was not the whole of it.
            (self.is_warm, self.timed_ms, self.worked_ms) = (false, 0.0, 0.0);
        }
        if !self.is_warm {
            let is_long_enough = self.seen > self.timing.warm_up || self.warming_ms >= at_most_ms;
            let is_alike = before_ms.is_some_and(|before_ms| are_alike(before_ms, ms));
            self.is_warm = (is_alike && !has_made && is_long_enough && is_roused) || is_last_chance;
            self.warm_up = self.seen - u32::from(self.is_warm);
            // The first is of the driver's compiler, and tells nothing of how long frames are.
            let counts_ms = if before_ms.is_some() { ms } else { 0.0 };
            self.warming_ms += counts_ms;
            self.worked_ms += if has_made { 0.0 } else { counts_ms };
        }
        if self.is_warm {
            self.timed_ms += ms;
        }
    }

    /// Forgets what it has seen: it was of something else.
    pub(crate) fn begin_anew(&mut self) {
        *self = Self::new(self.timing, self.clock_rise);
    }

    /// Whether there are enough.
    pub(crate) fn is_done(&self) -> bool {
        let timed = self.seen - self.warm_up;
        let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
        let is_over = self.timed_ms >= ms(self.timing.at_most);
        let is_enough =
            timed >= self.timing.frames && (self.timed_ms >= ms(self.timing.at_least) || timed >= MOST_TIMED);
        self.is_warm && (is_enough || is_over)
    }

    /// Whether the end has come, be there enough or not.
    pub(crate) fn is_over(&self) -> bool {
        self.timing.end.is_some_and(|end| end.is_past())
    }

    /// Whether a frame counts.
    pub(crate) fn has_timed(&self) -> bool {
        self.seen > self.warm_up
    }

    /// Whether the end came before there was enough.
    pub(crate) fn is_cut_short(&self) -> bool {
        !self.is_done() && self.is_over()
    }

    /// Frames before the first that counts.
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

    /// Frames until it is done: how many warmed up, and which count. A negative number is a frame that makes something.
    fn counted(timing: Timing, frames_ms: &[f64]) -> (u32, Vec<f64>) {
        let mut watch = Stopwatch::new(timing, Duration::ZERO);
        for (i, ms) in frames_ms.iter().enumerate() {
            watch.see(Seen { ms: ms.abs(), has_made: *ms < 0.0 });
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
        // Programs run first, and are compiled, over several frames.
        assert_eq!(counted(TIMING, &[-900.0, -400.0, 80.0, 20.0, 21.0, 20.0, 22.0]), (4, vec![21.0, 20.0, 22.0]));
        // Two that compile may take alike, and make something.
        assert_eq!(counted(TIMING, &[-900.0, -900.0, 20.0, 20.0, 20.0, 20.0]), (3, vec![20.0; 3]));
        // What has been compiled before.
        assert_eq!(counted(TIMING, &[-26.0, 24.0, 24.0, 24.0]), (1, vec![24.0; 3]));
    }

    #[test]
    fn what_is_found_later_begins_anew() {
        let (warm_up, timed) = counted(TIMING, &[-25.0, 24.0, 24.0, -500.0, 30.0, 31.0, 30.0, 31.0]);
        assert_eq!((warm_up, timed), (5, vec![31.0, 30.0, 31.0]));
    }

    /// However long a frame is, a second one is drawn, and is enough.
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
    fn a_clock_has_time_to_rise() {
        let mut watch = Stopwatch::new(TIMING, Duration::from_millis(100));
        let mut frames = 0;
        while !watch.is_done() {
            watch.see(Seen { ms: if frames < 10 { 8.0 } else { 2.0 }, has_made: frames == 0 });
            frames += 1;
        }
        // Nine of 8 ms after the first, fourteen of 2.
        assert_eq!((watch.warm_up(), frames), (24, 27));
        let mut short_of_time = Stopwatch::new(Timing { at_most: Duration::ZERO, ..TIMING }, Duration::from_secs(1));
        (0..3).for_each(|_| short_of_time.see(Seen { ms: 2.0, has_made: false }));
        assert!(short_of_time.is_done(), "where there is no time, it is not waited for");
    }

    #[test]
    fn as_many_warm_up_as_are_asked_for() {
        assert_eq!(counted(Timing { warm_up: 3, frames: 1, ..TIMING }, &[5.0; 4]), (3, vec![5.0]));
        assert_eq!(counted(Timing { warm_up: 0, frames: 2, ..TIMING }, &[5.0; 3]), (1, vec![5.0; 2]));
        assert_eq!(counted(Timing { frames: 0, ..TIMING }, &[5.0; 3]), (1, vec![5.0]), "one is always timed");
    }

    /// A machine on which no two frames are alike, or a technique that makes something in each, ends too.
    #[test]
    fn it_ends() {
        let frames: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 10.0 } else { 30.0 }).collect();
        assert_eq!(counted(TIMING, &frames), (17, vec![30.0, 10.0, 30.0]));
        assert_eq!(counted(TIMING, &[-10.0; 30]), (17, vec![-10.0; 3]));
    }

    #[test]
    fn what_lacked_room_is_forgotten() {
        let mut watch = Stopwatch::new(TIMING, Duration::ZERO);
        (0..2).for_each(|_| watch.see(Seen { ms: 5.0, has_made: false }));
        watch.begin_anew();
        assert_eq!((watch.warm_up(), watch.is_done()), (0, false));
        (0..4).for_each(|_| watch.see(Seen { ms: 9.0, has_made: false }));
        assert_eq!((watch.warm_up(), watch.is_done()), (1, true));
    }
}
