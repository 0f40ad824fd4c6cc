//! Summed-area tables of four channels: one for a whole texture, or a grid of tiles with a table each.
//!
//! A texel of the table holds the sum of all texels of its tile that are neither to the right of it nor below it, so the sum
//! over any rectangle inside a tile takes four of them (Crow 1984). Sizes need not be powers of two.
//!
//! Integer sums wrap, and differences of wrapped sums are exact if the rectangle's own sum is below 2³². Float sums lose the
//! bits beyond 24. Within a tile chosen by [`Tiling::Chosen`] nothing wraps.
//!
//! [`Scan::Blocks`] reads the source once and writes the table once for tiles of at most 256 texels; for one table it reads the
//! source twice. The source is a texture, or a shader encodes it on reading ([`Source::Encoded`]), so that no texture needs to
//! store it. [`Scan::Doubling`] is the method of 2013, kept for comparison.

use std::sync::Arc;

use glam::UVec2;

use crate::gpu::{
    Bindings, Gpu, Recorder, Scratch, Span, Stage, bindings, compute_entry, create_uniform, shared_constants, texels,
    write_uniform,
};
use crate::shaders;

#[cfg(test)]
mod cpu;
mod design;
mod doubling;
pub(crate) mod gpu_types;
#[cfg(test)]
mod tests;

pub(crate) use design::{Scan, Source, Sums, TableDesign, Tiling};
use doubling::Doubling;
use gpu_types::{DoublingUniform, TableUniform};

shared_constants! {
    /// Side of a block, texels; a workgroup sums one block.
    pub(crate) const BLOCK: u32 = 16, as in SUMMED_AREA_TABLE;

    /// Largest side of a tile, texels, that a workgroup still sums in one pass.
    pub(crate) const MAX_TILE: u32 = 256, as in SUMMED_AREA_TABLE;

    /// Side of the area that a workgroup of the pass over tiles sums if tiles are not larger, texels.
    const PANEL: u32 = 64, as in SUMMED_AREA_TABLE;

    /// Number of sums that a step of recursive doubling adds up.
    const DOUBLING_READS: u32 = 8, as in SUMMED_AREA_TABLE_DOUBLING;
}

/// Threads of a workgroup that carries sums from block to block.
const CARRY_THREADS: u32 = 64;

bindings! {
    /// Bindings of every pass, declared for integers; see [`Sums::adapt`].
    struct TableBindings = "summed-area table", COMPUTE {
        1 table: WrittenTexture(wgpu::TextureFormat::Rgba32Uint),
        2 shape: Uniform,
        3 above: ReadWrite,
        4 before: ReadWrite,
        5 corner: ReadWrite,
        6 largest: ReadWrite,
    }

    /// Bindings of passes that sum a texture.
    struct TextureTable = "summed-area table of a texture",
        COMPUTE, group 0 of [SUMMED_AREA_TABLE, SUMMED_AREA_TABLE_DOUBLING], with made: TableBindings
    {
        0 source: Texture(texels::UINT),
    }

    /// Dispatch arguments of the last steps of doubling, for a chosen tile.
    struct LateSteps = "late steps of doubling", COMPUTE, group 1 of [SUMMED_AREA_TABLE_DOUBLING] {
        0 late_dispatch: ReadWrite,
    }

    /// Bindings of passes that encode values when they read them.
    struct EncodedTable = "summed-area table of encoded values",
        COMPUTE, group 3 of [SUMMED_AREA_TABLE_ENCODED], with made: TableBindings
    {
        7 tiles: WrittenTexture(wgpu::TextureFormat::Rgba32Float),
    }
}

/// Summed-area table and the passes that compute it.
#[derive(Debug)]
pub(crate) struct SummedAreaTable {
    design: TableDesign,
    is_encoded: bool,
    layout: wgpu::BindGroupLayout,
    pipelines: Pipelines,
    uniform: wgpu::Buffer,
    /// Index of the table among those that one pass reads together.
    part: u8,
    made: Option<SizedResources>,
}

/// Pipelines in the order of the passes.
#[derive(Debug)]
enum Pipelines {
    Whole { sum_blocks: wgpu::ComputePipeline, carry: [wgpu::ComputePipeline; 2], finish: wgpu::ComputePipeline },
    Tiles { choose: Option<[wgpu::ComputePipeline; 2]>, sum_tiles: wgpu::ComputePipeline },
    Doubling { choose: Option<ChooseSteps>, step: wgpu::ComputePipeline },
}

/// Pipelines that choose a tile, and then the steps of doubling that it needs.
#[derive(Debug)]
struct ChooseSteps {
    choose: [wgpu::ComputePipeline; 2],
    late_layout: wgpu::BindGroupLayout,
    late: wgpu::ComputePipeline,
}

/// Objects for one size of table.
#[derive(Debug)]
struct SizedResources {
    size: UVec2,
    side: u32,
    memory: Memory,
    view: wgpu::TextureView,
    /// Bind group of all passes but the steps of doubling.
    bind_group: wgpu::BindGroup,
    steps: Vec<wgpu::BindGroup>,
    late: Option<ConditionalSteps>,
}

/// Allocations for one size of table, shared by all lights.
#[derive(Debug)]
struct Memory {
    texture: Arc<wgpu::Texture>,
    /// Borders of blocks: `above`, `before`, `corner`.
    borders: [Arc<wgpu::Buffer>; 3],
    /// Largest sums of tiles of 2^i blocks.
    largest: Arc<wgpu::Buffer>,
    /// Second of the two textures between which doubling alternates.
    other: Option<Arc<wgpu::Texture>>,
    /// Workgroups of the late steps of doubling, which not every tile needs; 0 where they are skipped.
    late_dispatch: Option<Arc<wgpu::Buffer>>,
}

/// Steps at the end of `steps` that the GPU runs only if the tile that it has chosen is large enough.
#[derive(Debug)]
struct ConditionalSteps {
    /// Index of the first late step.
    first: usize,
    group: wgpu::BindGroup,
}

impl SizedResources {
    /// Number of blocks along each side.
    fn blocks(&self) -> UVec2 {
        self.size.map(|n| n.div_ceil(BLOCK))
    }

    /// Dispatches the passes that choose a tile.
    fn choose_tile(&self, pass: &mut wgpu::ComputePass<'_>, [total_blocks, choose]: &[wgpu::ComputePipeline; 2]) {
        pass.set_pipeline(total_blocks);
        pass.dispatch_workgroups(self.size.x.div_ceil(PANEL), self.blocks().y, 1);
        pass.set_pipeline(choose);
        pass.dispatch_workgroups((self.memory.largest.size() / 4) as u32, 1, 1);
    }

    /// Dispatches the steps of doubling, after the choice of a tile if there is one.
    fn double(&self, pass: &mut wgpu::ComputePass<'_>, choose: Option<&ChooseSteps>, step: &wgpu::ComputePipeline) {
        if let Some(ChooseSteps { choose, late: count_late, .. }) = choose {
            self.choose_tile(pass, choose);
            if let Some(late) = &self.late {
                pass.set_pipeline(count_late);
                pass.set_bind_group(0, &self.steps[late.first], &[]);
                pass.set_bind_group(1, &late.group, &[]);
                pass.dispatch_workgroups(1, 1, 1);
            }
        }
        let blocks = self.blocks();
        pass.set_pipeline(step);
        for (i, bind_group) in self.steps.iter().enumerate() {
            pass.set_bind_group(0, bind_group, &[]);
            match (&self.late, &self.memory.late_dispatch) {
                (Some(late), Some(dispatch)) if i >= late.first => pass.dispatch_workgroups_indirect(dispatch, 0),
                _ => pass.dispatch_workgroups(blocks.x, blocks.y, 1),
            }
        }
    }
}

impl SummedAreaTable {
    /// Creates the passes of a design. `part` is the table's index among those that one pass reads together.
    pub(crate) fn new(gpu: &Gpu, design: TableDesign, part: u8, source: &Source<'_>) -> Self {
        let sums = design.sums;
        let is_encoded = matches!(source, Source::Encoded { .. });
        let adapt = |ty: &mut wgpu::BindingType| sums.adapt(ty);
        let layout =
            if is_encoded { EncodedTable::layout_with(gpu, adapt) } else { TextureTable::layout_with(gpu, adapt) };
        let (texture, doubling) = match sums {
            Sums::Float => (shaders::SUMMED_AREA_TABLE_FLOAT, shaders::SUMMED_AREA_TABLE_DOUBLING_FLOAT),
            Sums::Integer => (shaders::SUMMED_AREA_TABLE, shaders::SUMMED_AREA_TABLE_DOUBLING),
        };
        let entry = |name| match source {
            Source::Texture => compute_entry(gpu, "summed-area table", texture, Some(name), &[], &[&layout]),
            Source::Encoded { wgsl, constants, layouts: [a, b, c] } => {
                compute_entry(gpu, "summed-area table", wgsl, Some(name), constants, &[a, b, c, &layout])
            }
        };
        let choose = || (design.tiling == Tiling::Chosen).then(|| [entry("total_blocks"), entry("choose_tile")]);
        let pipelines = match (design.scan, design.tiling) {
            (Scan::Doubling, _) => {
                let label = "summed-area table doubling";
                let of_tile = |choose| {
                    let late_layout = LateSteps::layout(gpu);
                    let late = compute_entry(gpu, label, doubling, Some("count_late"), &[], &[&layout, &late_layout]);
                    ChooseSteps { choose, late_layout, late }
                };
                Pipelines::Doubling {
                    choose: choose().map(of_tile),
                    step: compute_entry(gpu, label, doubling, Some("double"), &[], &[&layout]),
                }
            }
            (Scan::Blocks, Tiling::Whole) => Pipelines::Whole {
                sum_blocks: entry("sum_blocks"),
                carry: [entry("carry"), entry("carry_corners")],
                finish: entry("finish"),
            },
            (Scan::Blocks, _) => Pipelines::Tiles { choose: choose(), sum_tiles: entry("sum_tiles") },
        };
        let uniform = create_uniform::<TableUniform>(gpu, "antumbra summed-area table");
        Self { design, is_encoded, layout, pipelines, uniform, part, made: None }
    }

    /// Allocates the table of a source of `size` texels and binds `binding` to it: the source's texture or, for encoded values,
    /// the texture that receives the tiles' planes. `side` is that of [`Tiling::Tiles`]; a different side takes the same
    /// memory.
    pub(crate) fn prepare(&mut self, stage: &Stage<'_>, binding: &wgpu::TextureView, size: UVec2, side: u32) {
        let side = match self.design.tiling {
            Tiling::Whole => size.max_element().next_power_of_two().max(BLOCK),
            Tiling::Tiles => side,
            Tiling::Chosen => 0,
        };
        let made = self.made.take().filter(|made| made.size == size);
        let memory = made.map_or_else(|| self.allocate(stage, size), |made| made.memory);
        let view = stage.create_view(&memory.texture, &wgpu::TextureViewDescriptor::default());
        write_uniform(stage, &self.uniform, &TableUniform { size, tile: side, padding: 0 });
        let bind = |source: &wgpu::TextureView, table: &wgpu::TextureView, shape: &wgpu::Buffer| {
            let [above, before, corner] = &memory.borders;
            let made = TableBindings { table, shape, above, before, corner, largest: &memory.largest };
            if self.is_encoded {
                EncodedTable { made, tiles: source }.group(stage, &self.layout)
            } else {
                TextureTable { made, source }.group(stage, &self.layout)
            }
        };
        let bind_group = bind(binding, &view, &self.uniform);
        let mut steps = Vec::new();
        let mut late = None;
        if let Some(other) = &memory.other {
            let other = stage.create_view(other, &wgpu::TextureViewDescriptor::default());
            let Doubling { strides, late_count } = Doubling::of(size, side);
            let last = strides.len() - 1;
            late = (late_count > 0).then_some(strides.len() - late_count);
            // Requests the steps of the largest tile too, so that they stay cached when a smaller one takes fewer.
            let is_tiled = self.design.tiling == Tiling::Tiles;
            let most = if is_tiled { Doubling::of(size, MAX_TILE).strides.len() } else { strides.len() };
            for i in 0..most.max(strides.len()) {
                let stride = strides[i.min(last)];
                let step = DoublingUniform { size, stride, tile: side, ..DoublingUniform::default() };
                let uniform = stage.uniform("antumbra doubling", &step);
                // Alternates so that the last step writes the table.
                let is_to_table = (last % 2) == (i % 2);
                let (from, to) = if is_to_table { (&other, &view) } else { (&view, &other) };
                steps.push(bind(if i == 0 { binding } else { from }, to, &uniform));
            }
            steps.truncate(strides.len());
        }
        let late = match (late, &self.pipelines, &memory.late_dispatch) {
            (Some(first), Pipelines::Doubling { choose: Some(choose), .. }, Some(late_dispatch)) => {
                Some(ConditionalSteps { first, group: LateSteps { late_dispatch }.group(stage, &choose.late_layout) })
            }
            _ => None,
        };
        self.made = Some(SizedResources { size, side, memory, view, bind_group, steps, late });
    }

    fn allocate(&self, gpu: &Gpu, size: UVec2) -> Memory {
        let texture = |scratch| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some("antumbra summed-area table"),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: self.design.sums.format(),
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            };
            gpu.device.scratch_texture(scratch, &descriptor)
        };
        let buffer = |scratch, size: u64, more: wgpu::BufferUsages| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | more;
            let label = Some("antumbra summed-area table borders");
            let descriptor = wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false };
            gpu.device.scratch_buffer(scratch, &descriptor)
        };
        let border = |i: u8, items: u32| {
            buffer(Scratch::TableBorders(i), 16 * u64::from(items.max(1)), wgpu::BufferUsages::COPY_DST)
        };
        let blocks = size.map(|n| n.div_ceil(BLOCK));
        let count = blocks.x * blocks.y;
        let has_borders = matches!(self.pipelines, Pipelines::Whole { .. });
        let has_corners = has_borders || self.design.tiling == Tiling::Chosen;
        let lines = if has_borders { count * BLOCK } else { 0 };
        let corners = if has_corners { count } else { 0 };
        let levels = blocks.max_element().next_power_of_two().min(MAX_TILE / BLOCK).ilog2() + 1;
        let (is_doubling, is_chosen) = (self.design.scan == Scan::Doubling, self.design.tiling == Tiling::Chosen);
        Memory {
            texture: texture(Scratch::SummedTable(self.part)),
            borders: [border(0, lines), border(1, lines), border(2, corners)],
            largest: buffer(Scratch::LargestSums, 4 * u64::from(levels), wgpu::BufferUsages::COPY_DST),
            other: is_doubling.then(|| texture(Scratch::DoubledTable)),
            late_dispatch: (is_doubling && is_chosen)
                .then(|| buffer(Scratch::LateDoubling, 12, wgpu::BufferUsages::INDIRECT)),
        }
    }

    /// Records one pass that reads the source and writes the table. `bind` binds groups 0 to 2 if values are encoded.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        label: &'static str,
        bind: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        let Some(made) = &self.made else { return };
        let blocks = made.blocks();
        if self.design.tiling == Tiling::Chosen {
            recorder.clear_buffer(&made.memory.largest);
        }
        recorder.compute(label, Span::Only, |pass| {
            bind(pass);
            pass.set_bind_group(if self.is_encoded { 3 } else { 0 }, &made.bind_group, &[]);
            match &self.pipelines {
                Pipelines::Whole { sum_blocks, carry: [carry, carry_corners], finish } => {
                    pass.set_pipeline(sum_blocks);
                    pass.dispatch_workgroups(blocks.x, blocks.y, 1);
                    pass.set_pipeline(carry);
                    pass.dispatch_workgroups((BLOCK * (blocks.x + blocks.y)).div_ceil(CARRY_THREADS), 1, 1);
                    pass.set_pipeline(carry_corners);
                    pass.dispatch_workgroups(blocks.y.div_ceil(CARRY_THREADS), 1, 1);
                    pass.set_pipeline(finish);
                    pass.dispatch_workgroups(blocks.x, blocks.y, 1);
                }
                Pipelines::Tiles { choose, sum_tiles } => {
                    if let Some(choose) = choose {
                        made.choose_tile(pass, choose);
                    }
                    pass.set_pipeline(sum_tiles);
                    let regions = made.size.map(|n| n.div_ceil(made.side.max(PANEL)));
                    pass.dispatch_workgroups(regions.x, regions.y, 1);
                }
                Pipelines::Doubling { choose, step } => made.double(pass, choose.as_ref(), step),
            }
        });
    }

    /// Returns the table; `None` before [`Self::prepare`].
    pub(crate) fn view(&self) -> Option<&wgpu::TextureView> {
        self.made.as_ref().map(|made| &made.view)
    }

    /// Returns the largest sums of tiles of 2^i blocks, as bits of floats; see the shader's `tile_side`.
    pub(crate) fn largest(&self) -> Option<&wgpu::Buffer> {
        self.made.as_ref().map(|made| &*made.memory.largest)
    }
}
