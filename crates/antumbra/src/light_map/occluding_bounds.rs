//! Part of casters' boxes between a light and the receivers: no other part of them can shade anything, be it as large as
//! it may.

use antumbra_light::{Aabb, Light};
use glam::Vec3;

use super::swept_volume::Sweep;

/// A box with a side farther from where the frame counts places from, metres, is taken for unknown: where somebody knew it, the
/// part of it that matters is no smaller.
pub(crate) const KNOWN_REACH_M: f32 = 1e5;

/// Nor does a box say where a caster is that is open over so far before what a sun's light reaches, metres.
const OPEN_M: f32 = 512.0;

/// Unknown casters may stand so far before what a sun's light reaches, metres. Those that are farther are drawn where the device
/// keeps what lies before a near plane, as if they stood there.
const UNKNOWN_REACH_M: f32 = 16_384.0;

/// A box about as large as the region of what matters, or smaller, is left as it is: whatever moves in it moves no window.
const WIDE: f32 = 2.0;

/// A region is widened by this part of its size: what lies on its border is in it.
const SLACK: f32 = 1e-3;

/// Boxes of what of the casters lies between light and receivers, or larger ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Between {
    /// Of casters whose bounds are known.
    pub(crate) known: Vec<Aabb>,
    /// Of all others together.
    pub(crate) unknown: Option<Aabb>,
}

impl Between {
    /// `receivers` span what receives; without any, casters are as they are.
    pub(crate) fn new(light: &Light, casters: &[Aabb], receivers: &[Vec3]) -> Self {
        let parts = Parts::of(light, receivers);
        let mut between = Self::default();
        for bounds in casters.iter().filter(|bounds| !bounds.is_empty()) {
            let known = is_known(bounds);
            let Some(part) = (if known { parts.of_known(bounds) } else { parts.of_unknown(bounds) }) else { continue };
            if known && !(light.is_distant() && length_along(&part, light.axis) > OPEN_M) {
                between.known.push(part);
            } else {
                between.unknown = Some(between.unknown.map_or(part, |all| all.union(part)));
            }
        }
        between
    }

    /// Boxes that are known, whole.
    #[cfg(test)]
    pub(crate) fn of_known(boxes: &[Aabb]) -> Self {
        Self { known: boxes.to_vec(), unknown: None }
    }

    /// All boxes.
    pub(crate) fn all(&self) -> impl Iterator<Item = Aabb> + '_ {
        self.known.iter().copied().chain(self.unknown)
    }
}

/// How far a box reaches along an axis.
fn length_along(bounds: &Aabb, axis: Vec3) -> f32 {
    (bounds.max - bounds.min).dot(axis.abs())
}

/// Whether a box, whose places are counted from near a light or a camera, tells anything.
pub(crate) fn is_known(bounds: &Aabb) -> bool {
    bounds.min.abs().max_element() <= KNOWN_REACH_M && bounds.max.abs().max_element() <= KNOWN_REACH_M
}

/// What takes the part of a box that matters.
enum Parts {
    /// Where nothing is known of what receives.
    All,
    /// The box about a lamp and its receivers.
    Box(Aabb),
    /// What receivers sweep towards a sun.
    Sweep(Sweep),
}

impl Parts {
    fn of(light: &Light, receivers: &[Vec3]) -> Self {
        if receivers.is_empty() {
            return Self::All;
        }
        if light.is_distant() {
            return Self::Sweep(Sweep::of(light, receivers));
        }
        let radius = Vec3::splat(light.bounding_radius());
        let of_light = Aabb { min: light.center - radius, max: light.center + radius };
        let all = Aabb::of(receivers.iter().copied()).union(of_light);
        let slack = SLACK * all.diagonal();
        Self::Box(Aabb { min: all.min - slack, max: all.max + slack })
    }

    fn of_known(&self, bounds: &Aabb) -> Option<Aabb> {
        match self {
            Self::All => Some(*bounds),
            Self::Box(region) if bounds.diagonal() <= WIDE * region.diagonal() => Some(*bounds),
            Self::Box(region) => region.intersection(*bounds),
            Self::Sweep(sweep) => sweep.part_of(bounds),
        }
    }

    fn of_unknown(&self, bounds: &Aabb) -> Option<Aabb> {
        match self {
            Self::All => Some(*bounds),
            Self::Box(region) => region.intersection(*bounds),
            Self::Sweep(sweep) => sweep.part_within(bounds, UNKNOWN_REACH_M),
        }
    }
}
