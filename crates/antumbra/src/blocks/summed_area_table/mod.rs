//! Summed-area tables of four channels: one for a whole texture, or a grid of tiles with a table each.
//!
//! A texel of the table holds the sum of all texels of its tile that are neither to the right of it nor below it, so
//! that the sum over any rectangle inside a tile comes from four of them (Crow 1984). Sizes need be no powers of two.
//!
//! Integer sums wrap, and differences of wrapped sums are exact as long as the rectangle's own sum is below 2³²; float
//! sums lose what their 24 bits cannot hold. Within a tile chosen by [`Tile::Chosen`] nothing wraps at all.
//!
//! [`Scan::Blocks`] reads the source twice and writes the table once, whatever the size; with tiles of one block of 16
//! it reads the source once. [`Scan::Doubling`] is how it was done in 2013, kept to be measured against.

use glam::UVec2;

use crate::gpu::{
    Gpu, Recorder, Span, compute_entry, compute_pipeline, create_uniform, read_write_entry, texture_entry,
    uniform_entry, write_only_entry, write_uniform,
};
use crate::shaders;

#[cfg(test)]
mod cpu;
pub(crate) mod gpu_types;
#[cfg(test)]
mod tests;

use gpu_types::{DoublingUniform, TableUniform};

/// Texels along a side of a block, which a workgroup sums; the same number as in the shader.
pub(crate) const BLOCK: u32 = 16;

/// Sums that a step of recursive doubling gathers; the same number as in the shader.
const DOUBLING_READS: u32 = 8;

/// Threads of a workgroup that carries sums from block to block.
const CARRY_THREADS: u32 = 64;

/// What is summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sums {
    /// `Rgba32Float`.
    Float,
    /// `Rgba32Uint`, wrapping.
    Integer,
}

impl Sums {
    /// The format of source and table.
    pub(crate) fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Float => wgpu::TextureFormat::Rgba32Float,
            Self::Integer => wgpu::TextureFormat::Rgba32Uint,
        }
    }

    fn sample_type(self) -> wgpu::TextureSampleType {
        match self {
            Self::Float => wgpu::TextureSampleType::Float { filterable: false },
            Self::Integer => wgpu::TextureSampleType::Uint,
        }
    }
}

/// How large a tile is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tile {
    /// One tile for all.
    Whole,
    /// A power of two, of 16 texels at the least.
    Side(u32),
    /// The largest power of two, of 16 texels at the least, of which every sum stays below 2³²; found on the GPU from
    /// integer values (Shen et al. 2013, section 6.1). With values below 2²⁴ a tile of 16 always does.
    Chosen,
}

/// How sums travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scan {
    /// Work in proportion to the texels.
    Blocks,
    /// Passes in proportion to the tile's logarithm. Tiles cannot be [`Tile::Chosen`].
    Doubling,
}

/// Makes tables.
#[derive(Debug)]
pub(crate) struct SummedAreaTable {
    sums: Sums,
    scan: Scan,
    layout: wgpu::BindGroupLayout,
    pipelines: Pipelines,
    uniform: wgpu::Buffer,
    made: Option<Made>,
}

#[derive(Debug)]
enum Pipelines {
    Blocks {
        sum_blocks: wgpu::ComputePipeline,
        choose_tile: wgpu::ComputePipeline,
        carry: wgpu::ComputePipeline,
        carry_corners: wgpu::ComputePipeline,
        finish: wgpu::ComputePipeline,
    },
    Doubling(wgpu::ComputePipeline),
}

/// What is made for one size.
#[derive(Debug)]
struct Made {
    size: UVec2,
    tile: Tile,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    /// `above`, `before`, `corner` of blocks; empty for doubling.
    borders: Vec<wgpu::Buffer>,
    /// The largest sums of tiles of 2^i blocks.
    largest: wgpu::Buffer,
    /// The other of the two textures between which doubling goes to and fro.
    other: Option<wgpu::Texture>,
    /// One of blocks, or one a step of doubling.
    bind_groups: Vec<wgpu::BindGroup>,
}

impl SummedAreaTable {
    pub(crate) fn new(gpu: &Gpu, sums: Sums, scan: Scan) -> Self {
        let mut entries = vec![
            texture_entry(0, sums.sample_type(), wgpu::TextureViewDimension::D2),
            write_only_entry(1, sums.format(), wgpu::TextureViewDimension::D2),
            uniform_entry(2, wgpu::ShaderStages::COMPUTE),
        ];
        if scan == Scan::Blocks {
            entries.extend((3..=6).map(|binding| read_write_entry(binding, wgpu::ShaderStages::COMPUTE)));
        }
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra summed-area table"),
            entries: &entries,
        });
        let (blocks, doubling) = match sums {
            Sums::Float => (shaders::SUMMED_AREA_TABLE_FLOAT, shaders::SUMMED_AREA_DOUBLING_FLOAT),
            Sums::Integer => (shaders::SUMMED_AREA_TABLE_INTEGER, shaders::SUMMED_AREA_DOUBLING_INTEGER),
        };
        let entry = |name| compute_entry(gpu, "summed-area table", blocks, Some(name), &[], &[&layout]);
        let pipelines = match scan {
            Scan::Blocks => Pipelines::Blocks {
                sum_blocks: entry("sum_blocks"),
                choose_tile: entry("choose_tile"),
                carry: entry("carry"),
                carry_corners: entry("carry_corners"),
                finish: entry("finish"),
            },
            Scan::Doubling => {
                Pipelines::Doubling(compute_pipeline(gpu, "summed-area table doubling", doubling, &[&layout]))
            }
        };
        let uniform = create_uniform::<TableUniform>(gpu, "antumbra summed-area table");
        Self { sums, scan, layout, pipelines, uniform, made: None }
    }

    /// Allocates the table of a source of `size` texels and binds it to it. The source has the format of
    /// [`Sums::format`].
    pub(crate) fn prepare(&mut self, gpu: &Gpu, source: &wgpu::TextureView, size: UVec2, tile: Tile) {
        if self.made.as_ref().is_none_or(|made| (made.size, made.tile) != (size, tile)) {
            self.made = None;
        }
        let mut made = match self.made.take() {
            Some(made) => made,
            None => self.make(gpu, size, tile),
        };
        made.bind_groups = match self.scan {
            Scan::Blocks => {
                let uniform = TableUniform { size, tile: side_of(tile, size), padding: 0 };
                write_uniform(gpu, &self.uniform, &uniform);
                vec![self.bind_group(gpu, source, &made.view, &self.uniform, &made)]
            }
            Scan::Doubling => self.doubling_steps(gpu, source, &made),
        };
        self.made = Some(made);
    }

    fn make(&self, gpu: &Gpu, size: UVec2, tile: Tile) -> Made {
        let texture = || {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("antumbra summed-area table"),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: self.sums.format(),
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let buffer = |items: u32, bytes: u64| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra summed-area table borders"),
                size: u64::from(items) * bytes,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let blocks = size.map(|n| n.div_ceil(BLOCK));
        let borders = match self.scan {
            Scan::Blocks => {
                let count = blocks.x * blocks.y;
                vec![buffer(count * BLOCK, 16), buffer(count * BLOCK, 16), buffer(count, 16)]
            }
            Scan::Doubling => Vec::new(),
        };
        let levels = blocks.max_element().next_power_of_two().ilog2() + 1;
        let table = texture();
        Made {
            size,
            tile,
            view: table.create_view(&wgpu::TextureViewDescriptor::default()),
            texture: table,
            borders,
            largest: buffer(levels, 4),
            other: (self.scan == Scan::Doubling).then(texture),
            bind_groups: Vec::new(),
        }
    }

    fn bind_group(
        &self,
        gpu: &Gpu,
        source: &wgpu::TextureView,
        table: &wgpu::TextureView,
        uniform: &wgpu::Buffer,
        made: &Made,
    ) -> wgpu::BindGroup {
        let mut entries = vec![
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(source) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(table) },
            wgpu::BindGroupEntry { binding: 2, resource: uniform.as_entire_binding() },
        ];
        if self.scan == Scan::Blocks {
            let buffers = made.borders.iter().chain([&made.largest]);
            entries.extend(
                (3..)
                    .zip(buffers)
                    .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }),
            );
        }
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra summed-area table"),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// The steps along x, then those along y; the last writes the table.
    fn doubling_steps(&self, gpu: &Gpu, source: &wgpu::TextureView, made: &Made) -> Vec<wgpu::BindGroup> {
        let tile = side_of(made.tile, made.size);
        let reach = |n: u32| n.min(tile);
        let steps = |reach: u32| {
            std::iter::successors(Some(1), |stride: &u32| Some(stride * DOUBLING_READS))
                .take_while(move |stride| *stride < reach)
        };
        // One step at the least, so that a single texel is copied.
        let mut strides: Vec<UVec2> = steps(reach(made.size.x)).map(|x| UVec2::new(x, 0)).collect();
        strides.extend(steps(reach(made.size.y)).map(|y| UVec2::new(0, y)));
        if strides.is_empty() {
            strides.push(UVec2::new(1, 0));
        }
        let other = made.other.as_ref().expect("made for doubling");
        let views = [&made.texture, other].map(|t| t.create_view(&wgpu::TextureViewDescriptor::default()));
        let last = strides.len() - 1;
        (0..)
            .zip(&strides)
            .map(|(i, stride): (usize, _)| {
                let uniform = create_uniform::<DoublingUniform>(gpu, "antumbra doubling");
                let value = DoublingUniform { size: made.size, stride: *stride, tile, ..DoublingUniform::default() };
                write_uniform(gpu, &uniform, &value);
                let target = &views[(last - i) % 2];
                let from = if i == 0 { source } else { &views[(last - i + 1) % 2] };
                self.bind_group(gpu, from, target, &uniform, made)
            })
            .collect()
    }

    /// Reads the source, writes the table, in one pass of this label.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, label: &'static str) {
        let Some(made) = &self.made else { return };
        let blocks = made.size.map(|n| n.div_ceil(BLOCK));
        if made.tile == Tile::Chosen {
            recorder.clear_buffer(&made.largest);
        }
        recorder.compute(label, Span::Only, |pass| match &self.pipelines {
            Pipelines::Blocks { sum_blocks, choose_tile, carry, carry_corners, finish } => {
                pass.set_bind_group(0, &made.bind_groups[0], &[]);
                // A tile of one block gets nothing from others.
                if side_of(made.tile, made.size) != BLOCK {
                    pass.set_pipeline(sum_blocks);
                    pass.dispatch_workgroups(blocks.x, blocks.y, 1);
                    if made.tile == Tile::Chosen {
                        pass.set_pipeline(choose_tile);
                        pass.dispatch_workgroups((made.largest.size() / 4) as u32, 1, 1);
                    }
                    pass.set_pipeline(carry);
                    pass.dispatch_workgroups((BLOCK * (blocks.x + blocks.y)).div_ceil(CARRY_THREADS), 1, 1);
                    pass.set_pipeline(carry_corners);
                    pass.dispatch_workgroups(blocks.y.div_ceil(CARRY_THREADS), 1, 1);
                }
                pass.set_pipeline(finish);
                pass.dispatch_workgroups(blocks.x, blocks.y, 1);
            }
            Pipelines::Doubling(step) => {
                pass.set_pipeline(step);
                for bind_group in &made.bind_groups {
                    pass.set_bind_group(0, bind_group, &[]);
                    pass.dispatch_workgroups(made.size.x.div_ceil(BLOCK), made.size.y.div_ceil(BLOCK), 1);
                }
            }
        });
    }

    /// The table; after [`Self::prepare`].
    pub(crate) fn view(&self) -> Option<&wgpu::TextureView> {
        self.made.as_ref().map(|made| &made.view)
    }

    /// The largest sum of tiles of 2^i blocks, as bits of floats; see the shader's `tile_blocks_log2`.
    pub(crate) fn largest(&self) -> Option<&wgpu::Buffer> {
        self.made.as_ref().map(|made| &made.largest)
    }

    /// Bytes of the table and of what it is made with.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |made| {
            let table = u64::from(made.size.x) * u64::from(made.size.y) * 16;
            let borders: u64 = made.borders.iter().map(wgpu::Buffer::size).sum();
            table * if made.other.is_some() { 2 } else { 1 } + borders + made.largest.size()
        })
    }
}

/// Texels along a side of a tile; 0 where the GPU is to choose.
fn side_of(tile: Tile, size: UVec2) -> u32 {
    match tile {
        Tile::Whole => size.max_element().next_power_of_two().max(BLOCK),
        Tile::Side(side) => side,
        Tile::Chosen => 0,
    }
}
