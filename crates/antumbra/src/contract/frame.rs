//! One light's work for one frame, and what it may come short of.

use std::fmt;

use antumbra_light::{Aabb, Light};

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

impl PreparedFrame<'_> {
    /// Whether the camera's near plane may lie within a box that the light is outside of. A room's box, which holds both its lamp and
    /// the camera, tells nothing of the walls, which hold neither.
    #[cfg_attr(not(any(feature = "ray_traced", feature = "receiver_lists")), allow(dead_code))]
    pub(crate) fn sees_within(&self) -> impl Fn(&Aabb) -> bool + use<> {
        let near = self.receivers.near_box();
        let light = (!self.light.is_distant()).then_some(self.light.center);
        move |bounds| {
            let meets_near = bounds.min.cmple(near.max).all() && bounds.max.cmpge(near.min).all();
            let holds_light = light.is_some_and(|x| x.cmpge(bounds.min).all() && x.cmple(bounds.max).all());
            meets_near && !holds_light
        }
    }
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
