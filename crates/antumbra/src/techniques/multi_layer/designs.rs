//! Keys of the pipelines, with the constants of their shaders.

use super::params::{
    MultiLayerHat, MultiLayerLevelAccumulation, MultiLayerLevelWeights, MultiLayerLightParts, MultiLayerLists,
};
use crate::light_map::texel_lists::options::Accumulation;

/// Key of the lookup's pipeline: the constants of `resolve.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LookupDesign {
    pub(super) colored: bool,
    pub(super) list_accumulation: Accumulation,
    pub(super) level_accumulation: MultiLayerLevelAccumulation,
    pub(super) light_parts: MultiLayerLightParts,
    pub(super) level_weights: MultiLayerLevelWeights,
    pub(super) hat: MultiLayerHat,
    pub(super) lists: MultiLayerLists,
    pub(super) planes: bool,
    pub(super) shows_levels: bool,
}

impl LookupDesign {
    /// Returns the constants with their names.
    pub(super) fn constants(self) -> [(&'static str, f64); 9] {
        [
            ("COLORED", f64::from(u8::from(self.colored))),
            ("LIST_ACCUMULATION", f64::from(self.list_accumulation as u32)),
            ("LEVEL_ACCUMULATION", f64::from(self.level_accumulation as u32)),
            ("LIGHT_PARTS", f64::from(self.light_parts.count())),
            ("LEVEL_WEIGHTS", f64::from(self.level_weights as u32)),
            ("WEIGHTS_FRAGMENTS", f64::from(u8::from(self.hat == MultiLayerHat::Fragments))),
            ("LISTS_APART", f64::from(self.lists as u32)),
            ("HAS_PLANES", f64::from(u8::from(self.planes))),
            ("SHOWS_LEVELS", f64::from(u8::from(self.shows_levels))),
        ]
    }
}

/// Key of the filter's pipeline, which contains no code for options that are off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FilterDesign {
    pub(super) averages_by_count: bool,
    pub(super) colored: bool,
    pub(super) list_accumulation: Accumulation,
}

impl FilterDesign {
    /// Returns the constants with their names.
    pub(super) fn constants(self) -> [(&'static str, f64); 3] {
        [
            ("AVERAGES_BY_COUNT", f64::from(u8::from(self.averages_by_count))),
            ("COLORED", f64::from(u8::from(self.colored))),
            ("LIST_ACCUMULATION", f64::from(self.list_accumulation as u32)),
        ]
    }
}
