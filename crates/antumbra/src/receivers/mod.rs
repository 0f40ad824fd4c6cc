//! Receivers as every pass over them reads them: a depth buffer, a multisampled one, or points; also the light and noise. Independent of
//! light maps.

pub(crate) mod blue_noise;
pub(crate) mod inputs;
pub(crate) mod points;
pub(crate) mod split_receivers;

/// Format of the library's depth images of receivers.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Format of derived normals: 16-bit normals have an error that is visible under grazing light.
pub(crate) const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
