//! Passes over masks: how a technique's visibility is written, made smooth, faded, resized and converted to the host's format. Nothing here knows
//! a light map.

#[cfg(feature = "receiver_lists")]
pub(crate) mod accumulation;
pub(crate) mod denoise;
pub(crate) mod fade;
pub(crate) mod format;
pub(crate) mod half_resolution;
#[cfg(any(feature = "multi_layer", feature = "single_map", feature = "summed"))]
pub(crate) mod resolve;
pub(crate) mod smoothing;
#[cfg(any(feature = "multi_layer", feature = "receiver_lists", feature = "single_map", feature = "summed"))]
pub(crate) mod sparse_upsample;
