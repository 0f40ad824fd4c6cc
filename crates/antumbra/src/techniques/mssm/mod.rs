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

use crate::contract::TechniqueKind;
use crate::techniques::soft_filter::{Basis, SoftDesign, SoftParams, SoftSettings, SoftTechnique};

mod params;

pub use crate::techniques::soft_filter::TableSums;
pub use params::MssmParams;

/// Moment soft shadow mapping.
pub type Mssm = SoftTechnique<MssmParams>;

impl SoftParams for MssmParams {
    const KIND: TechniqueKind = TechniqueKind::Mssm;

    fn design(&self) -> SoftDesign {
        SoftDesign::one_table(Basis::Moment, self.table.sums())
    }

    fn settings(&self) -> SoftSettings {
        SoftSettings {
            map_size: self.map_size,
            bias_scale: self.bias_scale,
            subdivisions: self.subdivisions,
            search_scales: self.search_scales,
            bleeding_reduction: self.bleeding_reduction,
            ..SoftSettings::default()
        }
    }
}
