//! `mssm`: moment soft shadow mapping.
//!
//! Christoph Peters, Cedrick Münstermann, Nico Wetzstein, Reinhard Klein, "Improved Moment Shadow Maps for Translucent
//! Occluders, Soft Shadows and Single Scattering", Journal of Computer Graphics Techniques 6(1), 2017. A summed-area table of
//! four moments of depth, in integers; over any kernel the distribution with least mass in front of the receiver that has
//! these moments gives the lit share, and the mean depth of that mass the blockers'.
//!
//! # Limits
//! Three depths stand for a kernel: where more overlap, light bleeds, less than by two moments. One mean depth stands for
//! all blockers, as in `pcss`. The paper's single kernel is the default; `subdivisions` cuts it.

use crate::techniques::summed::{SoftTechnique, table_params};

pub use crate::techniques::summed::TableSums;

/// Moment soft shadow mapping.
pub type Mssm = SoftTechnique<MssmParams>;

table_params! {
    /// Parameters of [`Mssm`].
    pub struct MssmParams: "mssm" of Moment, subdivisions = 1, search_scales = 4, second_look = false
}
