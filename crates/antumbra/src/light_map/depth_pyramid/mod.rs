//! The least and greatest depth of ever larger squares of a depth map.
//!
//! Level `i` has `⌈n / 2^(i+1)⌉` texels a side, each the (min, max) of the `2^(i+1)` square of map texels that it
//! covers, up to one texel for all. Depth is taken as it is stored, but without the warp of a warped window, so that one
//! scale of depth holds for the whole map; which end is nearer is the reader's affair.
//!
//! The last level, of one texel, leaves out what is so near the light that it hides hardly anything of it: `last.wesl`.

use std::sync::Arc;

use glam::{UVec2, Vec2};

use crate::contract::{LevelTexels, MapLevel};
use crate::gpu::{
    Bindings, Gpu, Lease, Recorder, Scratch, Span, Stage, bindings, compute_pipeline, create_uniform, gpu_structs,
    texels, write_uniform,
};
use crate::shaders;

#[cfg(test)]
mod cpu;
#[cfg(test)]
mod tests;

/// Threads along each side of a workgroup.
const TILE: u32 = 8;

bindings! {
    struct Levelled = "depth pyramid", COMPUTE, group 0 of [DEPTH_PYRAMID_FIRST] {
        /// The map, or the level before.
        0 map: Texture(texels::FLOAT),
        1 level: WrittenTexture(DepthPyramid::FORMAT),
        2 view: Uniform,
    }
}

bindings! {
    struct Last = "depth pyramid's last level", COMPUTE, group 0 of [DEPTH_PYRAMID_LAST] {
        /// The level that is summed over.
        0 nodes: Texture(texels::FLOAT),
        1 level: WrittenTexture(DepthPyramid::FORMAT),
        2 view: Uniform,
        3 light: Uniform,
    }
}

gpu_structs! {
    /// The light, as the last level asks of it; `last.wesl` says what each is.
    pub(crate) struct NearLight {
        half_extent: Vec2,
        node_texels: f32,
        padding: f32,
    }
}

/// Builds pyramids.
#[derive(Debug)]
pub(crate) struct DepthPyramid {
    layout: wgpu::BindGroupLayout,
    last_layout: wgpu::BindGroupLayout,
    first: wgpu::ComputePipeline,
    next: wgpu::ComputePipeline,
    last: wgpu::ComputePipeline,
    light: wgpu::Buffer,
    levels: Option<Levels>,
}

/// The levels of one map.
#[derive(Debug)]
struct Levels {
    map_size: UVec2,
    all: wgpu::TextureView,
    texture: Arc<wgpu::Texture>,
    /// What they are bound to: the map, and its view.
    of: (wgpu::TextureView, wgpu::Buffer),
    steps: Vec<Step>,
    /// Makes the last level in place of its step; none where that is the first, too.
    last: Option<wgpu::BindGroup>,
}

/// What makes one level from the one before, or from the map.
#[derive(Debug)]
struct Step {
    bind_group: wgpu::BindGroup,
    size: UVec2,
}

impl DepthPyramid {
    /// Min in x, max in y.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;

    /// Texels along a side of the level that the last one sums over.
    const NODES: u32 = 128;

    pub(crate) fn new(gpu: &Gpu) -> Self {
        let layout = Levelled::layout(gpu);
        let last_layout = Last::layout(gpu);
        Self {
            last: compute_pipeline(gpu, "depth pyramid last", shaders::DEPTH_PYRAMID_LAST, &[&last_layout]),
            light: create_uniform::<NearLight>(gpu, "antumbra depth pyramid light"),
            last_layout,
            first: compute_pipeline(gpu, "depth pyramid first", shaders::DEPTH_PYRAMID_FIRST, &[&layout]),
            next: compute_pipeline(gpu, "depth pyramid next", shaders::DEPTH_PYRAMID_NEXT, &[&layout]),
            layout,
            levels: None,
        }
    }

    /// Allocates the levels of a map of `map_size` texels and binds them to it, and to its view: a
    /// [`LightViewGpu`](crate::light_map::light_view::LightViewGpu). `light_half_extent_m` is the light's on its plane; zero
    /// for suns and lists of points, where everything in the map matters.
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
        let top = sizes.len() as u32 - 1;
        let nodes = (0..top).find(|i| sizes[*i as usize].max_element() <= Self::NODES);
        if let Some(i) = nodes {
            let node_texels = 2.0 * (1u32 << i) as f32;
            let light = NearLight { half_extent: light_half_extent_m, node_texels, padding: 0.0 };
            write_uniform(stage, &self.light, &light);
        }
        let is_bound = |levels: &Levels| levels.map_size == map_size && levels.of.0 == *map && levels.of.1 == *view;
        if self.levels.as_ref().is_some_and(is_bound) {
            return;
        }
        let texture = match self.levels.take() {
            Some(levels) if levels.map_size == map_size => levels.texture,
            _ => lease.texture(&stage.device, Scratch::DepthPyramid, &descriptor(&sizes)),
        };
        let level = |i: u32| {
            stage.create_view(
                &texture,
                &wgpu::TextureViewDescriptor {
                    base_mip_level: i,
                    mip_level_count: Some(1),
                    ..wgpu::TextureViewDescriptor::default()
                },
            )
        };
        let steps = (0..)
            .zip(&sizes)
            .map(|(i, size)| {
                let previous = (i > 0).then(|| level(i - 1));
                let levelled = Levelled { map: previous.as_ref().unwrap_or(map), level: &level(i), view };
                let bind_group = levelled.group(stage, &self.layout);
                Step { bind_group, size: *size }
            })
            .collect();
        let last = nodes.map(|i| {
            Last { nodes: &level(i), level: &level(top), view, light: &self.light }.group(stage, &self.last_layout)
        });
        let all = stage.create_view(&texture, &wgpu::TextureViewDescriptor::default());
        self.levels = Some(Levels { map_size, all, texture, of: (map.clone(), view.clone()), steps, last });
    }

    /// All levels, for shaders; after [`Self::prepare`].
    pub(crate) fn view(&self) -> Option<&wgpu::TextureView> {
        self.levels.as_ref().map(|levels| &levels.all)
    }

    /// Each level alone, for whoever wants to look at it.
    pub(crate) fn drawn(&self) -> Vec<MapLevel> {
        let Some(levels) = &self.levels else { return Vec::new() };
        let level = |base_mip_level: u32| MapLevel {
            view: levels.texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level,
                mip_level_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            }),
            size_px: levels.map_size.map(|texels| texels.div_ceil(2 << base_mip_level)),
            texels: LevelTexels::Extremes,
        };
        (0..levels.texture.mip_level_count()).map(level).collect()
    }

    /// Reads the map, writes every level.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>) {
        let Some(levels) = &self.levels else { return };
        recorder.compute("depth pyramid", Span::Only, |pass| {
            let halved = levels.steps.len() - usize::from(levels.last.is_some());
            for (i, step) in levels.steps[..halved].iter().enumerate() {
                pass.set_pipeline(if i == 0 { &self.first } else { &self.next });
                pass.set_bind_group(0, &step.bind_group, &[]);
                pass.dispatch_workgroups(step.size.x.div_ceil(TILE), step.size.y.div_ceil(TILE), 1);
            }
            if let Some(last) = &levels.last {
                pass.set_pipeline(&self.last);
                pass.set_bind_group(0, last, &[]);
                pass.dispatch_workgroups(1, 1, 1);
            }
        });
    }

    /// Lets go of what it has, for a map of another kind.
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

/// The levels' sizes, from half the map's to 1 × 1. A texture's mip chain halves rounding down, so level 0 is rounded
/// up to a power of two: what it has beyond the map repeats the map's edge.
fn level_sizes(map_size: UVec2) -> Vec<UVec2> {
    let mut size = UVec2::new(map_size.x.next_power_of_two(), map_size.y.next_power_of_two());
    let mut sizes = Vec::new();
    loop {
        size = (size / 2).max(UVec2::ONE);
        sizes.push(size);
        if size == UVec2::ONE {
            return sizes;
        }
    }
}
