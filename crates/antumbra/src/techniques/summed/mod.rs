//! Shared passes of `essm`, `savsm`, `vssm`, `cssm`, `evssm` and `mssm`: percentage-closer soft shadows whose sums over the map
//! come from summed-area tables of a depth basis, in a time that does not depend on the light's size.
//!
//! 1. *Table*: sums (`summed_area_table`) of the map's depth, encoded where it is read (`source.wesl`,
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
//! However large a kernel is, it is cut into `n × n` pieces, an ellipse as well as a parallelogram, and the search into so many
//! at each scale. Cuts move to the borders of tiles, so that what lies in two tiles has seldom more pieces than what lies in
//! one. What a pixel reads grows while kernels are narrow, and stays from about 15 texels on (`tests.rs` counts, over eight
//! times the light). Windows of the search near the receiver, which stay narrow longest, have fewer pieces than the widest.
//!
//! A piece is one turn of a loop whose body is the same for all: the table's corners at its far end, since the piece before it in
//! its row ended where it begins, two more for a column that the kernel's outline cuts through and one for a row, and its
//! tile's plane. No pixel keeps anything by an index.
//!
//! # Two looks
//! The widest window of the search is as wide as the light is seen at the nearest caster's depth, wherever that caster lies in it. Where
//! what hides the light in the mean lies much nearer the receiver, as under a texel or two of something right before a
//! large light, nearly all of that window hides nothing, and its pieces are too wide to tell: a second look (`second_look`) is
//! through windows as wide as the light is seen at that mean. In `hall` under a panel of 2.5 × 2 m, with casters an arm's length
//! before it, that takes `essm` from .087 to .042 at 573², .053 with the fewer pieces that narrow windows have; by itself it lowers
//! the error on eleven of twelve scenes tried, by up to a fifteenth, and leaves the other's. `cssm` gains nothing by it, and
//! `mssm` loses on `columns`.
//!
//! # Covers
//! Casters nearer to the light than it is large hide its rim where they lie beyond any window of the map. What the map shows at its edge
//! goes on there, as in `pcss` (`edge_goes_on`): a piece beyond the map is answered by a texel's width along the edge, where the
//! blockers that are asked for are nearer than the map holds them, and so is what is found there; for lights that a caster comes within the
//! radius of. A sheet 1 cm before a panel of 60 cm, `cover_0.01`: .99 without and .00 with it.
//!
//! # Sums that hold
//! Table entries are integers. Differences of integers are exact however often the sums have wrapped, if the part's own
//! sum is below 2³², so each value may have as many bits as the largest part leaves; a part that cuts through texels takes
//! the cut texels' sums by themselves, so that every difference is one of integers. Floats keep what 24 bits hold of sums
//! over the whole map, which at 1024² leaves 4 bits: noise (`essm`'s `table = float` and `vssm`'s show it).

use std::marker::PhantomData;

use crate::contract::{DrawnMap, Error, MapSize, Params, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::map::MapWindow;
use crate::techniques::Technique;
use crate::techniques::summed::summed_area_table::{Scan, Sums, TableDesign, Tiling};
use crate::techniques::technique::Listed;

mod basis_texture;
pub mod cssm;
pub mod essm;
pub mod evssm;
pub(crate) mod gpu_types;
pub mod mssm;
mod params;
pub mod savsm;
mod soft_filter;
#[allow(dead_code, reason = "recursive doubling is there to be measured against, by the tests")]
pub(crate) mod summed_area_table;
mod table_fit;
#[cfg(test)]
mod tests;
mod texture;
pub mod vssm;

pub use params::TableSums;
pub(crate) use params::{shared_settings, table_params};
pub(crate) use soft_filter::{PreparedSoft, SoftFilter};

/// What the tables hold.
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
    pub(crate) map_size: MapSize,
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
    /// Whether blockers are searched again about their mean, where that lies much nearer than the windows were wide.
    pub(crate) second_look: bool,
    /// One window of search, and all that is in it, in the place of scales.
    pub(crate) one_window: bool,
    /// Squares of parts of each row of a kernel, in the place of columns.
    pub(crate) cuts_squares: bool,
    pub(crate) row_height: f32,
    pub(crate) refinements: u32,
    /// `None`: as the light's shape is.
    pub(crate) is_ellipse: Option<bool>,
    pub(crate) with_footprint: bool,
    /// Whether the footprint ends where a neighbouring pixel shows another surface.
    pub(crate) footprint_ends: bool,
    /// Whether the mean of blockers is of their depth, not of g.
    pub(crate) averages_depth: bool,
    /// Whether the light's part below the receiver's plane is hidden.
    pub(crate) horizon: bool,
    /// Whether what the map shows at its edge goes on beyond it, for blockers nearer to the light than the map holds.
    pub(crate) edge_goes_on: bool,
    /// Parts up to this many texels wide are read from the map.
    pub(crate) direct_texels: f32,
    pub(crate) bleeding_reduction: f32,
    /// Whether 2 × 2 comparisons stand in where the basis cannot tell.
    pub(crate) may_read_map: bool,
    /// Whether every other pixel is looked up, and what interpolation would get wrong.
    pub(crate) is_sparse: bool,
}

impl Default for SoftSettings {
    fn default() -> Self {
        Self {
            map_size: MapSize::Texels(1024),
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
            second_look: false,
            one_window: false,
            cuts_squares: false,
            row_height: 5.0,
            refinements: 0,
            is_ellipse: Some(false),
            with_footprint: false,
            footprint_ends: false,
            averages_depth: false,
            horizon: true,
            edge_goes_on: false,
            // A part that is hardly a texel wide is one comparison.
            direct_texels: 1.5,
            bleeding_reduction: 0.0,
            may_read_map: true,
            is_sparse: false,
        }
    }
}

/// What the resolve shader is specialised to, besides the design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Specialisation {
    has_search_taps: bool,
    is_one_piece: bool,
    refinements: u32,
    second_look: bool,
    one_window: bool,
    cuts_squares: bool,
    footprint_ends: bool,
    averages_depth: bool,
    horizon: bool,
    edge_goes_on: bool,
}

impl Specialisation {
    fn of(design: SoftDesign, settings: &SoftSettings) -> Self {
        Self {
            has_search_taps: settings.search_taps > 0,
            // Tiles cut even such kernels.
            is_one_piece: settings.subdivisions == 1 && design.tiling() == Tiling::Whole,
            refinements: settings.refinements,
            second_look: settings.second_look,
            one_window: settings.one_window,
            cuts_squares: settings.cuts_squares,
            footprint_ends: settings.footprint_ends,
            averages_depth: settings.averages_depth,
            horizon: settings.horizon,
            edge_goes_on: settings.edge_goes_on,
        }
    }
}

/// What a technique of the family is: its parameters, and what they ask of the passes.
pub(crate) trait SoftParams: Params {
    const NAME: &'static str;
    fn design(&self) -> SoftDesign;
    fn settings(&self) -> SoftSettings;
}

/// A technique of the family, by its parameters.
#[derive(Debug)]
pub struct SoftTechnique<P> {
    filter: SoftFilter,
    _params: PhantomData<P>,
}

impl<P: SoftParams> Technique for SoftTechnique<P>
where
    Self: Listed,
{
    const NAME: &'static str = P::NAME;
    type Params = P;
    type Prepared = PreparedSoft;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, P::NAME), _params: PhantomData })
    }

    fn prepare(&mut self, stage: &Stage<'_>, frame: &PreparedFrame<'_>, params: &P) -> Result<PreparedSoft, Error> {
        self.filter.prepare(stage, frame, params.design(), &params.settings())
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedSoft) {
        self.filter.record(recorder, frame, prepared);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.filter.drawn_map()
    }

    fn memory_bytes(&self) -> u64 {
        self.filter.memory_bytes()
    }
}
