//! `vssm`: variance soft shadow mapping.
//!
//! Baoguang Yang, Zhao Dong, Jieqing Feng, Hans-Peter Seidel, Jan Kautz, "Variance Soft Shadow Mapping", Computer Graphics
//! Forum 29(7), 2010. Mean and variance also give the mean blocker depth: with V the lit fraction by Chebyshev's inequality,
//! and lit texels assumed at the receiver's own depth, mean = V t + (1 − V) z (eq. 5). Kernels are cut into n × n parts. A part
//! whose mean lies beyond the receiver, where the inequality says nothing, is filtered by 2 × 2 comparisons (section 4.2).
//!
//! # Limits
//! Light bleeds where occluders of different depths overlap within one part (`overlap`). Tilted receivers have a variance of
//! their own, which softens shadows on them. One mean depth represents all blockers, as in `pcss`.

use crate::techniques::summed::{SoftTechnique, table_params};

pub use crate::techniques::summed::TableSums;

/// Variance soft shadow mapping.
pub type Vssm = SoftTechnique<VssmParams>;

table_params! {
    /// Parameters of [`Vssm`].
    pub struct VssmParams: "vssm" of Variance, subdivisions = 5, search_scales = 3, second_look = true;
        => Paper {
            table: TableSums::Float, ours "32-bit integers, whose differences are exact.";
            edge_goes_on: false, ours "Casters at the map's edge are extended beyond it, for blockers closer to the light than \
                 the map covers.";
            second_look: false, ours "Blockers are searched a second time around their mean.";
        } kept {
            "Blockers are searched at several scales, and count if they hide a point of the light; the paper has one window.",
            "A kernel has 5 × 5 parts; the paper subdivides it until parts are planar.",
        }
}
