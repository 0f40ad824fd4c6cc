//! `essm`: exponential soft shadow mapping.
//!
//! Li Shen, Jieqing Feng, Baoguang Yang, "Exponential Soft Shadow Mapping", Computer Graphics Forum 32(4), 2013. The shadow
//! test is replaced by e^{−c(d − z)}, whose factors part, so that sums of e^{cz} over a rectangle of the map, in constant
//! time from a summed-area table, filter it. With f the filtered test:
//!
//! ```text
//! V     = e^{−cd} E[e^{cz}]                               (ESM, section 4.1)
//! z_occ = (E[z] − e^{−cd} E[z e^{cz}]) / (1 − V)          (ESM-Z, section 4.2)
//! ```
//!
//! Kernels are cut into n × n parts; a part whose V exceeds 1 + ε holds depths beyond the receiver and is filtered by 2 × 2
//! comparisons instead (section 5.2). The kernel is the light's shape at the mean blocker's depth, convolved with the
//! pixel's footprint: an ellipse, cut into rows, whose ends are refined `level` times (section 5.1).
//!
//! `table` says how sums are kept:
//! - `tile_grid`, the paper's (section 6): integers of μ bits on one range of depth, with the largest tiles, up to 256
//!   texels, of which no sum reaches 2³². c = 80 leaves e^{cz} nothing at depths nearer than 1 − 13.9 / c of the range, where lit turns dark.
//! - `float`: one table of floats; its prefix sums keep a few bits of each value.
//! - `tiles`: each tile has a plane z_t of its own, tilted as the farther surfaces in it are and behind all of them, and
//!   stores e^{c(z − z_t)} in as many bits as its size leaves, so that 22 bits serve a tile of 32 texels whatever the
//!   scene's depth. For a perspective map z is the logarithm of depth and c counts texel widths: one exponent suits near
//!   and far. Where the receiver lies so far in front of z_t that rounding could cost more than 0.002, the part is read
//!   from the map. Tiles are as large as the widest part that the light can ask for, and cuts between parts move to their
//!   borders, so that a part seldom lies in two of them.
//!
//! Tiles take one pass over the map, which encodes depth where it reads it; one table takes two. `scan = doubling` sums
//! them as in 2013 instead, from a texture of the basis, in the paper's passes: 4 for tiles of up to 64² texels.
//!
//! As printed R, what a float's exponent holds, goes with μ = 20; the two contradict one another. `essm:paper` has the largest
//! exponent that μ bits hold over the range, c = μ ln 2, and so lets light in at contacts, e^{−cΔ}: on `leaning-plank` at 160 × 90 its
//! rmse is .048, and no element of the paper brings it below .04 while μ is 20 (`docs/papers.md` has each by itself).
//!
//! Where else we depart from the paper; `essm:paper` turns off what a parameter names:
//! - On a receiver that is tilted against the tile's plane the mean of e^{z − d} over a part is not 1: it is divided by the
//!   two planes' own, which makes V a weighted mean of lit texels. Where weights would differ by more than e^±0.7 the map is
//!   read. On ground that fills a tile they do not differ, however wide the part and however low the light: planes, and a
//!   search whose narrow windows have fewer parts, are what keeps a pixel's reads within 21 % over eight times the light,
//!   once kernels are 15 texels wide (`docs/measurements.md`). Narrower kernels have fewer parts and take less.
//! - Kernels whose parts would be up to `direct_texels` wide are read from the map: comparisons about a texel apart, eight a
//!   side at the most, keep contacts. Those that the pixel's footprint alone has widened take fewer.
//! - A row of a sheared parallelogram is a rectangle: there are so many rows that its ends lie within a fifth of its width.
//! - Blockers are searched at several scales, and count where they hide a point of the light, as in `pcss`
//!   (`search = window` is the paper's one window).
//! - A part counts as hidden where the blockers found in it hide that part of the light by their own depth. Those nearer to the receiver
//!   hide another part, or none, as a wall beside a lamp does: the part is then compared with the map once more, at their
//!   own scale. At 320 × 180 the rmse of `overlap` is .029 (with one depth for all parts .045), of `lantern-wall` .030 (.041).
//! - A kernel's rows have n columns; the paper cuts each row into n × n parts, and its ends too (`cuts = squares`).
//! - An ellipse of any size has n rows, five at the least, which have its covariance (`ellipse_of_rows` in `kernel_rows.wesl`); the paper's N = ⌈Y / H⌉ grows
//!   with it (`cuts = squares`).
//! - The map's window is warped to what the camera sees where that makes texels there half as wide (`light_map/light_view`,
//!   *Warped windows*): tiles sum depths freed from the warp, and kernels are those of the warp's derivative at the
//!   receiver. On `checker-far` at 1024² the error against supersampled truth is .044, in a square window .094 (`pcss` .173).
//! - The kernel of a rectangle is a parallelogram of the same covariance unless `kernel = ellipse`.
//!
//! # Limits
//! One mean depth stands for all blockers, as in `pcss`: umbrae shrink under layered occluders. 2 × 2 comparisons miss what
//! is finer than half a part, which shows as faint bands in foliage. The filter takes the receiver for a plane as
//! large as the pixel, less a quarter of each half towards a neighbour that sees another surface: at an edge a shadow runs
//! on by a part of a pixel; `kernel = isotropic` does not. A
//! light's emission texture counts by its mean and covariance.

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

/// Units for the width of a texel, of a warped window where it leaves depth as it is: other texels are narrower or wider.
/// Steeper, and parts of a tilted receiver vary by more than the weighted mean bears; flatter, and shadows detach. Tried
/// on `leaning-plank` and `window` were 0.1, 0.25 and 0.5: 0.1 answers most parts from the tables.
const EXPONENT_PER_TEXEL: f32 = 0.1;

/// The paper's R: what a float's exponent holds, less what sums take.
const EXPONENT_OF_RANGE: f32 = 80.0;
