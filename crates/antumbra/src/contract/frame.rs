//! One light's work for one frame, and what it may come short of.

use std::fmt;

use antumbra_light::Light;

use super::{Mask, PreparedCasters, Receivers};

/// One light's work for one frame, as techniques receive it: casters are drawn as they are, places are counted from the frame's
/// anchor.
#[derive(Clone, Copy, Debug)]
pub struct PreparedFrame<'a> {
    /// The light.
    pub light: &'a Light,
    /// What casts.
    pub casters: PreparedCasters<'a>,
    /// What receives.
    pub receivers: Receivers<'a>,
    /// Where visibility goes; the receivers' size.
    pub mask: &'a Mask,
}

/// A structure of variable length that was too short for a frame. The frame used what fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow {
    /// What there was too much of, in the plural: `fragments`.
    pub what: &'static str,
    /// How many the frame had.
    pub needed: u64,
    /// How many there was room for.
    pub had: u64,
}

impl fmt::Display for Overflow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} and room for {}", self.needed, self.what, self.had)
    }
}
