//! Measurement that ended at a time limit.

use std::fmt;
use std::time::Duration;

/// Reason of a measurement without a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutShort {
    /// Limit of the technique, as [`End::limit`](crate::limits::End); `None` for the run's deadline.
    pub limit: Option<Duration>,
    /// Duration until then, seconds.
    pub seconds: f64,
    /// Number of frames drawn, too few for a result.
    pub frames: u32,
}

impl fmt::Display for CutShort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let by = match self.limit {
            Some(limit) => format!("the limit of {} s per technique", limit.as_secs_f64()),
            None => "the deadline".to_owned(),
        };
        let frames = match self.frames {
            0 => "before its first frame".to_owned(),
            1 => "after one frame".to_owned(),
            frames => format!("after {frames} frames"),
        };
        write!(f, "cut short by {by}, {frames}, {:.1} s", self.seconds)
    }
}
