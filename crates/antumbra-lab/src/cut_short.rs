//! Measurement that a time limit ended.

use std::fmt;
use std::time::Duration;

/// Why a measurement ended without a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutShort {
    /// As [`End::limit`](crate::limits::End).
    pub limit: Option<Duration>,
    /// Time that it took, seconds.
    pub seconds: f64,
    /// Frames that were drawn, too few for a result.
    pub frames: u32,
}

impl fmt::Display for CutShort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let by = match self.limit {
            Some(limit) => format!("the limit of {} s for a technique", limit.as_secs_f64()),
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
