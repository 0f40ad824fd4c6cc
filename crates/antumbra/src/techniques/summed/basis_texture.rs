//! Texture of the basis, and its mips, for tables that do not encode depth when they read it.

use std::sync::Arc;

use glam::UVec2;

use super::texture::written;
use super::{Basis, Filter, SoftDesign};
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_entry, compute_pipeline, texels};
use crate::shaders;
use crate::techniques::summed::summed_area_table::Sums;

bindings! {
    /// Target of the encode pass, declared for integers; see [`Sums::adapt`].
    struct BasisBindings = "depth basis", COMPUTE, group 3 of [SUMMED_ENCODE] {
        0 basis: WrittenTexture(wgpu::TextureFormat::Rgba32Uint),
    }

    /// Targets of the encode pass for tiles with planes of their own.
    struct TileBasisBindings = "depth basis of tiles", COMPUTE, group 3 of [SUMMED_ENCODE_TILES] {
        0 basis: WrittenTexture(wgpu::TextureFormat::Rgba32Uint),
        7 tiles: WrittenTexture(wgpu::TextureFormat::Rgba32Float),
    }

    struct HalveBindings = "mips of depth basis", COMPUTE, group 0 of [SUMMED_HALVE] {
        0 previous: Texture(texels::FLOAT),
        1 level: WrittenTexture(wgpu::TextureFormat::Rgba32Float),
    }
}

/// Pass that writes the basis to a texture, and its mips.
#[derive(Debug)]
pub(super) struct BasisPass {
    sums: Sums,
    layout: wgpu::BindGroupLayout,
    encode: wgpu::ComputePipeline,
    /// Layout and pipeline of the mip passes, if the basis is filtered by mips.
    halve: Option<(wgpu::BindGroupLayout, wgpu::ComputePipeline)>,
}

/// Basis texture for one map size, and its bind groups.
#[derive(Debug)]
pub(super) struct BasisTexture {
    /// Texture that all lights share.
    texture: Arc<wgpu::Texture>,
    /// View of all levels.
    pub(super) view: wgpu::TextureView,
    encode_group: wgpu::BindGroup,
    halve_groups: Vec<wgpu::BindGroup>,
    /// Texels along a side of the area that a workgroup encodes.
    group_side: u32,
}

impl BasisPass {
    /// Creates the passes of a design; `groups` are the layouts of its shaders' groups 0 to 2.
    pub(super) fn new(gpu: &Gpu, design: SoftDesign, groups: [&wgpu::BindGroupLayout; 3]) -> Self {
        let sums = design.sums();
        let adapt = |ty: &mut wgpu::BindingType| sums.adapt(ty);
        let (layout, wgsl) = match (design.basis, sums) {
            (Basis::Tiles, _) => (TileBasisBindings::layout_with(gpu, adapt), shaders::SUMMED_ENCODE_TILES),
            (_, Sums::Integer) => (BasisBindings::layout_with(gpu, adapt), shaders::SUMMED_ENCODE),
            (_, Sums::Float) => (BasisBindings::layout_with(gpu, adapt), shaders::SUMMED_ENCODE_FLOAT),
        };
        let basis = [("BASIS", f64::from(design.basis as u32))];
        let constants = if design.basis == Basis::Tiles { &[][..] } else { &basis };
        let [a, b, c] = groups;
        let encode = compute_entry(gpu, "depth basis", wgsl, None, constants, &[a, b, c, &layout]);
        let halve = (design.filter == Filter::Mips).then(|| {
            let layout = HalveBindings::layout(gpu);
            let pipeline = compute_pipeline(gpu, "mips of depth basis", shaders::SUMMED_HALVE, &[&layout]);
            (layout, pipeline)
        });
        Self { sums, layout, encode, halve }
    }

    /// Returns the texture for a map of `size` and its bind groups. `made` is an earlier result for the same size. `tiles` are
    /// the planes of tiles and their side.
    pub(super) fn prepare(
        &self,
        stage: &Stage<'_>,
        made: Option<BasisTexture>,
        size: UVec2,
        tiles: Option<(&wgpu::TextureView, u32)>,
    ) -> BasisTexture {
        let level_count = if self.halve.is_some() { size.max_element().ilog2() + 1 } else { 1 };
        let texture = made.map(|made| made.texture).unwrap_or_else(|| {
            let descriptor = written("antumbra depth basis", self.sums.format(), size, level_count);
            stage.device.scratch_texture(Scratch::DepthBasis, &descriptor)
        });
        let levels: Vec<_> = (0..level_count).map(|level| level_of(stage, &texture, level)).collect();
        let basis = &levels[0];
        let encode_group = match tiles {
            Some((tiles, _)) => TileBasisBindings { basis, tiles }.group(stage, &self.layout),
            None => BasisBindings { basis }.group(stage, &self.layout),
        };
        let halve_groups = self.halve.iter().flat_map(|(layout, _)| {
            levels
                .windows(2)
                .map(move |pair| HalveBindings { previous: &pair[0], level: &pair[1] }.group(stage, layout))
        });
        BasisTexture {
            view: stage.create_view(&texture, &wgpu::TextureViewDescriptor::default()),
            encode_group,
            halve_groups: halve_groups.collect(),
            group_side: tiles.map_or(8, |(_, side)| side.max(64)),
            texture,
        }
    }

    /// Records the basis and its mips, one pass per level because each reads the level before. `bind` binds groups 0 to 2.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        made: &BasisTexture,
        bind: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        let size = UVec2::new(made.texture.width(), made.texture.height());
        recorder.compute("basis", Span::Only, |pass| {
            pass.set_pipeline(&self.encode);
            bind(pass);
            pass.set_bind_group(3, &made.encode_group, &[]);
            let groups = size.map(|n| n.div_ceil(made.group_side));
            pass.dispatch_workgroups(groups.x, groups.y, 1);
        });
        let Some((_, halve)) = &self.halve else { return };
        let count = made.halve_groups.len();
        for (i, group) in made.halve_groups.iter().enumerate() {
            recorder.compute("mips", Span::of(i, count), |pass| {
                pass.set_pipeline(halve);
                pass.set_bind_group(0, group, &[]);
                let groups = (size >> (i as u32 + 1)).max(UVec2::ONE).map(|n| n.div_ceil(8));
                pass.dispatch_workgroups(groups.x, groups.y, 1);
            });
        }
    }
}

fn level_of(stage: &Stage<'_>, texture: &wgpu::Texture, base_mip_level: u32) -> wgpu::TextureView {
    let descriptor = wgpu::TextureViewDescriptor {
        base_mip_level,
        mip_level_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    };
    stage.create_view(texture, &descriptor)
}
