//! Depth pyramid: the smallest and largest depth of ever larger squares of a depth map.
//!
//! Level `i` has `⌈n / 2^(i+1)⌉` texels per side, each the (min, max) of the `2^(i+1)` square of map texels that it
//! covers, down to one texel for all. Depths are the stored ones without the warp of a warped window, so that one depth
//! scale holds for the whole map; readers know which end is nearer.
//!
//! The last level, one texel, ignores casters so near the light that they hide hardly any of it: `last.wesl`.
//!
//! A dispatch makes four levels, the most that WebGPU's default limits let it write: three dispatches serve maps of 512 to
//! 4096 texels.

use std::sync::Arc;

use glam::{UVec2, Vec2};

use crate::contract::{LevelTexels, MapLevel};
use crate::gpu::{
    Bindings, Gpu, Lease, Recorder, Scratch, Span, Stage, bindings, compute_entry, compute_pipeline, create_uniform,
    gpu_structs, texels, write_uniform,
};
use crate::shaders;

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;

/// Number of levels per dispatch.
const AT_ONCE: usize = 4;

/// Texels along a side of a workgroup's tile of the first of its levels.
const TILE: u32 = 16;

bindings! {
    struct Halving = "depth pyramid", COMPUTE, group 0 of [DEPTH_PYRAMID_LEVELS] {
        /// Map, or previous level.
        0 source: Texture(texels::FLOAT),
        1 view: Uniform,
        2 first_level: WrittenTexture(DepthPyramid::FORMAT),
        3 second_level: WrittenTexture(DepthPyramid::FORMAT),
        4 third_level: WrittenTexture(DepthPyramid::FORMAT),
        5 fourth_level: WrittenTexture(DepthPyramid::FORMAT),
    }
}

bindings! {
    struct Last = "depth pyramid's last levels", COMPUTE, group 0 of [DEPTH_PYRAMID_LAST], with halving: Halving {
        /// Level that is summed over.
        6 nodes: Texture(texels::FLOAT),
        7 light: Uniform,
    }
}

gpu_structs! {
    /// Light parameters of the last level; `last.wesl` documents the fields.
    pub(crate) struct NearLight {
        half_extent: Vec2,
        node_texels: f32,
        padding: f32,
    }
}

/// Builder of depth pyramids, with the levels of one map.
#[derive(Debug)]
pub(crate) struct DepthPyramid {
    layout: wgpu::BindGroupLayout,
    last_layout: wgpu::BindGroupLayout,
    of_map: wgpu::ComputePipeline,
    of_level: wgpu::ComputePipeline,
    last: wgpu::ComputePipeline,
    light: wgpu::Buffer,
    levels: Option<Levels>,
}

/// Levels of one map.
#[derive(Debug)]
struct Levels {
    map_size: UVec2,
    all: wgpu::TextureView,
    texture: Arc<wgpu::Texture>,
    /// Map and view to which the levels are bound.
    of: (wgpu::TextureView, wgpu::Buffer),
    /// Dispatches from the map on; `last` follows them.
    steps: Vec<Step>,
    last: wgpu::BindGroup,
}

/// Dispatch that makes four levels from the one before, or from the map.
#[derive(Debug)]
struct Step {
    bind_group: wgpu::BindGroup,
    /// Size of the first of the four levels.
    size: UVec2,
}

impl DepthPyramid {
    /// Format of levels: min in x, max in y.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;

    /// Largest side of the level that is summed over, texels.
    const NODES: u32 = 128;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = Halving::layout(gpu);
        let last_layout = Last::layout(gpu);
        let levels = |label, is_of_map: bool| {
            let constants = [("IS_OF_MAP", f64::from(u8::from(is_of_map)))];
            compute_entry(gpu, label, shaders::DEPTH_PYRAMID_LEVELS, None, &constants, &[&layout])
        };
        Self {
            of_map: levels("depth pyramid first levels", true),
            of_level: levels("depth pyramid further levels", false),
            last: compute_pipeline(gpu, "depth pyramid last levels", shaders::DEPTH_PYRAMID_LAST, &[&last_layout]),
            light: create_uniform::<NearLight>(gpu, "antumbra depth pyramid light"),
            last_layout,
            layout,
            levels: None,
        }
    }

    /// Allocates the levels of a map of `map_size` texels and binds them to it, and to its view: a
    /// [`LightViewGpu`](crate::light_map::light_view::LightViewGpu). `light_half_extent_m` is the light's half extent on its
    /// plane; zero for suns and lists of points, for which everything in the map matters.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        lease: &Lease,
        map: &wgpu::TextureView,
        view: &wgpu::Buffer,
        map_size: UVec2,
        light_half_extent_m: Vec2,
    ) {
        let sizes = level_sizes(map_size);
        let nodes = nodes_level(&sizes);
        let node_texels = 2.0 * (1u32 << nodes) as f32;
        write_uniform(stage, &self.light, &NearLight { half_extent: light_half_extent_m, node_texels, padding: 0.0 });
        let is_bound = |levels: &Levels| levels.map_size == map_size && levels.of.0 == *map && levels.of.1 == *view;
        if self.levels.as_ref().is_some_and(is_bound) {
            return;
        }
        let texture = match self.levels.take() {
            Some(levels) if levels.map_size == map_size => levels.texture,
            _ => lease.texture(&stage.device, Scratch::DepthPyramid, &descriptor(&sizes)),
        };
        let views: Vec<_> = (0..sizes.len() as u32)
            .map(|base_mip_level| {
                stage.create_view(
                    &texture,
                    &wgpu::TextureViewDescriptor {
                        base_mip_level,
                        mip_level_count: Some(1),
                        ..wgpu::TextureViewDescriptor::default()
                    },
                )
            })
            .collect();
        let halving = |first: usize| Halving {
            source: if first == 0 { map } else { &views[first - 1] },
            view,
            first_level: &views[first],
            second_level: &views[first + 1],
            third_level: &views[first + 2],
            fourth_level: &views[first + 3],
        };
        let step = |first: usize| Step { bind_group: halving(first).group(stage, &self.layout), size: sizes[first] };
        let first_of_last = sizes.len() - AT_ONCE;
        let last = Last { halving: halving(first_of_last), nodes: &views[nodes], light: &self.light };
        let all = stage.create_view(&texture, &wgpu::TextureViewDescriptor::default());
        self.levels = Some(Levels {
            map_size,
            all,
            of: (map.clone(), view.clone()),
            steps: (0..first_of_last).step_by(AT_ONCE).map(step).collect(),
            last: last.group(stage, &self.last_layout),
            texture,
        });
    }

    /// View of all levels, for shaders; `None` before [`Self::prepare`].
    pub(crate) fn view(&self) -> Option<&wgpu::TextureView> {
        self.levels.as_ref().map(|levels| &levels.all)
    }

    /// Views of single levels, for inspection.
    pub(crate) fn drawn(&self) -> Vec<MapLevel> {
        let Some(levels) = &self.levels else { return Vec::new() };
        let level = |base_mip_level: u32| MapLevel {
            view: levels.texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level,
                mip_level_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            }),
            origin_px: UVec2::ZERO,
            size_px: levels.map_size.map(|texels| texels.div_ceil(2 << base_mip_level)),
            texels: LevelTexels::Extremes,
        };
        (0..levels.texture.mip_level_count()).map(level).collect()
    }

    /// Records the dispatches that write every level from the map.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let Some(levels) = &self.levels else { return };
        recorder.compute("depth pyramid", Span::Only, |pass| {
            for (i, step) in levels.steps.iter().enumerate() {
                pass.set_pipeline(if i == 0 { &self.of_map } else { &self.of_level });
                pass.set_bind_group(0, &step.bind_group, &[]);
                pass.dispatch_workgroups(step.size.x.div_ceil(TILE), step.size.y.div_ceil(TILE), 1);
            }
            pass.set_pipeline(&self.last);
            pass.set_bind_group(0, &levels.last, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }

    /// Releases the levels, before a map of another kind.
    pub(crate) fn release(&mut self) {
        self.levels = None;
    }

    /// Bytes of the levels of a map.
    pub(crate) fn bytes_of(map_size: UVec2) -> u64 {
        let texels = |size: &UVec2| u64::from(size.x) * u64::from(size.y);
        8 * level_sizes(map_size).iter().map(texels).sum::<u64>()
    }
}

fn descriptor(sizes: &[UVec2]) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some("antumbra depth pyramid"),
        size: wgpu::Extent3d { width: sizes[0].x, height: sizes[0].y, depth_or_array_layers: 1 },
        mip_level_count: sizes.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DepthPyramid::FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    }
}

/// Returns the levels' sizes, from half the map's to 1 × 1. A texture's mip chain halves rounding down, so level 0 is
/// rounded up to a power of two: its texels beyond the map repeat the map's edge. Small maps, too, have more levels than
/// a dispatch makes, so that the last ones are made from a level before them.
fn level_sizes(map_size: UVec2) -> Vec<UVec2> {
    let mut size = map_size.map(|texels| texels.next_power_of_two().max(2 << AT_ONCE));
    let mut sizes = Vec::new();
    loop {
        size = (size / 2).max(UVec2::ONE);
        sizes.push(size);
        if size == UVec2::ONE {
            return sizes;
        }
    }
}

/// Returns the finest level that is small enough to be summed over.
fn nodes_level(sizes: &[UVec2]) -> usize {
    sizes.iter().position(|size| size.max_element() <= DepthPyramid::NODES).expect("the last is one texel")
}
