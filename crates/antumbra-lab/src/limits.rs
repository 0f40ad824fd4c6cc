//! Time limits of a run of measurements, shared by `bench`, `compare` and `reproduce`: the run's deadline, and the limit per technique.
//!
//! A measurement starts only if it is expected to end in time. Its expected time is that of the same technique earlier in this run, scaled
//! by the number of pixels if there are more; for a technique that was not measured yet, the median of all. A frame cannot be interrupted,
//! so a measurement stops after the frame during which its time ends.

use std::time::{Duration, Instant};

use crate::error::LabError;

/// Time limits of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Deadline of the run; `None` runs until everything is measured.
    pub deadline: Option<Instant>,
    /// Time limit of one measurement of a technique.
    pub technique: Option<Duration>,
}

/// End time of a measurement, with or without a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Time after which no frame is started.
    pub at: Instant,
    /// Limit of the technique if it ends the measurement; `None` if the run's deadline does.
    pub limit: Option<Duration>,
}

impl End {
    /// Returns whether the time has passed.
    pub fn is_past(&self) -> bool {
        Instant::now() >= self.at
    }
}

/// A planned measurement: technique and number of pixels, from which its time is estimated.
#[derive(Clone, Copy, Debug)]
pub struct Planned<'a> {
    /// Name of the technique.
    pub technique: &'a str,
    /// Number of pixels of the image.
    pub pixels: u64,
}

impl<'a> Planned<'a> {
    /// Creates the plan of a technique at an image size.
    pub fn new(technique: &'a str, size_px: glam::UVec2) -> Self {
        Self { technique, pixels: u64::from(size_px.x) * u64::from(size_px.y) }
    }
}

/// A completed measurement.
#[derive(Clone, Debug)]
struct CompletedMeasurement {
    technique: String,
    pixels: u64,
    seconds: f64,
}

impl CompletedMeasurement {
    /// Returns the estimated time at another number of pixels. Fewer pixels take as long, because of compilation and casters.
    fn expected_s(&self, pixels: u64) -> f64 {
        self.seconds * (pixels as f64 / self.pixels.max(1) as f64).max(1.0)
    }
}

/// Limits of a run and the times of its measurements.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    limits: Limits,
    spent: Vec<CompletedMeasurement>,
}

impl Pace {
    /// Creates the state of a new run.
    pub fn new(limits: Limits) -> Self {
        Self { limits, spent: Vec::new() }
    }

    /// Records the time of a measurement, of this run or of the one that it resumes.
    pub fn took(&mut self, planned: Planned<'_>, seconds: f64) {
        let Planned { technique, pixels } = planned;
        self.spent.push(CompletedMeasurement { technique: technique.to_owned(), pixels, seconds });
    }

    /// Makes a measurement and records its time. `None` if it is not expected to end before the deadline, or did not.
    ///
    /// # Errors
    /// Those of the measurement, except the deadline's.
    pub fn measure<T>(
        &mut self,
        planned: Planned<'_>,
        measurement: impl FnOnce(Option<End>) -> Result<T, LabError>,
    ) -> Result<Option<T>, LabError> {
        if !self.may_begin(planned) {
            return Ok(None);
        }
        let began = Instant::now();
        let outcome = measurement(self.end_of(began));
        match outcome {
            Err(error) if error.is_deadline() => Ok(None),
            outcome => {
                self.took(planned, began.elapsed().as_secs_f64());
                outcome.map(Some)
            }
        }
    }

    /// Returns the remaining time of the run; `None` without a deadline.
    pub fn left(&self) -> Option<Duration> {
        self.limits.deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()))
    }

    /// Returns whether a measurement is expected to end in time.
    pub fn may_begin(&self, planned: Planned<'_>) -> bool {
        let Some(left) = self.left() else { return true };
        !left.is_zero() && self.expected_s(planned) <= left.as_secs_f64()
    }

    /// Returns the expected time of a measurement, seconds; zero if nothing is known, and at most the technique's limit.
    fn expected_s(&self, planned: Planned<'_>) -> f64 {
        let of = |spent: &&CompletedMeasurement| spent.technique == planned.technique;
        let same = self.spent.iter().filter(of).map(|spent| spent.expected_s(planned.pixels)).reduce(f64::max);
        let mut all: Vec<f64> = self.spent.iter().map(|spent| spent.expected_s(planned.pixels)).collect();
        all.sort_by(f64::total_cmp);
        let expected_s = same.or_else(|| all.get(all.len() / 2).copied()).unwrap_or(0.0);
        self.limits.technique.map_or(expected_s, |limit| expected_s.min(limit.as_secs_f64()))
    }

    /// Returns the end time of a measurement that began at `began`.
    fn end_of(&self, began: Instant) -> Option<End> {
        let deadline = self.limits.deadline.map(|at| End { at, limit: None });
        let technique = self.limits.technique.map(|limit| End { at: began + limit, limit: Some(limit) });
        match (deadline, technique) {
            (Some(deadline), Some(technique)) => Some(if technique.at < deadline.at { technique } else { deadline }),
            (deadline, technique) => deadline.or(technique),
        }
    }

    /// Returns the run's deadline.
    pub fn deadline(&self) -> Option<Instant> {
        self.limits.deadline
    }

    /// Returns whether a measurement that the given limit cut short, in a resumed run, may take longer in this one.
    pub fn is_longer_than(&self, limit_s: Option<f64>) -> bool {
        limit_s.is_some_and(|limit_s| self.limits.technique.is_none_or(|limit| limit.as_secs_f64() > limit_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut_short::CutShort;

    const SIZE_PX: glam::UVec2 = glam::UVec2::new(10, 10);

    fn ends_in(seconds: u64) -> Limits {
        Limits { deadline: Some(Instant::now() + Duration::from_secs(seconds)), technique: None }
    }

    #[test]
    fn what_is_not_expected_to_end_in_time_does_not_begin() {
        let mut pace = Pace::new(ends_in(20));
        let small = |technique| Planned::new(technique, SIZE_PX);
        assert!(pace.may_begin(small("slow")), "nothing is known of it");
        pace.took(small("slow"), 15.0);
        pace.took(small("fast"), 1.0);
        pace.took(small("other"), 2.0);
        assert!(pace.may_begin(small("slow")) && pace.may_begin(small("unknown")));
        let large = |technique| Planned::new(technique, 2 * SIZE_PX);
        assert!(!pace.may_begin(large("slow")), "four times as many pixels");
        assert!(pace.may_begin(large("fast")) && pace.may_begin(large("unknown")));
        assert!(
            !pace.may_begin(Planned::new("unknown", 4 * SIZE_PX)),
            "the median, 2 s, for sixteen times as many pixels"
        );
        // No technique is expected to take longer than its limit.
        let limited =
            Pace { limits: Limits { technique: Some(Duration::from_secs(3)), ..pace.limits }, ..pace.clone() };
        assert!(limited.may_begin(large("slow")));
        assert!(!Pace::new(ends_in(0)).may_begin(small("fast")), "the time is over");
        assert!(Pace::default().may_begin(large("slow")), "there is no deadline");
    }

    #[test]
    fn a_measurement_ends_by_whichever_limit_comes_first() {
        let began = Instant::now();
        let limit = Duration::from_secs(5);
        let of = |seconds: Option<u64>, technique| {
            let deadline = seconds.map(|seconds| began + Duration::from_secs(seconds));
            Pace::new(Limits { deadline, technique }).end_of(began).map(|end| (end.limit, end.at - began))
        };
        assert_eq!(of(None, None), None);
        assert_eq!(of(Some(60), None), Some((None, Duration::from_secs(60))));
        assert_eq!(of(Some(60), Some(limit)), Some((Some(limit), limit)));
        assert_eq!(of(Some(2), Some(limit)), Some((None, Duration::from_secs(2))));
    }

    #[test]
    fn the_deadline_is_no_error_and_a_technique_s_limit_is_one() {
        let cut = |limit| LabError::CutShort {
            technique: antumbra::TechniqueKind::Pcss,
            cut: CutShort { limit, seconds: 1.5, frames: 2 },
        };
        let mut pace = Pace::new(ends_in(60));
        let planned = Planned::new("pcss", SIZE_PX);
        assert_eq!(pace.measure(planned, |_| Err::<(), _>(cut(None))).unwrap(), None);
        let error = pace.measure(planned, |_| Err::<(), _>(cut(Some(Duration::from_millis(500))))).unwrap_err();
        assert_eq!(error.to_string(), "pcss: cut short by the limit of 0.5 s per technique, after 2 frames, 1.5 s");
        assert_eq!(pace.measure(planned, |end| Ok(end.is_some())).unwrap(), Some(true));
    }

    #[test]
    fn a_longer_limit_measures_again_what_a_shorter_one_cut() {
        let of = |seconds| Pace::new(Limits { deadline: None, technique: Some(Duration::from_secs(seconds)) });
        assert!(of(9).is_longer_than(Some(5.0)) && Pace::default().is_longer_than(Some(5.0)));
        assert!(!of(5).is_longer_than(Some(5.0)) && !of(9).is_longer_than(None));
    }
}
