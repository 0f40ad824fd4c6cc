//! `cssm`: convolution soft shadow maps.
//!
//! Thomas Annen, Zhao Dong, Tom Mertens, Philippe Bekaert, Hans-Peter Seidel, Jan Kautz, "Real-Time, All-Frequency Shadows
//! in Dynamic Scenes", SIGGRAPH 2008. The shadow test is a separable Fourier series of four terms in depth. Summed-area tables
//! of the sines and cosines filter it, and those of their products with depth give the mean blocker depth (eq. 10). Both sides
//! of the step are bounded, so no piece needs the map.
//!
//! # Limits
//! Four terms take an eighth of the depth range to rise: contact shadows are lost, and geometry nearer than that to its
//! receiver casts none. Five tables of four channels take more than a gigabyte at 4096².

use crate::techniques::summed::{SoftTechnique, table_params};

pub use crate::techniques::summed::TableSums;

/// Convolution soft shadow maps.
pub type Cssm = SoftTechnique<CssmParams>;

table_params! {
    /// Parameters of [`Cssm`].
    pub struct CssmParams: "cssm" of Convolution, subdivisions = 1, search_scales = 3, second_look = false;
        => Paper {
            table: TableSums::Float, ours "32-bit integers, whose differences are exact.";
            edge_goes_on: false, ours "Casters at the map's edge are extended beyond it, for blockers closer to the light than \
                 the map covers.";
        } kept {
            "Blockers are searched at several scales, and count if they hide a point of the light; the paper has one window.",
            "Filtering uses summed-area tables of four terms, and no mip maps.",
        }
}
