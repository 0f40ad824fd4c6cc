//! `savsm`: summed-area variance shadow maps with contact hardening.
//!
//! Andrew Lauritzen, "Summed-Area Variance Shadow Maps", GPU Gems 3, chapter 8, 2007. A summed-area table of depth and its
//! square gives mean and variance over any rectangle in constant time; Chebyshev's inequality bounds the lit fraction from
//! above. The penumbra's width comes from a brute-force blocker search as in `pcss`.
//!
//! # Limits
//! One mean and one variance represent a whole kernel. Where occluders of different depths overlap, light bleeds through
//! (`overlap`), and where the kernel's mean lies beyond the receiver, the bound says lit; [`vssm`](super::vssm) cuts the kernel
//! to fix the latter. The search is not constant in time, and its taps are a regular grid.

use crate::techniques::summed::{Basis, SoftDesign, SoftParams, SoftSettings, SoftTechnique, shared_settings};

mod params;

pub use crate::techniques::summed::TableSums;
pub use params::SavsmParams;

/// Summed-area variance shadow maps.
pub type Savsm = SoftTechnique<SavsmParams>;

impl SoftParams for SavsmParams {
    const NAME: &'static str = "savsm";

    fn design(&self) -> SoftDesign {
        SoftDesign::one_table(Basis::Variance, self.table.sums())
    }

    fn settings(&self) -> SoftSettings {
        SoftSettings {
            search_taps: self.search_samples,
            may_read_map: false,
            ..shared_settings!(self, subdivisions = 1)
        }
    }
}
