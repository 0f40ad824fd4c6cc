//! Shared passes of `essm`, `savsm`, `vssm`, `cssm`, `evssm` and `mssm`: percentage-closer soft shadows that sum the map with
//! summed-area tables of a depth basis. Their time does not depend on the light's size.
//!
//! 1. *Table*: summed-area tables (`summed_area_table`) of the map's depth. Shaders encode depth when they read it
//!    (`source.wesl`, `encode.wesl`, `tile_basis.wesl`; the bases' own functions are in `primitives/depth_basis/`), so no
//!    texture stores the basis itself. Recursive doubling and mips need one; a pass *basis* writes it first.
//! 2. *Resolve*: as in `pcss`, a search for blockers at every scale, the light's shape at their mean depth, and a filter of
//!    that shape. Search windows and filter kernels are cut into `n × n` pieces, and at the borders of tiles (`pieces.wesl`). A
//!    piece takes a few table lookups (`sums.wesl`) and is compared with the receiver's plane at the piece's centre
//!    (`basis_visibility.wesl`). Where the basis cannot resolve a piece, 2 × 2 comparisons with the map replace it. Narrow
//!    kernels, whose pieces are cheaper to read from the map, are filtered with comparisons about a texel apart.
//!
//! The techniques differ in the basis and in the steps they use. Each technique's folder holds its parameters and their mapping
//! to these steps (`SoftParams`); `SoftTechnique` implements prepare and record.
//!
//! # Cost and the light's size
//! A kernel of any size is cut into `n × n` pieces, whether ellipse or parallelogram, and so is the search window of each
//! scale. Cuts move to the borders of tiles, so that a rectangle in two tiles seldom has more pieces than one in a single tile.
//! Reads per pixel grow while kernels are narrow, and are constant from about 15 texels on (`tests.rs` counts them for lights
//! up to eight times as large). Narrow search windows, near the receiver, have fewer pieces than wide ones.
//!
//! A piece is one iteration of a loop with the same body for all pieces. It reads the table's corners at its far end, because
//! the previous piece of the row ended where it begins; two more for a column that the kernel's outline cuts through, one for a
//! row; and its tile's plane. No pixel uses an indexed array.
//!
//! # Second look
//! The widest search window is as wide as the light appears at the nearest caster's depth, wherever in the window that caster
//! lies. If the mean blocker lies much nearer to the receiver, as it does within a texel or two of an object right in front of
//! a large light, most of that window hides nothing and its pieces are too wide. A second search (`second_look`) therefore uses
//! windows as wide as the light appears at that mean depth. In `hall` under a panel of 2.5 × 2 m, with casters an arm's length
//! in front of it, this lowers the error of `essm` from .087 to .042 at 573² (.053 with the fewer pieces of narrow windows). By
//! itself it lowers the error on eleven of twelve tested scenes, by up to a fifteenth, and does not change the twelfth. `cssm`
//! gains nothing, and `mssm` loses on `columns`.
//!
//! # Covers
//! A caster nearer to the light than its size hides its rim from beyond any window of the map. For lights with a caster within
//! their radius the map's edge extends beyond it, as in `pcss` (`edge_goes_on`): a strip one texel wide along the edge replaces
//! a piece beyond the map. The blockers searched for and those found must be nearer to the light than where the map holds
//! everything. A sheet 1 cm in front of a panel of 60 cm, `cover_0.01`, has .99 without it and .00 with it.
//!
//! # Integer sums
//! Table entries are integers. Differences of integers are exact however often the sums have wrapped, if the piece's own sum is
//! below 2³²; so each value may have as many bits as the largest piece leaves. A piece that cuts through texels adds the sums
//! of the cut texels separately, so that every difference is one of integers. Floats keep only 24 bits of sums over the whole
//! map, which at 1024² leaves 4 bits per value: noise (`essm`'s `table = float` and `vssm`'s show it).

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

/// Depth basis that the tables store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Basis {
    /// Exponentials of depth in front of each tile's own plane.
    Tiles = 0,
    /// Exponentials over one depth range.
    Exponential = 1,
    Variance = 2,
    ExponentialVariance = 3,
    Moment = 4,
    Convolution = 5,
}

/// Filter of the basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Filter {
    /// Summed-area table.
    Table(TableDesign),
    /// Mip chain of floats.
    Mips,
}

/// Key of the pipelines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SoftDesign {
    pub(crate) basis: Basis,
    pub(crate) filter: Filter,
}

impl SoftDesign {
    /// Returns the design with one table for the whole map.
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

    /// Whether tables encode depth when they read it, so that no texture stores the basis.
    fn is_encoded(self) -> bool {
        matches!(self.filter, Filter::Table(TableDesign { scan: Scan::Blocks, .. }))
    }
}

/// Settings that may change from frame to frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SoftSettings {
    pub(crate) map_size: MapSize,
    pub(crate) window: MapWindow,
    pub(crate) bias_scale: f32,
    /// Exponent of the basis; for [`Basis::Tiles`] per texel width.
    pub(crate) exponent: f32,
    pub(crate) negative_exponent: f32,
    /// Bits of a value; `None` for as many as pieces allow.
    pub(crate) value_bits: Option<u32>,
    /// Whether the depth range is that of the map's contents; otherwise that of the light's view.
    pub(crate) range_from_map: bool,
    pub(crate) non_planar: f32,
    pub(crate) subdivisions: u32,
    pub(crate) search_scales: u32,
    /// Number of taps of a blocker search in the map; 0 searches the tables.
    pub(crate) search_taps: u32,
    /// Whether blockers are searched again in windows fitted to their mean, if it lies much nearer to the receiver.
    pub(crate) second_look: bool,
    /// Whether the search uses one window and counts all that is in it, instead of several scales.
    pub(crate) one_window: bool,
    /// Whether each row of a kernel is cut into n × n pieces instead of n columns.
    pub(crate) cuts_squares: bool,
    pub(crate) row_height: f32,
    pub(crate) refinements: u32,
    /// Whether the kernel is an ellipse; `None` follows the light's shape.
    pub(crate) is_ellipse: Option<bool>,
    pub(crate) with_footprint: bool,
    /// Whether the footprint ends where a neighbouring pixel shows another surface.
    pub(crate) footprint_ends: bool,
    /// Whether the mean over blockers is of their depth instead of g.
    pub(crate) averages_depth: bool,
    /// Whether the light's part below the receiver's plane counts as hidden.
    pub(crate) horizon: bool,
    /// Whether the map's edge extends beyond it, for blockers nearer to the light than the map holds.
    pub(crate) edge_goes_on: bool,
    /// Largest width of pieces that are read from the map, texels.
    pub(crate) direct_texels: f32,
    pub(crate) bleeding_reduction: f32,
    /// Whether 2 × 2 comparisons replace pieces that the basis cannot resolve.
    pub(crate) may_read_map: bool,
    /// Whether only every other pixel is resolved, plus those that interpolation would get wrong.
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
            // A piece barely wider than a texel is one comparison.
            direct_texels: 1.5,
            bleeding_reduction: 0.0,
            may_read_map: true,
            is_sparse: false,
        }
    }
}

/// Specialisation of the resolve shader beyond the design.
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
            // With tiles even a kernel of one piece is cut at borders.
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

/// Parameters of a technique of the family, and their mapping to passes.
pub(crate) trait SoftParams: Params {
    const NAME: &'static str;
    fn design(&self) -> SoftDesign;
    fn settings(&self) -> SoftSettings;
}

/// Technique of the family, defined by its parameters `P`.
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
