//! What `essm`, `savsm`, `vssm`, `cssm`, `evssm` and `mssm` share: percentage-closer soft shadows whose sums over the map
//! come from summed-area tables of a depth basis, in a time that does not depend on the light's size.
//!
//! 1. *Basis*: the map's depth, encoded (`encode.wesl`, `encode_tiles.wesl`; the bases' own functions lie in
//!    `wesl/basis/`).
//! 2. *Table*: its sums (`blocks/summed_area_table`).
//! 3. *Resolve*: as in `pcss`, a search for blockers at every scale, the light's shape at their mean depth, and a filter
//!    of that shape. Search windows and filter kernels are cut into `n × n` parts; a part takes a few table lookups. Each
//!    part is compared with the receiver's plane at its own centre. Where the basis cannot tell, and where a part is so
//!    small that reading the map is cheaper than reading the table, 2 × 2 comparisons stand in.
//!
//! The techniques differ in the basis, and in which of these steps they have.
//!
//! # Sums that hold
//! Table entries are integers. Differences of integers are exact however often the sums have wrapped, if the part's own
//! sum is below 2³², so each value may have as many bits as the largest part leaves; a part that cuts through texels takes
//! the cut texels' sums by themselves, so that every difference is one of integers. Floats keep what 24 bits hold of sums
//! over the whole map, which at 1024² leaves 4 bits: noise (`essm`'s `table = float` and `vssm`'s show it).

use glam::UVec2;

use crate::blocks::frame_inputs::FrameInputs;
use crate::blocks::summed_area_table::{Scan, SummedAreaTable, Sums, Tile};
use crate::contract::{Error, Frame, TechniqueKind};
use crate::gpu::{
    Gpu, Recorder, Span, compute_entry, create_uniform, storage_entry, texture_entry, uniform_entry, write_only_entry,
    write_uniform,
};
use crate::shaders;
use crate::techniques::map_resolve::LightMap;

pub(crate) mod gpu_types;
pub(crate) mod light_shape;
mod params;

use gpu_types::SoftUniform;
use light_shape::LightSpread;
pub use params::TableSums;

/// How far beyond the light's rim the search reaches; the same number as in the shader.
const RIM: f32 = 1.25;

/// The smallest tile with a range of its own, texels: smaller ones would cut most parts.
const LEAST_TILE: u32 = 32;

/// The largest: 32 bits less those that sums of 256² texels take leave 16 for each value.
const GREATEST_TILE: u32 = 256;

/// What the tables hold; the same numbers as in `uniform.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Basis {
    /// Exponentials of each tile's own range of depth.
    Tiles = 0,
    /// Exponentials of one range of depth.
    Exponential = 1,
    Variance = 2,
    ExponentialVariance = 3,
    Moment = 4,
    Convolution = 5,
}

/// What pipelines are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SoftDesign {
    pub(crate) basis: Basis,
    pub(crate) sums: Sums,
    pub(crate) scan: Scan,
}

/// What changes from frame to frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SoftSettings {
    pub(crate) map_size: u32,
    pub(crate) bias_scale: f32,
    /// For [`Basis::Tiles`] in units a texel's width.
    pub(crate) exponent: f32,
    pub(crate) negative_exponent: f32,
    /// One table or tiles; [`Basis::Tiles`] chooses itself.
    pub(crate) tile: Tile,
    /// Bits of a value; `None` for as many as parts leave.
    pub(crate) value_bits: Option<u32>,
    /// The range of depth is that of the map, or that of the light's view.
    pub(crate) range_from_map: bool,
    pub(crate) non_planar: f32,
    pub(crate) subdivisions: u32,
    pub(crate) search_scales: u32,
    /// Taps of a search in the map; 0 to search the tables.
    pub(crate) search_taps: u32,
    pub(crate) row_height: f32,
    pub(crate) refinements: u32,
    /// `None`: as the light's shape is.
    pub(crate) is_ellipse: Option<bool>,
    pub(crate) with_footprint: bool,
    /// Parts up to this many texels wide are read from the map.
    pub(crate) direct_texels: f32,
    pub(crate) bleeding_reduction: f32,
    /// Whether 2 × 2 comparisons stand in where the basis cannot tell.
    pub(crate) may_read_map: bool,
}

impl Default for SoftSettings {
    fn default() -> Self {
        Self {
            map_size: 1024,
            bias_scale: 1.0,
            exponent: 0.0,
            negative_exponent: 0.0,
            tile: Tile::Whole,
            value_bits: None,
            range_from_map: true,
            non_planar: 0.02,
            subdivisions: 5,
            search_scales: 4,
            search_taps: 0,
            row_height: 5.0,
            refinements: 0,
            is_ellipse: Some(false),
            with_footprint: false,
            // A part that is hardly a texel wide is one comparison.
            direct_texels: 1.5,
            bleeding_reduction: 0.0,
            may_read_map: true,
        }
    }
}

/// A pre-filtered soft technique.
#[derive(Debug)]
pub(crate) struct SoftFilter {
    kind: TechniqueKind,
    map: LightMap,
    inputs: FrameInputs,
    params_layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    params_group: wgpu::BindGroup,
    /// Stands where a design has no such binding.
    no_tiles: wgpu::TextureView,
    no_buffer: wgpu::Buffer,
    passes: Option<Passes>,
    prepared: Option<Prepared>,
}

/// Pipelines of one design.
#[derive(Debug)]
struct Passes {
    design: SoftDesign,
    encode_layout: wgpu::BindGroupLayout,
    /// One a table.
    encode: Vec<wgpu::ComputePipeline>,
    tables: Vec<SummedAreaTable>,
    table_layout: wgpu::BindGroupLayout,
    resolve: wgpu::ComputePipeline,
}

/// What is made for one size of map.
#[derive(Debug)]
struct Prepared {
    size: UVec2,
    tile_side: u32,
    /// What a table is summed from; tables take turns.
    basis: wgpu::TextureView,
    tiles: Option<wgpu::TextureView>,
    encode_group: wgpu::BindGroup,
    table_group: wgpu::BindGroup,
    encode_groups: UVec2,
}

impl SoftFilter {
    pub(crate) fn new(gpu: &Gpu, kind: TechniqueKind) -> Self {
        let params_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra soft parameters"),
            entries: &[uniform_entry(0, wgpu::ShaderStages::COMPUTE)],
        });
        let uniform = create_uniform::<SoftUniform>(gpu, "antumbra soft parameters");
        let params_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra soft parameters"),
            layout: &params_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        Self {
            kind,
            map: LightMap::new(gpu, kind.name(), true),
            inputs: FrameInputs::new(gpu),
            params_layout,
            uniform,
            params_group,
            no_tiles: texture(gpu, "antumbra no tiles", wgpu::TextureFormat::Rg32Float, UVec2::ONE),
            no_buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra no buffer"),
                size: 4,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            passes: None,
            prepared: None,
        }
    }

    fn make_passes(&self, gpu: &Gpu, design: SoftDesign) -> Passes {
        let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
        let is_float = design.sums == Sums::Float;
        let mut encode_entries = vec![write_only_entry(0, design.sums.format(), wgpu::TextureViewDimension::D2)];
        if design.basis == Basis::Tiles {
            encode_entries.push(write_only_entry(1, wgpu::TextureFormat::Rg32Float, wgpu::TextureViewDimension::D2));
        }
        let encode_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra depth basis"),
            entries: &encode_entries,
        });
        let sample_type = if is_float { unfilterable } else { wgpu::TextureSampleType::Uint };
        let table_entry = |binding| texture_entry(binding, sample_type, wgpu::TextureViewDimension::D2);
        let table_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("antumbra soft tables"),
            entries: &[
                table_entry(0),
                texture_entry(1, unfilterable, wgpu::TextureViewDimension::D2),
                storage_entry(2, wgpu::ShaderStages::COMPUTE),
                table_entry(3),
                table_entry(4),
                table_entry(5),
                table_entry(6),
            ],
        });
        let layouts = [&self.inputs.layout, &self.map.layout, &self.params_layout, &encode_layout];
        let basis = f64::from(design.basis as u32);
        let encode = if design.basis == Basis::Tiles {
            vec![compute_entry(gpu, "depth basis of tiles", shaders::SOFT_ENCODE_TILES, None, &[], &layouts)]
        } else {
            let wgsl = if is_float { shaders::SOFT_ENCODE_FLOAT } else { shaders::SOFT_ENCODE };
            let parts = if design.basis == Basis::Convolution { 5 } else { 1 };
            let of_part = |part| {
                let constants = [("0", basis), ("1", f64::from(part))];
                compute_entry(gpu, "depth basis", wgsl, None, &constants, &layouts)
            };
            (0..parts).map(of_part).collect()
        };
        let tables = encode.iter().map(|_| SummedAreaTable::new(gpu, design.sums, design.scan)).collect();
        let layouts = [&self.inputs.layout, &self.map.layout, &self.params_layout, &table_layout];
        let wgsl = if is_float { shaders::SOFT_RESOLVE_FLOAT } else { shaders::SOFT_RESOLVE };
        let resolve = compute_entry(gpu, self.kind.name(), wgsl, None, &[("0", basis)], &layouts);
        Passes { design, encode_layout, encode, tables, table_layout, resolve }
    }

    /// Fits the map, allocates the tables, and uploads everything.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        design: SoftDesign,
        settings: &SoftSettings,
    ) -> Result<(), Error> {
        self.inputs.prepare(gpu, self.kind.name(), frame)?;
        let map = self.map.prepare(gpu, frame, settings.map_size)?;
        if self.passes.as_ref().is_none_or(|passes| passes.design != design) {
            self.passes = Some(self.make_passes(gpu, design));
            self.prepared = None;
        }

        // The widest part: the light's shape at the nearest depth, as the farthest receiver sees it.
        let light = LightSpread::of(frame.light);
        let view = &map.view;
        let g = if view.perspective == 1 {
            1.0 / view.near_m.max(1e-6) - 1.0 / view.far_m
        } else {
            view.far_m - view.near_m
        };
        let map_texels = map.size_px.max_element() as f32;
        let kernel_texels = (2.0 * RIM * (light.extent.max_element() + light.extent_axis) * g / view.texel_in_plane)
            .min(map_texels)
            .max(1.0);
        let part_texels = kernel_texels / settings.subdivisions as f32 + 2.0;
        let (tile, side) = match (design.basis, settings.tile) {
            (Basis::Tiles, _) => {
                let side = (part_texels as u32).next_power_of_two().clamp(LEAST_TILE, GREATEST_TILE);
                (Tile::Side(side), side)
            }
            (_, Tile::Side(side)) => (settings.tile, side),
            (_, tile) => (tile, 0),
        };
        let tile_log2 = match tile {
            // Shifts by 31 would reach the sign.
            Tile::Whole => 30,
            Tile::Side(side) => side.ilog2(),
            Tile::Chosen => 0,
        };
        let summed_log2 = match (design.basis, tile) {
            (Basis::Tiles, Tile::Side(side)) => 2 * side.ilog2(),
            _ => (part_texels * part_texels).log2().ceil() as u32,
        };
        let bits = settings.value_bits.unwrap_or(32u32.saturating_sub(summed_log2)).clamp(8, 24);
        let is_float = design.sums == Sums::Float;
        // As printed a value of 1 is 2^μ; a part of nothing but ones must still fit where sums wrap.
        let value_scale = match (is_float, settings.value_bits) {
            (true, _) => 1.0,
            (false, Some(_)) => (1u32 << bits) as f32,
            (false, None) => ((1u32 << bits) - 1) as f32,
        };
        let exponent =
            if design.basis == Basis::Tiles { settings.exponent / view.texel_in_plane } else { settings.exponent };
        // Wrapped sums can be told apart up to this; tiles do not wrap, floats do not either.
        let max_part_texels = match (is_float, tile) {
            (false, Tile::Whole) => (1u64 << (32 - bits)) as f32,
            _ => f32::MAX,
        };
        write_uniform(
            gpu,
            &self.uniform,
            &SoftUniform {
                light_extent: light.extent,
                light_extent_axis: light.extent_axis,
                bias_scale: settings.bias_scale,
                light_covariance: light.covariance,
                exponent,
                light_mean: light.mean,
                negative_exponent: settings.negative_exponent,
                value_scale,
                tile_log2,
                range_from_map: settings.range_from_map.into(),
                empty_depth: map.empty_depth,
                non_planar: settings.non_planar,
                subdivisions: settings.subdivisions,
                search_scales: settings.search_scales,
                search_taps: settings.search_taps,
                row_height: settings.row_height,
                refinements: settings.refinements,
                is_ellipse: settings.is_ellipse.unwrap_or(light.is_round).into(),
                with_footprint: settings.with_footprint.into(),
                direct_texels: settings.direct_texels,
                max_part_texels,
                bleeding_reduction: settings.bleeding_reduction,
                may_read_map: settings.may_read_map.into(),
                padding: 0.0,
            },
        );
        self.prepare_tables(gpu, map.size_px, tile, side);
        Ok(())
    }

    fn prepare_tables(&mut self, gpu: &Gpu, size: UVec2, tile: Tile, tile_side: u32) {
        let passes = self.passes.as_mut().expect("made by prepare");
        let is_tiled = passes.design.basis == Basis::Tiles;
        let (basis, tiles) = match self.prepared.take() {
            Some(made) if (made.size, made.tile_side) == (size, tile_side) => (made.basis, made.tiles),
            _ => {
                let basis = texture(gpu, "antumbra depth basis", passes.design.sums.format(), size);
                let count = size.map(|n| n.div_ceil(tile_side.max(1)));
                let tiles =
                    is_tiled.then(|| texture(gpu, "antumbra tile ranges", wgpu::TextureFormat::Rg32Float, count));
                (basis, tiles)
            }
        };
        for table in &mut passes.tables {
            table.prepare(gpu, &basis, size, tile);
        }
        let view = |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
        let mut encode_entries = vec![view(0, &basis)];
        encode_entries.extend(tiles.as_ref().map(|tiles| view(1, tiles)));
        let encode_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra depth basis"),
            layout: &passes.encode_layout,
            entries: &encode_entries,
        });
        let table = |i: usize| passes.tables[i.min(passes.tables.len() - 1)].view().expect("prepared above");
        let largest = if tile == Tile::Chosen { passes.tables[0].largest() } else { None };
        let table_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra soft tables"),
            layout: &passes.table_layout,
            entries: &[
                view(0, table(0)),
                view(1, tiles.as_ref().unwrap_or(&self.no_tiles)),
                wgpu::BindGroupEntry { binding: 2, resource: largest.unwrap_or(&self.no_buffer).as_entire_binding() },
                view(3, table(1)),
                view(4, table(2)),
                view(5, table(3)),
                view(6, table(4)),
            ],
        });
        let encode_groups = size.map(|n| n.div_ceil(if is_tiled { tile_side } else { 8 }));
        self.prepared = Some(Prepared { size, tile_side, basis, tiles, encode_group, table_group, encode_groups });
    }

    /// Records map, pyramid, bases, tables and resolve.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let (Some(passes), Some(prepared)) = (&self.passes, &self.prepared) else { return };
        self.map.record(recorder, frame);
        let bind = |pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup| {
            self.inputs.bind(pass);
            pass.set_bind_group(1, self.map.bind_group(), &[]);
            pass.set_bind_group(2, &self.params_group, &[]);
            pass.set_bind_group(3, group, &[]);
        };
        for (encode, table) in passes.encode.iter().zip(&passes.tables) {
            recorder.compute("basis", Span::Only, |pass| {
                pass.set_pipeline(encode);
                bind(pass, &prepared.encode_group);
                pass.dispatch_workgroups(prepared.encode_groups.x, prepared.encode_groups.y, 1);
            });
            table.record(recorder, "table");
        }
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&passes.resolve);
            bind(pass, &prepared.table_group);
            self.inputs.dispatch(pass);
        });
    }

    /// Bytes of map, pyramid, basis and tables.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let tables: u64 = self.passes.iter().flat_map(|passes| &passes.tables).map(SummedAreaTable::memory_bytes).sum();
        let basis = self.prepared.as_ref().map_or(0, |made| {
            let tiles = made.size.map(|n| n.div_ceil(made.tile_side.max(1)));
            let tiles = if made.tiles.is_some() { u64::from(tiles.x) * u64::from(tiles.y) * 8 } else { 0 };
            u64::from(made.size.x) * u64::from(made.size.y) * 16 + tiles
        });
        self.map.memory_bytes() + tables + basis
    }
}

/// A texture that one pass writes and another reads.
fn texture(gpu: &Gpu, label: &str, format: wgpu::TextureFormat, size: UVec2) -> wgpu::TextureView {
    gpu.device
        .create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        })
        .create_view(&wgpu::TextureViewDescriptor::default())
}
