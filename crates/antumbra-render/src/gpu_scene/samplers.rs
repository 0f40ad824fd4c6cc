//! Samplers for each combination of address modes.

use std::collections::HashMap;

use antumbra_scene::Wrap;

/// Samplers per address modes: one of level 0 only, as visibility is defined, and one of all levels for shading.
#[derive(Debug)]
pub(super) struct SamplerSet {
    pub level_0: HashMap<[Wrap; 2], wgpu::Sampler>,
    pub smooth: HashMap<[Wrap; 2], wgpu::Sampler>,
}

/// Anisotropy of the smooth samplers: floors stay sharp a few metres away, and every adapter supports it.
const SMOOTH_ANISOTROPY: u16 = 8;

impl SamplerSet {
    pub fn new(device: &wgpu::Device) -> Self {
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        let pairs = || wraps.into_iter().flat_map(|u| wraps.into_iter().map(move |v| [u, v]));
        let address = |wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
            Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
        };
        let sampler = |wrap: [Wrap; 2], label, lod_max_clamp, anisotropy_clamp| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: address(wrap[0]),
                address_mode_v: address(wrap[1]),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                lod_max_clamp,
                anisotropy_clamp,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        Self {
            level_0: pairs().map(|wrap| (wrap, sampler(wrap, "level 0", 0.0, 1))).collect(),
            smooth: pairs().map(|wrap| (wrap, sampler(wrap, "smooth", f32::MAX, SMOOTH_ANISOTROPY))).collect(),
        }
    }
}
