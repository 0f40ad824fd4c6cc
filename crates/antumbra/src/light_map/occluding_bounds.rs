//! Parts of casters' bounding boxes between a light and the receivers. The other parts, however large, cannot shade
//! anything.

use antumbra_light::{Aabb, Light};
use glam::Vec3;

use super::swept_volume::Sweep;

/// Largest coordinate of a known box, metres from the frame's anchor. A larger box counts as unknown: even if it is known, the
/// part of it that matters is no smaller.
pub(crate) const KNOWN_REACH_M: f32 = 1e5;

/// Length along a sun's axis, metres, above which the part of a box in front of the receivers counts as unknown.
const OPEN_M: f32 = 512.0;

/// Largest distance of unknown casters in front of a sun's receivers, metres. Farther ones are drawn as if they were there,
/// provided that the device can draw geometry in front of the near plane.
const UNKNOWN_REACH_M: f32 = 16_384.0;

/// Largest size of a box that is not cut, relative to the region that matters: motion inside such a box moves no window.
const WIDE: f32 = 2.0;

/// Enlargement of a region, as a fraction of its size, so that it contains its border.
const SLACK: f32 = 1e-3;

/// Bounding boxes of the parts of casters between light and receivers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OccludingBounds {
    /// Boxes of casters with known bounds.
    pub(crate) known: Vec<Aabb>,
    /// Union of the boxes of all others; `None` if there are none.
    pub(crate) unknown: Option<Aabb>,
}

impl OccludingBounds {
    /// Cuts the casters' boxes. The convex hull of `receivers` contains all receivers; if it is empty, boxes stay whole.
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

    /// Takes whole boxes as known.
    #[cfg(test)]
    pub(crate) fn of_known(boxes: &[Aabb]) -> Self {
        Self { known: boxes.to_vec(), unknown: None }
    }

    /// All boxes.
    pub(crate) fn all(&self) -> impl Iterator<Item = Aabb> + '_ {
        self.known.iter().copied().chain(self.unknown)
    }
}

/// Length of a box along an axis.
fn length_along(bounds: &Aabb, axis: Vec3) -> f32 {
    (bounds.max - bounds.min).dot(axis.abs())
}

/// Whether a box is bounded enough to be useful. Its coordinates are relative to a point near a light or a camera.
pub(crate) fn is_known(bounds: &Aabb) -> bool {
    bounds.min.abs().max_element() <= KNOWN_REACH_M && bounds.max.abs().max_element() <= KNOWN_REACH_M
}

/// Region to which boxes are cut.
enum Parts {
    /// All of space, if the receivers are unknown.
    All,
    /// Bounding box of a lamp and its receivers.
    Box(Aabb),
    /// Volume that the receivers sweep towards a sun.
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
