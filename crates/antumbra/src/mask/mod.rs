//! Passes over masks: writing a technique's visibility, smoothing, fading, resizing and conversion to the host's format. They know nothing
//! of light maps.

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
