//! Levels of a packed map after its first, and their computation. They lie side by side in one texture, so that a shader can
//! gather texels of any level, because a gather has no level argument. Includes the CPU reference of `levels.wesl`.

use glam::UVec2;

use super::{MipsUniform, PackedMap, Packing, descriptor};
use crate::gpu::{
    Bindings, Gpu, Recorder, Span, Stage, array_view, bindings, compute_pipeline_without_zeroing, create_uniform,
    texels, write_uniform,
};
use crate::shaders;

bindings! {
    struct Halve = "packed mips", COMPUTE, group 0 of [PACKED_MAP_HALVE, PACKED_MAP_HALVE_SEVERAL] {
        0 mips: Uniform,
        1 first_level: TextureArray(texels::UINT),
        2 further_levels: ReadWriteArray(PackedMap::FORMAT),
    }
}

/// Width and height of a level, counted from 0.
pub(super) fn level_size(map_size: UVec2, level: u32) -> UVec2 {
    map_size >> level
}

/// Corner of a level in its texture.
pub(super) fn level_origin(map_size: UVec2, level: u32) -> UVec2 {
    if level <= 1 {
        return UVec2::ZERO;
    }
    UVec2::new(map_size.x >> 1, (map_size.y >> 1) - (map_size.y >> (level - 1)))
}

/// Width and height of the texture of all levels after the first.
pub(super) fn mips_size(map_size: UVec2) -> UVec2 {
    UVec2::new((map_size.x >> 1) + (map_size.x >> 2), map_size.y >> 1)
}

/// Number of levels down to the one whose shorter side is one texel.
pub(super) fn full_level_count(map_size: UVec2) -> u32 {
    map_size.min_element().ilog2() + 1
}

/// Dispatch that computes levels from the previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MipStep {
    /// Source level, counted from 0.
    pub(super) before: u32,
    /// Number of levels after it to compute: 1 at any size, more if the sides are divisible by 2 once per level.
    pub(super) count: u32,
}

impl MipStep {
    /// Maximum number of levels per dispatch.
    const MOST: u32 = 6;

    /// Whether every texel of the next level is the mean of 2 × 2.
    fn is_even(self, map_size: UVec2) -> bool {
        level_size(map_size, self.before) % 2 == UVec2::ZERO
    }
}

/// Dispatches that compute all levels after the first.
pub(super) fn mip_steps(map_size: UVec2, level_count: u32) -> impl Iterator<Item = MipStep> {
    let mut before = 0;
    std::iter::from_fn(move || {
        let left = level_count.checked_sub(before + 1).filter(|left| *left > 0)?;
        let size = level_size(map_size, before);
        let halvings = size.x.trailing_zeros().min(size.y.trailing_zeros());
        let step = MipStep { before, count: halvings.clamp(1, MipStep::MOST).min(left) };
        before += step.count;
        Some(step)
    })
}

/// Pipelines for one packing.
#[derive(Clone, Debug)]
pub(super) struct MipPipelines {
    halve: wgpu::ComputePipeline,
    halve_several: wgpu::ComputePipeline,
}

impl MipPipelines {
    pub(super) fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        Halve::layout(gpu)
    }

    pub(super) fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, packing: Packing) -> Self {
        let constants = packing.constants();
        let make = |label, wgsl| compute_pipeline_without_zeroing(gpu, label, wgsl, &constants, &[layout]);
        Self {
            halve: make("packed mips", shaders::PACKED_MAP_HALVE),
            halve_several: make("several packed mips", shaders::PACKED_MAP_HALVE_SEVERAL),
        }
    }
}

/// Further levels of one map.
#[derive(Debug)]
pub(super) struct Mips {
    map_size: UVec2,
    words: u32,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    steps: Vec<(MipStep, wgpu::Buffer, wgpu::BindGroup)>,
}

impl Mips {
    /// Allocates `level_count` − 1 levels, computed from `first`.
    pub(super) fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        first: &wgpu::TextureView,
        map_size: UVec2,
        words: u32,
        level_count: u32,
    ) -> Self {
        let descriptor = descriptor("antumbra packed mips", mips_size(map_size), words, false);
        let texture = gpu.device.create_texture(&descriptor);
        let view = array_view(gpu, &texture);
        let steps = mip_steps(map_size, level_count).map(|step| {
            let uniform = create_uniform::<MipsUniform>(gpu, "antumbra packed mips");
            let group = Halve { mips: &uniform, first_level: first, further_levels: &view }.cached_group(gpu, layout);
            (step, uniform, group)
        });
        Self { map_size, words, steps: steps.collect(), view, texture }
    }

    pub(super) fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    pub(super) fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Uploads the parameters of each dispatch.
    pub(super) fn upload(&self, stage: &Stage<'_>) {
        for (MipStep { before, count }, uniform, _) in &self.steps {
            write_uniform(stage, uniform, &MipsUniform { map_size: self.map_size, before: *before, count: *count });
        }
    }

    /// Computes the levels.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, pipelines: &MipPipelines) {
        for (i, (step, _, group)) in self.steps.iter().enumerate() {
            let (pipeline, tile) = match step.is_even(self.map_size) {
                true => (&pipelines.halve_several, 32),
                false => (&pipelines.halve, 8),
            };
            let workgroups = level_size(self.map_size, step.before + 1).map(|texels| texels.div_ceil(tile));
            recorder.compute_apart("mips", Span::of(i, self.steps.len()), |pass| {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(workgroups.x, workgroups.y, self.words);
            });
        }
    }
}
