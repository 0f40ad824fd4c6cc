//! Receivers, as every pass over them reads them: a depth buffer, one of several samples a pixel, or points; the light; noise. Nothing here
//! knows a light map.

pub(crate) mod blue_noise;
pub(crate) mod inputs;
pub(crate) mod points;
pub(crate) mod split_receivers;

/// Depth of receivers in images that the library makes.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Normals that the library derives: those of 16 bits have an error that grazing light shows.
pub(crate) const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
