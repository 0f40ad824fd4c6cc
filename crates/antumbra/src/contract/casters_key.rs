//! Cache key of the casters of a set that a frame draws.

use glam::Vec3;

/// Key of a set's casters: equal keys mean equal casters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CastersKey {
    set: u64,
    version: u64,
    layers: u32,
    /// Bits of the frame's anchor, the origin of its positions.
    anchor: [u32; 3],
}

impl CastersKey {
    /// Creates the key of a set's casters on `layers` at a version, with positions in world space.
    pub(crate) fn new(set: u64, version: u64, layers: u32) -> Self {
        Self { set, version, layers, anchor: [0; 3] }
    }

    /// Returns the key for positions relative to an anchor.
    pub(crate) fn relative_to(self, anchor: Vec3) -> Self {
        Self { anchor: anchor.to_array().map(f32::to_bits), ..self }
    }
}
