//! Textures of casters that light may pass, bound in groups.

use crate::contract::MeshCaster;
use crate::gpu::{Bindings, Gpu, Stage, bindings, samples, shared_constants, texels, white_texture};

shared_constants! {
    /// Number of textures per pass.
    pub(super) const MAX_TEXTURES: u32 = 12, as in RAY_TRACED_TRACE;
}

bindings! {
    struct Surfaces = "ray_traced surfaces", COMPUTE, group 2 of [RAY_TRACED_TRACE] {
        0 surface_0: Texture(texels::FILTERED),
        1 sampler_0: Sampler(samples::FILTERS),
        2 surface_1: Texture(texels::FILTERED),
        3 sampler_1: Sampler(samples::FILTERS),
        4 surface_2: Texture(texels::FILTERED),
        5 sampler_2: Sampler(samples::FILTERS),
        6 surface_3: Texture(texels::FILTERED),
        7 sampler_3: Sampler(samples::FILTERS),
        8 surface_4: Texture(texels::FILTERED),
        9 sampler_4: Sampler(samples::FILTERS),
        10 surface_5: Texture(texels::FILTERED),
        11 sampler_5: Sampler(samples::FILTERS),
        12 surface_6: Texture(texels::FILTERED),
        13 sampler_6: Sampler(samples::FILTERS),
        14 surface_7: Texture(texels::FILTERED),
        15 sampler_7: Sampler(samples::FILTERS),
        16 surface_8: Texture(texels::FILTERED),
        17 sampler_8: Sampler(samples::FILTERS),
        18 surface_9: Texture(texels::FILTERED),
        19 sampler_9: Sampler(samples::FILTERS),
        20 surface_10: Texture(texels::FILTERED),
        21 sampler_10: Sampler(samples::FILTERS),
        22 surface_11: Texture(texels::FILTERED),
        23 sampler_11: Sampler(samples::FILTERS),
    }
}

/// Textures of a frame, each once.
#[derive(Debug, Default)]
pub(super) struct Textures<'a> {
    all: Vec<(&'a wgpu::TextureView, &'a wgpu::Sampler)>,
}

impl<'a> Textures<'a> {
    /// Returns the number of a caster's texture; `None` if it has none.
    pub(super) fn number_of(&mut self, caster: &MeshCaster<'a>) -> Option<u32> {
        let texture = caster.opacity.texture()?;
        let pair = (texture.view, texture.sampler);
        let place = self.all.iter().position(|known| *known == pair).unwrap_or_else(|| {
            self.all.push(pair);
            self.all.len() - 1
        });
        Some(place as u32)
    }

    /// Returns the number of groups; at least one.
    pub(super) fn group_count(&self) -> u32 {
        (self.all.len() as u32).div_ceil(MAX_TEXTURES).max(1)
    }

    /// Returns a bind group for each [`MAX_TEXTURES`] of them.
    pub(super) fn groups(
        &self,
        stage: &Stage<'_>,
        layout: &wgpu::BindGroupLayout,
        none: &(wgpu::TextureView, wgpu::Sampler),
    ) -> Vec<wgpu::BindGroup> {
        (0..self.group_count() as usize).map(|group| self.group(stage, layout, none, group)).collect()
    }

    fn group(
        &self,
        stage: &Stage<'_>,
        layout: &wgpu::BindGroupLayout,
        none: &(wgpu::TextureView, wgpu::Sampler),
        group: usize,
    ) -> wgpu::BindGroup {
        let at = |i: usize| self.all.get(MAX_TEXTURES as usize * group + i).copied().unwrap_or((&none.0, &none.1));
        let all: [_; MAX_TEXTURES as usize] = std::array::from_fn(at);
        let surfaces = Surfaces {
            surface_0: all[0].0,
            sampler_0: all[0].1,
            surface_1: all[1].0,
            sampler_1: all[1].1,
            surface_2: all[2].0,
            sampler_2: all[2].1,
            surface_3: all[3].0,
            sampler_3: all[3].1,
            surface_4: all[4].0,
            sampler_4: all[4].1,
            surface_5: all[5].0,
            sampler_5: all[5].1,
            surface_6: all[6].0,
            sampler_6: all[6].1,
            surface_7: all[7].0,
            sampler_7: all[7].1,
            surface_8: all[8].0,
            sampler_8: all[8].1,
            surface_9: all[9].0,
            sampler_9: all[9].1,
            surface_10: all[10].0,
            sampler_10: all[10].1,
            surface_11: all[11].0,
            sampler_11: all[11].1,
        };
        surfaces.group(stage, layout)
    }
}

/// Returns the layout of [`Textures::groups`].
pub(super) fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    Surfaces::layout(gpu)
}

/// Returns the texture and sampler bound to unused slots.
pub(super) fn none(gpu: &Gpu) -> (wgpu::TextureView, wgpu::Sampler) {
    (white_texture(gpu), gpu.device.create_sampler(&wgpu::SamplerDescriptor::default()))
}
