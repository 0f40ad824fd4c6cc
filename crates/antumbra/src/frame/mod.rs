//! Inputs of every pass over receivers, and passes over masks: nothing here knows a light map.

#[cfg(feature = "receiver_lists")]
pub(crate) mod accumulation;
pub(crate) mod blue_noise;
pub(crate) mod denoise;
pub(crate) mod fade;
pub(crate) mod half_resolution;
pub(crate) mod inputs;
pub(crate) mod mask_format;
pub(crate) mod points;
#[cfg(any(feature = "multi_layer", feature = "single_map", feature = "summed"))]
pub(crate) mod resolve;
pub(crate) mod smoothing;
#[cfg(any(feature = "multi_layer", feature = "receiver_lists", feature = "single_map", feature = "summed"))]
pub(crate) mod sparse_upsample;
pub(crate) mod split_receivers;

/// Of pictures of receivers that are made here.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Of normals that are derived here: those of 16 bits have an error that grazing light shows.
pub(crate) const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
