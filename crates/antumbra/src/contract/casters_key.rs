//! Key of the casters that a frame sees of a set.

use glam::Vec3;

/// Key of a set's casters: equal keys, equal casters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CastersKey {
    set: u64,
    version: u64,
    layers: u32,
    /// Bits of where a frame counts places from.
    anchor: [u32; 3],
}

impl CastersKey {
    /// Of the set of this number at a version: its casters on `layers`, with places as in the world.
    pub(crate) fn new(set: u64, version: u64, layers: u32) -> Self {
        Self { set, version, layers, anchor: [0; 3] }
    }

    /// The same as a frame sees it that counts places from an anchor.
    pub(crate) fn counted_from(self, anchor: Vec3) -> Self {
        Self { anchor: anchor.to_array().map(f32::to_bits), ..self }
    }
}
