//! What `essm`, `savsm`, `vssm`, `cssm`, `evssm` and `mssm` share: percentage-closer soft shadows whose sums over the map
//! come from summed-area tables of a depth basis, in a time that does not depend on the light's size.
//!
//! 1. *Table*: sums (`primitives/summed_area_table`) of the map's depth, encoded where it is read (`source.wesl`,
//!    `encode.wesl`, `tile_basis.wesl`; the bases' own functions lie in `primitives/depth_basis/`), so that no texture holds the
//!    basis itself. Recursive doubling and mips do need one: there a pass *basis* comes first.
//! 2. *Resolve*: as in `pcss`, a search for blockers at every scale, the light's shape at their mean depth, and a filter
//!    of that shape. Search windows and filter kernels are cut into `n × n` pieces and at the borders of tiles
//!    (`pieces.wesl`); a piece takes a few table lookups (`sums.wesl`) and is compared with the receiver's plane at its own
//!    centre (`answer.wesl`). Where the basis cannot tell 2 × 2 comparisons with the map stand in; kernels so narrow that
//!    their pieces are cheaper to read from the map are filtered by it, by comparisons about a texel apart.
//!
//! The techniques differ in the basis, and in which of these steps they have: each one's folder holds its parameters and
//! what they mean here (`SoftParams`); prepare and record are `SoftTechnique`'s.
//!
//! # Work that does not grow with the light
//! However large a kernel is, it is cut into `n × n` pieces, and the search into so many at each scale. Cuts move to the
//! borders of tiles, so that what lies in two tiles has seldom more pieces than what lies in one. What a pixel reads grows while
//! kernels are narrow, and stays from about 15 texels on (`tests.rs` counts, over eight times the light). Windows of the
//! search near the receiver, which stay narrow longest, have fewer pieces than the widest.
//!
//! A piece is one turn of a loop whose body is the same for all: four corners of the table, of which the last columns and rows
//! that a kernel cuts through take four more, and its tile's plane. No pixel keeps anything by an index.
//!
//! # Sums that hold
//! Table entries are integers. Differences of integers are exact however often the sums have wrapped, if the part's own
//! sum is below 2³², so each value may have as many bits as the largest part leaves; a part that cuts through texels takes
//! the cut texels' sums by themselves, so that every difference is one of integers. Floats keep what 24 bits hold of sums
//! over the whole map, which at 1024² leaves 4 bits: noise (`essm`'s `table = float` and `vssm`'s show it).

use std::marker::PhantomData;

use glam::UVec2;

use crate::contract::{Error, Frame, Params};
use crate::frame::inputs::FrameInputs;
use crate::gpu::{
    Gpu, Recorder, Span, Stage, bind_group, compute_entry, compute_pipeline, create_uniform, storage_entry,
    texture_entry, uniform_entry, write_only_entry, write_uniform,
};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{LightMap, MapSearch, MapWindow, OwnMapSettings};
use crate::primitives::summed_area_table::{MAX_TILE, Scan, Source, SummedAreaTable, Sums, TableDesign, Tiling};
use crate::shaders;
use crate::techniques::{Technique, TechniqueKind};

pub mod cssm;
pub mod essm;
pub mod evssm;
pub(crate) mod gpu_types;
pub mod mssm;
mod params;
pub mod savsm;
#[cfg(test)]
mod tests;
pub mod vssm;

use gpu_types::SoftUniform;
pub use params::TableSums;
pub(crate) use params::{shared_settings, table_params};

/// How far beyond the light's rim the search reaches; the same number as in the shader.
const RIM: f32 = 1.25;

/// The smallest tile with a range of its own, texels: smaller ones would cut most parts.
const LEAST_TILE: u32 = 32;

/// A map has so many tiles along a side at the least, so that there are workgroups enough to sum them.
const LEAST_TILES: u32 = 8;

/// What the tables hold; the same numbers as in `uniform.wesl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Basis {
    /// Exponentials of depth before each tile's own plane.
    Tiles = 0,
    /// Exponentials of one range of depth.
    Exponential = 1,
    Variance = 2,
    ExponentialVariance = 3,
    Moment = 4,
    Convolution = 5,
}

/// How the basis is filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Filter {
    /// By a summed-area table.
    Table(TableDesign),
    /// By mips of floats.
    Mips,
}

/// What pipelines are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SoftDesign {
    pub(crate) basis: Basis,
    pub(crate) filter: Filter,
}

impl SoftDesign {
    /// One table for the whole map.
    pub(crate) fn one_table(basis: Basis, sums: Sums) -> Self {
        Self { basis, filter: Filter::Table(TableDesign { sums, scan: Scan::Blocks, tiling: Tiling::Whole }) }
    }

    fn sums(self) -> Sums {
        match self.filter {
            Filter::Table(table) => table.sums,
            Filter::Mips => Sums::Float,
        }
    }

    fn tiling(self) -> Tiling {
        match self.filter {
            Filter::Table(table) => table.tiling,
            Filter::Mips => Tiling::Whole,
        }
    }

    /// Whether tables encode what they read, so that no texture holds the basis.
    fn is_encoded(self) -> bool {
        matches!(self.filter, Filter::Table(TableDesign { scan: Scan::Blocks, .. }))
    }
}

/// What changes from frame to frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SoftSettings {
    pub(crate) map_size: u32,
    pub(crate) window: MapWindow,
    pub(crate) bias_scale: f32,
    /// For [`Basis::Tiles`] in units a texel's width.
    pub(crate) exponent: f32,
    pub(crate) negative_exponent: f32,
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
            window: MapWindow::Square,
            bias_scale: 1.0,
            exponent: 0.0,
            negative_exponent: 0.0,
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

/// What the resolve shader is specialised to, besides the design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Specialisation {
    has_search_taps: bool,
    is_one_piece: bool,
    refinements: u32,
}

impl Specialisation {
    fn of(design: SoftDesign, settings: &SoftSettings) -> Self {
        Self {
            has_search_taps: settings.search_taps > 0,
            // Tiles cut even such kernels.
            is_one_piece: settings.subdivisions == 1 && design.tiling() == Tiling::Whole,
            refinements: settings.refinements,
        }
    }
}

/// What a technique of the family is: its parameters, and what they ask of the passes.
pub(crate) trait SoftParams: Params {
    const KIND: TechniqueKind;
    fn design(&self) -> SoftDesign;
    fn settings(&self) -> SoftSettings;
}

/// A technique of the family, by its parameters.
#[derive(Debug)]
pub struct SoftTechnique<P> {
    filter: SoftFilter,
    _params: PhantomData<P>,
}

impl<P: SoftParams> Technique for SoftTechnique<P> {
    const KIND: TechniqueKind = P::KIND;
    type Params = P;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, P::KIND), _params: PhantomData })
    }

    fn prepare(&mut self, stage: &Stage<'_>, frame: &Frame<'_>, params: &P) -> Result<(), Error> {
        self.filter.prepare(stage, frame, params.design(), &params.settings())
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.filter.record(recorder, frame);
    }

    fn memory_bytes(&self) -> u64 {
        self.filter.memory_bytes()
    }
}

/// The passes.
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
    /// A resolve shader for integers in the technique's own place.
    #[cfg(test)]
    pub(crate) resolve: Option<&'static str>,
    passes: Option<Passes>,
    prepared: Option<Prepared>,
}

/// Pipelines of one design.
#[derive(Debug)]
struct Passes {
    design: SoftDesign,
    specialisation: Specialisation,
    /// Of the basis' own pass, where there is one.
    basis: Option<BasisPass>,
    /// Five of the convolution basis, none for mips.
    tables: Vec<SummedAreaTable>,
    table_layout: wgpu::BindGroupLayout,
    resolve: wgpu::ComputePipeline,
}

/// Writes the basis to a texture.
#[derive(Debug)]
struct BasisPass {
    layout: wgpu::BindGroupLayout,
    encode: wgpu::ComputePipeline,
    halve_layout: wgpu::BindGroupLayout,
    halve: Option<wgpu::ComputePipeline>,
}

/// What is made for one size of map.
#[derive(Debug)]
struct Prepared {
    size: UVec2,
    tile_side: u32,
    tiles: Option<wgpu::TextureView>,
    /// For the basis' own pass.
    basis: Option<BasisTexture>,
    table_group: wgpu::BindGroup,
}

/// The basis as a texture, with its mips where those are asked for.
#[derive(Debug)]
struct BasisTexture {
    texture: wgpu::Texture,
    encode_group: wgpu::BindGroup,
    halve_groups: Vec<wgpu::BindGroup>,
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
            map: LightMap::new(gpu, kind.name(), MapSearch::Pyramid),
            inputs: FrameInputs::new(gpu),
            params_layout,
            uniform,
            params_group,
            no_tiles: view_of(gpu, &texture(gpu, "antumbra no tiles", wgpu::TextureFormat::Rgba32Float, UVec2::ONE, 1)),
            no_buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra no buffer"),
                size: 4,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            #[cfg(test)]
            resolve: None,
            passes: None,
            prepared: None,
        }
    }

    fn make_passes(&self, gpu: &Gpu, design: SoftDesign, specialisation: Specialisation) -> Passes {
        let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
        let is_float = design.sums() == Sums::Float;
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
        let layouts = [&self.inputs.layout, &self.map.layout, &self.params_layout];
        let basis = f64::from(design.basis as u32);
        let tables = match design.filter {
            Filter::Table(table) if table.scan == Scan::Blocks => {
                let wgsl = if is_float { shaders::SOFT_TABLE_FLOAT } else { shaders::SOFT_TABLE };
                let parts = if design.basis == Basis::Convolution { 5 } else { 1 };
                let of_part = |part| {
                    let constants = [("0", basis), ("1", f64::from(part))];
                    SummedAreaTable::new(gpu, table, &Source::Encoded { wgsl, constants: &constants, layouts })
                };
                (0..parts).map(of_part).collect()
            }
            Filter::Table(table) => vec![SummedAreaTable::new(gpu, table, &Source::Texture)],
            Filter::Mips => Vec::new(),
        };
        let wgsl = if is_float { shaders::SOFT_RESOLVE_FLOAT } else { shaders::SOFT_RESOLVE };
        #[cfg(test)]
        let wgsl = self.resolve.unwrap_or(wgsl);
        let mut constants = vec![
            ("0", basis),
            ("3", f64::from(u8::from(specialisation.has_search_taps))),
            ("4", f64::from(u8::from(specialisation.is_one_piece))),
            ("5", f64::from(specialisation.refinements)),
        ];
        if design.filter == Filter::Mips {
            constants.push(("2", 1.0));
        }
        let [a, b, c] = layouts;
        Passes {
            design,
            specialisation,
            basis: (!design.is_encoded()).then(|| self.make_basis_pass(gpu, design)),
            tables,
            resolve: compute_entry(gpu, self.kind.name(), wgsl, None, &constants, &[a, b, c, &table_layout]),
            table_layout,
        }
    }

    fn make_basis_pass(&self, gpu: &Gpu, design: SoftDesign) -> BasisPass {
        let format = design.sums().format();
        let write = |binding, format| write_only_entry(binding, format, wgpu::TextureViewDimension::D2);
        let has_planes = design.basis == Basis::Tiles;
        let mut entries = vec![write(0, format)];
        if has_planes {
            entries.push(write(7, wgpu::TextureFormat::Rgba32Float));
        }
        let make_layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("antumbra depth basis"),
                entries,
            })
        };
        let layout = make_layout(&entries);
        let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
        let halve_layout =
            make_layout(&[texture_entry(0, unfilterable, wgpu::TextureViewDimension::D2), write(1, format)]);
        let (wgsl, constants) = match (design.basis, design.sums()) {
            (Basis::Tiles, _) => (shaders::SOFT_ENCODE_TILES, None),
            (_, Sums::Integer) => (shaders::SOFT_ENCODE, Some(("0", f64::from(design.basis as u32)))),
            (_, Sums::Float) => (shaders::SOFT_ENCODE_FLOAT, Some(("0", f64::from(design.basis as u32)))),
        };
        let constants: Vec<_> = constants.into_iter().collect();
        let layouts = [&self.inputs.layout, &self.map.layout, &self.params_layout, &layout];
        BasisPass {
            encode: compute_entry(gpu, "depth basis", wgsl, None, &constants, &layouts),
            halve: (design.filter == Filter::Mips)
                .then(|| compute_pipeline(gpu, "mips of depth basis", shaders::SOFT_HALVE, &[&halve_layout])),
            layout,
            halve_layout,
        }
    }

    /// Fits the map, allocates the tables, and uploads everything.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &Frame<'_>,
        design: SoftDesign,
        settings: &SoftSettings,
    ) -> Result<(), Error> {
        self.inputs.prepare(stage, self.kind.name(), frame)?;
        let map = self.map.prepare(
            stage,
            frame,
            OwnMapSettings { size: settings.map_size, window: settings.window, layers: 1 },
        )?;
        let specialisation = Specialisation::of(design, settings);
        let is_made = |passes: &Passes| (passes.design, passes.specialisation) == (design, specialisation);
        if !self.passes.as_ref().is_some_and(is_made) {
            self.passes = Some(self.make_passes(stage, design, specialisation));
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
        let side = match design.tiling() {
            Tiling::Tiles => {
                let most = (map.size_px.min_element() / LEAST_TILES).max(1).next_power_of_two();
                (part_texels as u32).next_power_of_two().min(most).clamp(LEAST_TILE, MAX_TILE)
            }
            Tiling::Whole | Tiling::Chosen => 0,
        };
        let tile_log2 = match design.tiling() {
            // Shifts by 31 would reach the sign.
            Tiling::Whole => 30,
            Tiling::Tiles => side.ilog2(),
            Tiling::Chosen => 0,
        };
        let summed_log2 = match design.tiling() {
            Tiling::Tiles => 2 * side.ilog2(),
            _ => (part_texels * part_texels).log2().ceil() as u32,
        };
        let bits = settings.value_bits.unwrap_or(32u32.saturating_sub(summed_log2)).clamp(8, 24);
        let is_float = design.sums() == Sums::Float;
        // As printed a value of 1 is 2^μ; a part of nothing but ones must still fit where sums wrap.
        let value_scale = match (is_float, settings.value_bits) {
            (true, _) => 1.0,
            (false, Some(_)) => (1u32 << bits) as f32,
            (false, None) => ((1u32 << bits) - 1) as f32,
        };
        let exponent =
            if design.basis == Basis::Tiles { settings.exponent / view.texel_in_plane } else { settings.exponent };
        // Wrapped sums can be told apart up to this; tiles do not wrap, floats do not either.
        let max_part_texels = match (is_float, design.tiling()) {
            (false, Tiling::Whole) => (1u64 << (32 - bits)) as f32,
            _ => f32::MAX,
        };
        write_uniform(
            stage,
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
                is_ellipse: settings.is_ellipse.unwrap_or(light.is_round).into(),
                with_footprint: settings.with_footprint.into(),
                direct_texels: settings.direct_texels,
                max_part_texels,
                bleeding_reduction: settings.bleeding_reduction,
                may_read_map: settings.may_read_map.into(),
                padding_0: 0.0,
                padding_1: 0.0,
            },
        );
        self.prepare_tables(stage, map.size_px, side);
        Ok(())
    }

    fn prepare_tables(&mut self, stage: &Stage<'_>, size: UVec2, tile_side: u32) {
        let passes = self.passes.as_mut().expect("made by prepare");
        let design = passes.design;
        let made = self.prepared.take().filter(|made| (made.size, made.tile_side) == (size, tile_side));
        let (tiles, basis) = match made {
            Some(made) => (made.tiles, made.basis.map(|basis| basis.texture)),
            None => {
                let count = size.map(|n| n.div_ceil(tile_side.max(1)));
                let planes = || texture(stage, "antumbra tile planes", wgpu::TextureFormat::Rgba32Float, count, 1);
                let levels = if design.filter == Filter::Mips { size.max_element().ilog2() + 1 } else { 1 };
                let basis = || texture(stage, "antumbra depth basis", design.sums().format(), size, levels);
                (
                    (design.basis == Basis::Tiles).then(|| view_of(stage, &planes())),
                    passes.basis.as_ref().map(|_| basis()),
                )
            }
        };
        let planes = tiles.as_ref().unwrap_or(&self.no_tiles);
        let basis = passes.basis.as_ref().zip(basis).map(|(pass, texture)| {
            let levels: Vec<_> = (0..texture.mip_level_count()).map(|i| level_of(stage, &texture, i)).collect();
            let mut written = vec![texture_at(0, &levels[0])];
            written.extend(tiles.as_ref().map(|tiles| texture_at(7, tiles)));
            let encode_group = stage.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("antumbra depth basis"),
                layout: &pass.layout,
                entries: &written,
            });
            let halve = |pair: &[wgpu::TextureView]| {
                let pair = pair.iter().map(wgpu::BindingResource::TextureView);
                bind_group(stage, "antumbra mips of depth basis", &pass.halve_layout, pair)
            };
            let halve_groups = levels.windows(2).map(halve).collect();
            BasisTexture { texture, encode_group, halve_groups }
        });
        let whole_basis =
            basis.as_ref().map(|basis| stage.create_view(&basis.texture, &wgpu::TextureViewDescriptor::default()));
        for table in &mut passes.tables {
            table.prepare(stage, whole_basis.as_ref().unwrap_or(planes), size, tile_side);
        }
        let table = |i: usize| match passes.tables.last() {
            Some(last) => passes.tables.get(i).unwrap_or(last).view().expect("prepared above"),
            None => whole_basis.as_ref().expect("mips are a texture"),
        };
        let largest = match design.tiling() {
            Tiling::Chosen => passes.tables[0].largest(),
            Tiling::Whole | Tiling::Tiles => None,
        };
        let table_group = stage.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("antumbra soft tables"),
            layout: &passes.table_layout,
            entries: &[
                texture_at(0, table(0)),
                texture_at(1, planes),
                wgpu::BindGroupEntry { binding: 2, resource: largest.unwrap_or(&self.no_buffer).as_entire_binding() },
                texture_at(3, table(1)),
                texture_at(4, table(2)),
                texture_at(5, table(3)),
                texture_at(6, table(4)),
            ],
        });
        self.prepared = Some(Prepared { size, tile_side, tiles, basis, table_group });
    }

    /// Records map, pyramid, tables and resolve.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let (Some(passes), Some(prepared)) = (&self.passes, &self.prepared) else { return };
        self.map.record(recorder, frame);
        let bind = |pass: &mut wgpu::ComputePass<'_>| {
            self.inputs.bind(pass);
            pass.set_bind_group(1, self.map.bind_group(), &[]);
            pass.set_bind_group(2, &self.params_group, &[]);
        };
        if let (Some(pass), Some(basis)) = (&passes.basis, &prepared.basis) {
            record_basis(recorder, pass, basis, prepared, bind);
        }
        for table in &passes.tables {
            table.record(recorder, "table", |pass| {
                if passes.design.is_encoded() {
                    bind(pass);
                }
            });
        }
        recorder.compute("resolve", Span::Only, |pass| {
            pass.set_pipeline(&passes.resolve);
            bind(pass);
            pass.set_bind_group(3, &prepared.table_group, &[]);
            self.inputs.dispatch(pass);
        });
    }

    /// Bytes of map, pyramid, basis and tables.
    pub(crate) fn memory_bytes(&self) -> u64 {
        let tables: u64 = self.passes.iter().flat_map(|passes| &passes.tables).map(SummedAreaTable::memory_bytes).sum();
        let basis = self.prepared.as_ref().map_or(0, |made| {
            let texels = |size: UVec2| u64::from(size.x) * u64::from(size.y);
            let planes = made.tiles.as_ref().map_or(0, |_| 16 * texels(made.size.map(|n| n.div_ceil(made.tile_side))));
            let levels = made.basis.as_ref().map_or(0, |basis| basis.texture.mip_level_count());
            planes + (0..levels).map(|i| 16 * texels((made.size >> i).max(UVec2::ONE))).sum::<u64>()
        });
        self.map.memory_bytes() + tables + basis
    }
}

/// The basis, and its mips: a pass for each, since each reads what the one before wrote.
fn record_basis(
    recorder: &mut Recorder<'_>,
    pass: &BasisPass,
    basis: &BasisTexture,
    prepared: &Prepared,
    bind: impl Fn(&mut wgpu::ComputePass<'_>),
) {
    // A workgroup a tile, or a square of 64 texels, where tiles have planes of their own.
    let group_side = if prepared.tiles.is_some() { prepared.tile_side.max(64) } else { 8 };
    recorder.compute("basis", Span::Only, |compute| {
        compute.set_pipeline(&pass.encode);
        bind(compute);
        compute.set_bind_group(3, &basis.encode_group, &[]);
        let groups = prepared.size.map(|n| n.div_ceil(group_side));
        compute.dispatch_workgroups(groups.x, groups.y, 1);
    });
    let Some(halve) = &pass.halve else { return };
    let count = basis.halve_groups.len();
    for (i, group) in basis.halve_groups.iter().enumerate() {
        recorder.compute("mips", Span::of(i, count), |compute| {
            compute.set_pipeline(halve);
            compute.set_bind_group(0, group, &[]);
            let groups = (prepared.size >> (i as u32 + 1)).max(UVec2::ONE).map(|n| n.div_ceil(8));
            compute.dispatch_workgroups(groups.x, groups.y, 1);
        });
    }
}

/// A texture that one pass writes and another reads.
fn texture(gpu: &Gpu, label: &str, format: wgpu::TextureFormat, size: UVec2, levels: u32) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
        view_formats: &[],
    })
}

fn texture_at(binding: u32, view: &wgpu::TextureView) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) }
}

fn view_of(gpu: &Gpu, texture: &wgpu::Texture) -> wgpu::TextureView {
    gpu.device.create_view(texture, &wgpu::TextureViewDescriptor::default())
}

fn level_of(stage: &Stage<'_>, texture: &wgpu::Texture, level: u32) -> wgpu::TextureView {
    stage.create_view(
        texture,
        &wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        },
    )
}
