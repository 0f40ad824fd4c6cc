//! `mssm`: moment soft shadow mapping.
//!
//! Christoph Peters, Cedrick Münstermann, Nico Wetzstein, Reinhard Klein, "Improved Moment Shadow Maps for Translucent
//! Occluders, Soft Shadows and Single Scattering", Journal of Computer Graphics Techniques 6(1), 2017. A summed-area table
//! stores four moments of depth in integers. Among the depth distributions with a kernel's moments, the one with least mass in
//! front of the receiver gives the lit fraction, and the mean depth of that mass is the blockers' depth.
//!
//! # Limits
//! A kernel is represented by three depths: where more overlap, light bleeds, but less than with two moments. One mean depth
//! represents all blockers, as in `pcss`. The paper's single kernel is the default; `subdivisions` cuts it.

use crate::techniques::summed::{SoftTechnique, table_params};

pub use crate::techniques::summed::TableSums;

/// Moment soft shadow mapping.
pub type Mssm = SoftTechnique<MssmParams>;

table_params! {
    /// Parameters of [`Mssm`].
    pub struct MssmParams: "mssm" of Moment, subdivisions = 1, search_scales = 4, second_look = false
}
