//! `essm`: exponential soft shadow mapping.
//!
//! Li Shen, Jieqing Feng, Baoguang Yang, "Exponential Soft Shadow Mapping", Computer Graphics Forum 32(4), 2013. The shadow
//! test is replaced by the separable e^{−c(d − z)}. It is filtered by sums of e^{cz} over rectangles of the map, which a
//! summed-area table gives in constant time. With f the filtered test:
//!
//! ```text
//! V     = e^{−cd} E[e^{cz}]                               (ESM, section 4.1)
//! z_occ = (E[z] − e^{−cd} E[z e^{cz}]) / (1 − V)          (ESM-Z, section 4.2)
//! ```
//!
//! Kernels are cut into n × n parts. A part whose V exceeds 1 + ε contains depths beyond the receiver and is filtered by 2 × 2
//! comparisons instead (section 5.2). The kernel is the light's shape at the mean blocker's depth, convolved with the pixel's
//! footprint: an ellipse, cut into rows whose ends are refined `level` times (section 5.1).
//!
//! `table` selects the storage of sums:
//! - `tile_grid`, the paper's (section 6): integers of μ bits over one depth range, with the largest tiles, up to 256 texels,
//!   in which no sum reaches 2³². With c = 80, e^{cz} is 0 nearer than 1 − 13.9 / c of the range: lit surfaces turn dark.
//! - `float`: one table of floats, whose prefix sums keep a few bits of each value.
//! - `tiles`: each tile has a plane z_t of its own, behind all its surfaces and with the tilt of the farther ones. It stores
//!   e^{c(z − z_t)} in as many bits as its size allows, so that 22 bits suffice for a tile of 32 texels whatever the scene's
//!   depth. In a perspective map z is the logarithm of depth and c is per texel width, so one exponent suits near and far. If
//!   the receiver lies so far in front of z_t that rounding could cost more than 0.002, the part is read from the map. Tiles
//!   are as large as the widest part that the light can need, and cuts between parts move to their borders, so that a part
//!   seldom lies in two tiles.
//!
//! Tiles take one pass over the map, which encodes depth when it reads it; one table takes two. With `scan = doubling` they are
//! summed as in 2013, from a texture of the basis, in the paper's passes: 4 for tiles of up to 64² texels.
//!
//! The published values contradict one another: R, the range of a float's exponent, and μ = 20. `essm:paper` uses the largest
//! exponent that μ bits hold over the range, c = μ ln 2, which lets light in at contacts, e^{−cΔ}. On `leaning-plank` at
//! 160 × 90 its rmse is .048, and no element of the paper brings it below .04 while μ is 20 (`docs/papers.md` lists each).
//!
//! Other differences from the paper; `essm:paper` restores the paper's choice wherever a parameter names it:
//! - On a receiver that is tilted against the tile's plane the mean of e^{z − d} over a part is not 1. It is divided by the
//!   mean for the two planes, which makes V a weighted mean of lit texels. Where weights would differ by more than e^±0.7 the
//!   map is read. On ground that fills a tile they do not differ, however wide the part and however low the light. The planes,
//!   and narrow search windows with fewer parts, keep the reads per pixel within 21 % over an eightfold range of light sizes,
//!   once kernels are 15 texels wide (`docs/measurements.md`). Narrower kernels have fewer parts and take fewer reads.
//! - Kernels whose parts are at most `direct_texels` wide are read from the map: comparisons about a texel apart, up to eight
//!   per side, keep contacts. Kernels that only the pixel's footprint has widened take fewer.
//! - A row of a sheared parallelogram is a rectangle; there are enough rows that its ends lie within a fifth of its width.
//! - Blockers are searched at several scales, and count where they hide a point of the light, as in `pcss` (`search = window`
//!   is the paper's one window).
//! - A part counts as hidden if the blockers found in it hide that part of the light at their own depth. Blockers nearer to the
//!   receiver hide another part, or none, like a wall beside a lamp: the part is then compared with the map again, at their own
//!   scale. At 320 × 180 the rmse of `overlap` is .029 (with one depth for all parts .045), of `lantern-wall` .030 (.041).
//! - A kernel's rows have n columns; the paper cuts each row into n × n parts, and its ends too (`cuts = squares`).
//! - An ellipse of any size has n rows, at least five, with its covariance (`ellipse_of_rows` in `kernel_rows.wesl`); the
//!   paper's N = ⌈Y / H⌉ grows with it (`cuts = squares`).
//! - The map's window is warped towards the camera's view if that makes texels there half as wide (`light_map/light_view`,
//!   *Warped windows*). Tiles sum depths without the warp, and kernels use the warp's derivative at the receiver. On
//!   `checker-far` at 1024² the error against supersampled truth is .044, in a square window .094 (`pcss` .173).
//! - The kernel of a rectangle is a parallelogram of the same covariance unless `kernel = ellipse`.
//!
//! # Limits
//! One mean depth represents all blockers, as in `pcss`: umbrae shrink under layered occluders. 2 × 2 comparisons miss detail
//! finer than half a part, which shows as faint bands in foliage. The filter treats the receiver as a plane as large as the
//! pixel, less a quarter of each half towards a neighbour that sees another surface: at an edge a shadow extends beyond it by a
//! fraction of a pixel; with `kernel = isotropic` it does not. A light's emission texture counts by its mean and covariance.

use crate::light_map::map::MapWindow;
use crate::techniques::summed::summed_area_table::{Scan, Sums, TableDesign, Tiling};
use crate::techniques::summed::{Basis, Filter, SoftDesign, SoftParams, SoftSettings, SoftTechnique};

mod params;
#[cfg(test)]
mod tests;

pub use params::{
    EssmBlockerMean, EssmCuts, EssmKernel, EssmParams, EssmRange, EssmScan, EssmSearch, EssmTable, EssmWindow,
};

/// Exponential soft shadow mapping.
pub type Essm = SoftTechnique<EssmParams>;

impl SoftParams for EssmParams {
    const NAME: &'static str = "essm";

    fn design(&self) -> SoftDesign {
        let (basis, sums, tiling) = match self.table {
            EssmTable::Tiles => (Basis::Tiles, Sums::Integer, Tiling::Tiles),
            EssmTable::TileGrid => (Basis::Exponential, Sums::Integer, Tiling::Chosen),
            EssmTable::Float => (Basis::Exponential, Sums::Float, Tiling::Whole),
        };
        let scan = match self.scan {
            EssmScan::Blocks => Scan::Blocks,
            EssmScan::Doubling => Scan::Doubling,
        };
        SoftDesign { basis, filter: Filter::Table(TableDesign { sums, scan, tiling }) }
    }

    fn settings(&self) -> SoftSettings {
        let automatic = match self.table {
            EssmTable::Tiles => EXPONENT_PER_TEXEL,
            EssmTable::TileGrid | EssmTable::Float => EXPONENT_OF_RANGE,
        };
        SoftSettings {
            map_size: self.map_size,
            window: match self.window {
                EssmWindow::Seen => MapWindow::Seen,
                EssmWindow::Square => MapWindow::Square,
            },
            bias_scale: self.bias_scale,
            exponent: if self.exponent == 0.0 { automatic } else { self.exponent },
            value_bits: (self.table == EssmTable::TileGrid).then_some(self.precision_bits),
            range_from_map: self.range == EssmRange::Map,
            non_planar: self.epsilon,
            subdivisions: self.subdivisions,
            search_scales: if self.search == EssmSearch::Window { 1 } else { self.search_scales },
            second_look: self.second_look && self.search == EssmSearch::Scales,
            one_window: self.search == EssmSearch::Window,
            cuts_squares: self.cuts == EssmCuts::Squares,
            row_height: self.row_height,
            refinements: self.level,
            is_ellipse: (self.kernel == EssmKernel::Ellipse).then_some(true),
            with_footprint: self.kernel != EssmKernel::Isotropic,
            footprint_ends: self.footprint_ends,
            averages_depth: self.blocker_mean == EssmBlockerMean::Depth,
            horizon: self.horizon,
            edge_goes_on: self.edge_goes_on,
            direct_texels: self.direct_texels,
            is_sparse: self.sub,
            ..SoftSettings::default()
        }
    }
}

/// Exponent per texel width; in a warped window, of a texel where the warp keeps depth unchanged: others are narrower or wider.
/// With a larger one, parts of a tilted receiver vary by more than the weighted mean tolerates; with a smaller one, shadows
/// detach. 0.1, 0.25 and 0.5 were tried on `leaning-plank` and `window`: 0.1 evaluates most parts from the tables.
const EXPONENT_PER_TEXEL: f32 = 0.1;

/// Exponent over the depth range, the paper's R: the range of a float's exponent minus the headroom of sums.
const EXPONENT_OF_RANGE: f32 = 80.0;
