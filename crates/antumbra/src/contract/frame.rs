//! One light's work for one frame, and what it may come short of.

use std::fmt;

use antumbra_light::{Aabb, Light};

use super::{Mask, PreparedCasters, PreparedReceivers, Surfaces};

/// One light's work for one frame, as techniques receive it: casters are drawn as they are, places are counted from the frame's
/// anchor.
#[derive(Clone, Copy, Debug)]
pub struct PreparedFrame<'a> {
    /// The light.
    pub light: &'a Light,
    /// What casts.
    pub casters: PreparedCasters<'a>,
    /// What receives.
    pub receivers: PreparedReceivers<'a>,
    /// Where visibility goes; the receivers' size.
    pub mask: &'a Mask,
    /// Where it goes instead, with how far it may be smoothed: of techniques whose visibility [is noisy](crate::techniques::Technique::is_noisy).
    /// They write the receivers' pixels and no others.
    pub noisy: Option<&'a wgpu::TextureView>,
}

impl PreparedFrame<'_> {
    /// Whether receivers may lie within a box of a closed caster, or the camera may see it from there, while the light is outside. A
    /// room's box, which holds both its lamp and the camera, tells nothing of the walls, which hold neither; where points may lie
    /// anywhere, it does not matter whether it holds the lamp.
    #[cfg_attr(not(any(feature = "ray_traced", feature = "receiver_lists")), allow(dead_code))]
    pub(crate) fn sees_within(&self) -> impl Fn(&Aabb) -> bool + use<> {
        let within = self.receivers.box_within();
        let are_anywhere = matches!(self.receivers.surfaces, Surfaces::Points { .. });
        let light = (!self.light.is_distant() && !are_anywhere).then_some(self.light.center);
        move |bounds| {
            let meets = bounds.min.cmple(within.max).all() && bounds.max.cmpge(within.min).all();
            let holds_light = light.is_some_and(|x| x.cmpge(bounds.min).all() && x.cmple(bounds.max).all());
            meets && !holds_light
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
