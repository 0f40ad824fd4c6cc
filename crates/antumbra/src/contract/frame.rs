//! Frame of one light as techniques receive it, and overflow of its structures.

use std::fmt;

use antumbra_light::{Aabb, Light};

use super::{Mask, PreparedCasters, PreparedReceivers, Surfaces};

/// Frame of one light as techniques receive it: a set's casters are resolved to meshes, and positions are relative to the frame's
/// anchor.
#[derive(Clone, Copy, Debug)]
pub struct PreparedFrame<'a> {
    /// Light.
    pub light: &'a Light,
    /// Casters.
    pub casters: PreparedCasters<'a>,
    /// Receivers.
    pub receivers: PreparedReceivers<'a>,
    /// Output mask, of the receivers' size.
    pub mask: &'a Mask,
    /// Output in place of `mask` for techniques whose visibility [is noisy](crate::techniques::Technique::is_noisy): visibility and
    /// the magnification that limits its smoothing. They write the receivers' pixels and no others.
    pub noisy: Option<&'a wgpu::TextureView>,
}

impl PreparedFrame<'_> {
    /// Returns a test of a closed caster's box: whether receivers or the camera's near plane may be inside while the light is
    /// outside. A room's box contains both its lamp and the camera and says nothing about the walls, which contain neither. For
    /// points, the lamp's position is ignored.
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
    /// Plural noun of the elements: `fragments`.
    pub what: &'static str,
    /// Number of elements in the frame.
    pub needed: u64,
    /// Capacity, elements.
    pub had: u64,
}

impl fmt::Display for Overflow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, but capacity for {}", self.needed, self.what, self.had)
    }
}
