//! Passes of the family: map, pyramid, tables, resolve.
//!
//! Every frame rebuilds its tables from the map, so all lights share their memory.

use std::sync::Arc;

use antumbra_light::Aabb;
use glam::UVec2;

use super::basis_texture::{BasisPass, BasisTexture};
use super::gpu_types::SoftUniform;
use super::table_fit::{MIN_TILE, TableFit};
use super::texture::written;
use super::{Basis, Filter, SoftDesign, SoftSettings, Specialisation};
use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::gpu::{Bindings, Gpu, Recorder, Scratch, Stage, bindings, create_uniform, texels, write_uniform};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{LightMap, MapSearch, MapSettings, PreparedMap};
use crate::mask::resolve::{PreparedResolve, Resolve, ResolveShader};
use crate::receivers::inputs::FrameInputs;
use crate::shaders;
use crate::techniques::summed::summed_area_table::{Scan, Source, SummedAreaTable, Sums, Tiling};

bindings! {
    struct SoftBindings = "soft parameters", COMPUTE, group 2 of [SUMMED_RESOLVE] {
        0 soft: Uniform,
    }

    /// Summed-area tables and tile planes of the resolve pass, declared for integers; [`Sums::adapt`] converts them for floats.
    struct SoftTables = "soft tables", COMPUTE, group 3 of [SUMMED_RESOLVE] {
        0 table: Texture(texels::UINT),
        1 tiles: Texture(texels::FLOAT),
        2 largest: Storage,
        3 table_1: Texture(texels::UINT),
        4 table_2: Texture(texels::UINT),
        5 table_3: Texture(texels::UINT),
        6 table_4: Texture(texels::UINT),
    }
}

/// Number of tables of the convolution basis; every other basis has one.
const CONVOLUTION_TABLES: u8 = 5;

/// Passes of the family.
#[derive(Debug)]
pub(crate) struct SoftFilter {
    technique: &'static str,
    map: LightMap,
    inputs: FrameInputs,
    params_layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    params_group: wgpu::BindGroup,
    /// Placeholders for bindings that a design does not use.
    no_tiles: wgpu::TextureView,
    no_buffer: wgpu::Buffer,
    /// Resolve shader for integer sums that replaces the technique's own in tests.
    #[cfg(test)]
    pub(crate) test_shader: Option<&'static str>,
    resolve: Resolve,
    passes: Option<Passes>,
    made: Option<SizedTextures>,
}

/// Map, tables and resolve of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedSoft {
    map: PreparedMap,
    table_group: wgpu::BindGroup,
    resolve: PreparedResolve,
}

/// Pipelines of one design.
#[derive(Debug)]
struct Passes {
    design: SoftDesign,
    /// Pass that writes the basis to a texture; `None` if tables encode depth themselves.
    basis: Option<BasisPass>,
    /// Summed-area tables; empty when mips are used.
    tables: Vec<SummedAreaTable>,
    table_layout: wgpu::BindGroupLayout,
}

/// Textures for one map size.
#[derive(Debug)]
struct SizedTextures {
    size: UVec2,
    /// Tile planes, for the largest number of tiles that the map can have.
    tiles: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
    basis: Option<BasisTexture>,
}

impl SoftFilter {
    pub(crate) fn new(gpu: &Gpu, technique: &'static str) -> Self {
        let params_layout = SoftBindings::layout(gpu);
        let uniform = create_uniform::<SoftUniform>(gpu, "antumbra soft parameters");
        let params_group = SoftBindings { soft: &uniform }.cached_group(gpu, &params_layout);
        let no_tiles = written("antumbra no tiles", wgpu::TextureFormat::Rgba32Float, UVec2::ONE, 1);
        let no_tiles = gpu.device.create_texture(&no_tiles);
        Self {
            technique,
            map: LightMap::new(gpu, technique, MapSearch::Pyramid),
            inputs: FrameInputs::new(gpu),
            params_layout,
            uniform,
            params_group,
            no_tiles: gpu.device.create_view(&no_tiles, &wgpu::TextureViewDescriptor::default()),
            no_buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("antumbra no buffer"),
                size: 4,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            #[cfg(test)]
            test_shader: None,
            resolve: Resolve::default(),
            passes: None,
            made: None,
        }
    }

    fn make_passes(&self, gpu: &Gpu, design: SoftDesign) -> Passes {
        let sums = design.sums();
        let table_layout = SoftTables::layout_with(gpu, |ty| sums.adapt(ty));
        let layouts = [&self.inputs.layout, &self.map.layout, &self.params_layout];
        let basis = f64::from(design.basis as u32);
        let tables = match design.filter {
            Filter::Table(table) if table.scan == Scan::Blocks => {
                let wgsl = if sums == Sums::Float {
                    shaders::SUMMED_AREA_TABLE_ENCODED_FLOAT
                } else {
                    shaders::SUMMED_AREA_TABLE_ENCODED
                };
                let parts = if design.basis == Basis::Convolution { CONVOLUTION_TABLES } else { 1 };
                let of_part = |part| {
                    let constants = [("BASIS", basis), ("PART", f64::from(part))];
                    SummedAreaTable::new(gpu, table, part, &Source::Encoded { wgsl, constants: &constants, layouts })
                };
                (0..parts).map(of_part).collect()
            }
            Filter::Table(table) => vec![SummedAreaTable::new(gpu, table, 0, &Source::Texture)],
            Filter::Mips => Vec::new(),
        };
        Passes {
            design,
            basis: (!design.is_encoded()).then(|| BasisPass::new(gpu, design, layouts)),
            tables,
            table_layout,
        }
    }

    /// Prepares the resolve pass of a frame, and compiles it if its constants changed.
    fn prepare_resolve(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        design: SoftDesign,
        settings: &SoftSettings,
        table_layout: &wgpu::BindGroupLayout,
    ) -> PreparedResolve {
        let specialisation = Specialisation::of(design, settings);
        let edge_goes_on = specialisation.edge_goes_on && may_be_covered(frame);
        let wgsl = if design.sums() == Sums::Float { shaders::SUMMED_RESOLVE_FLOAT } else { shaders::SUMMED_RESOLVE };
        #[cfg(test)]
        let wgsl = self.test_shader.unwrap_or(wgsl);
        let mut constants = vec![
            ("BASIS", f64::from(design.basis as u32)),
            ("HAS_SEARCH_TAPS", f64::from(u8::from(specialisation.has_search_taps))),
            ("IS_ONE_PIECE", f64::from(u8::from(specialisation.is_one_piece))),
            ("REFINEMENTS", f64::from(specialisation.refinements)),
            ("IS_ONE_WINDOW", f64::from(u8::from(specialisation.one_window))),
            ("CUTS_SQUARES", f64::from(u8::from(specialisation.cuts_squares))),
            ("HAS_SECOND_LOOK", f64::from(u8::from(specialisation.second_look))),
            ("FOOTPRINT_ENDS", f64::from(u8::from(specialisation.footprint_ends))),
            ("AVERAGES_DEPTH", f64::from(u8::from(specialisation.averages_depth))),
            ("HAS_HORIZON", f64::from(u8::from(specialisation.horizon))),
            ("EDGE_GOES_ON", f64::from(u8::from(edge_goes_on))),
        ];
        if design.filter == Filter::Mips {
            constants.push(("IS_MIPS", 1.0));
        }
        let layouts = [&self.map.layout, &self.params_layout, table_layout];
        let shader = ResolveShader { label: self.technique, wgsl, constants: &constants, layouts: &layouts };
        self.resolve.prepare(stage, &mut self.inputs, frame, settings.is_sparse, &shader)
    }

    /// Fits the map, allocates the tables, and uploads everything.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        design: SoftDesign,
        settings: &SoftSettings,
    ) -> Result<PreparedSoft, Error> {
        let own = MapSettings {
            window: settings.window,
            derived_bytes_per_texel: bytes_per_texel(design),
            ..MapSettings::square(settings.map_size)
        };
        let map = self.map.prepare(stage, frame, own)?;
        let made = self.passes.take().filter(|passes| passes.design == design);
        let mut passes = made.unwrap_or_else(|| {
            self.made = None;
            self.make_passes(stage, design)
        });
        let resolve = self.prepare_resolve(stage, frame, design, settings, &passes.table_layout);
        let light = LightSpread::of(frame.light);
        let fit = TableFit::of(design, settings, &light, &map);
        write_uniform(stage, &self.uniform, &soft_uniform(settings, &light, fit, map.empty_depth));
        let table_group = self.prepare_tables(stage, &mut passes, map.size_px, fit.tile_side);
        self.passes = Some(passes);
        Ok(PreparedSoft { map, table_group, resolve })
    }

    fn prepare_tables(
        &mut self,
        stage: &Stage<'_>,
        passes: &mut Passes,
        size: UVec2,
        tile_side: u32,
    ) -> wgpu::BindGroup {
        let made = self.made.take().filter(|made| made.size == size);
        let (tiles, basis) = made.map_or((None, None), |made| (made.tiles, made.basis));
        let tiles = tiles.or_else(|| (passes.design.basis == Basis::Tiles).then(|| tile_planes(stage, size)));
        let planes = tiles.as_ref().map_or(&self.no_tiles, |(_, view)| view);
        let basis = passes
            .basis
            .as_ref()
            .map(|pass| pass.prepare(stage, basis, size, tiles.as_ref().map(|(_, view)| (view, tile_side))));
        let whole_basis = basis.as_ref().map(|basis| &basis.view);
        for table in &mut passes.tables {
            table.prepare(stage, whole_basis.unwrap_or(planes), size, tile_side);
        }
        let table = |i: usize| match passes.tables.last() {
            Some(last) => passes.tables.get(i).unwrap_or(last).view().expect("prepared above"),
            None => whole_basis.expect("mips are a texture"),
        };
        let largest = match passes.design.tiling() {
            Tiling::Chosen => passes.tables[0].largest(),
            Tiling::Whole | Tiling::Tiles => None,
        };
        let bound = SoftTables {
            table: table(0),
            tiles: planes,
            largest: largest.unwrap_or(&self.no_buffer),
            table_1: table(1),
            table_2: table(2),
            table_3: table(3),
            table_4: table(4),
        };
        let table_group = bound.group(stage, &passes.table_layout);
        self.made = Some(SizedTextures { size, tiles, basis });
        table_group
    }

    /// Records map, pyramid, tables and resolve.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedSoft) {
        let (Some(passes), Some(made)) = (&self.passes, &self.made) else { return };
        let PreparedSoft { map, table_group, resolve } = prepared;
        self.map.record(recorder, frame, map);
        let bind_map = |pass: &mut wgpu::ComputePass<'_>| {
            pass.set_bind_group(1, &map.group, &[]);
            pass.set_bind_group(2, &self.params_group, &[]);
        };
        let bind = |pass: &mut wgpu::ComputePass<'_>| {
            resolve.inputs().bind(pass);
            bind_map(pass);
        };
        if let (Some(pass), Some(basis)) = (&passes.basis, &made.basis) {
            pass.record(recorder, basis, bind);
        }
        for table in &passes.tables {
            table.record(recorder, "table", |pass| {
                if passes.design.is_encoded() {
                    bind(pass);
                }
            });
        }
        resolve.record(recorder, |pass| {
            bind_map(pass);
            pass.set_bind_group(3, table_group, &[]);
        });
    }

    /// Returns the map that the technique has drawn, for visualisation.
    pub(crate) fn drawn_map(&self) -> Option<DrawnMap> {
        self.map.drawn()
    }

    /// Returns the size of the light's own map and pyramid, bytes.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes()
    }
}

/// Creates the tile planes of a map of `size`, enough for the smallest tiles: tile sizes change while a light moves.
fn tile_planes(stage: &Stage<'_>, size: UVec2) -> (Arc<wgpu::Texture>, wgpu::TextureView) {
    let count = size.map(|n| n.div_ceil(MIN_TILE));
    let descriptor = written("antumbra tile planes", wgpu::TextureFormat::Rgba32Float, count, 1);
    let planes = stage.device.scratch_texture(Scratch::TilePlanes, &descriptor);
    let view = stage.create_view(&planes, &wgpu::TextureViewDescriptor::default());
    (planes, view)
}

/// Returns the memory of the tables per texel of the map, bytes, including the basis texture if there is one.
fn bytes_per_texel(design: SoftDesign) -> u32 {
    /// Bytes per texel of `Rgba32Float` and `Rgba32Uint`.
    const BYTES: u32 = 16;
    let tables = if design.basis == Basis::Convolution { CONVOLUTION_TABLES } else { 1 };
    BYTES * (u32::from(tables) + u32::from(!design.is_encoded()))
}

/// Whether a caster may hide the light's rim from beyond the map: one within the light's radius of its centre.
fn may_be_covered(frame: &PreparedFrame<'_>) -> bool {
    let PreparedCasters::Draws(meshes) = &frame.casters else { return false };
    let (center, radius_m) = (frame.light.center, frame.light.bounding_radius());
    meshes.iter().any(|mesh| {
        let Aabb { min, max } = mesh.bounds;
        center.max(min).min(max).distance(center) < radius_m
    })
}

fn soft_uniform(settings: &SoftSettings, light: &LightSpread, fit: TableFit, empty_depth: f32) -> SoftUniform {
    SoftUniform {
        light_extent: light.extent,
        light_extent_axis: light.extent_axis,
        bias_scale: settings.bias_scale,
        light_covariance: light.covariance,
        exponent: fit.exponent,
        light_mean: light.mean,
        negative_exponent: settings.negative_exponent,
        value_scale: fit.value_scale,
        tile_log2: fit.tile_log2,
        range_from_map: settings.range_from_map.into(),
        empty_depth,
        non_planar: settings.non_planar,
        subdivisions: settings.subdivisions,
        search_scales: settings.search_scales,
        search_taps: settings.search_taps,
        row_height: settings.row_height,
        is_ellipse: settings.is_ellipse.unwrap_or(light.is_round).into(),
        with_footprint: settings.with_footprint.into(),
        direct_texels: settings.direct_texels,
        max_part_texels: fit.max_part_texels,
        bleeding_reduction: settings.bleeding_reduction,
        may_read_map: settings.may_read_map.into(),
        padding_0: 0.0,
        padding_1: 0.0,
    }
}
