//! `evssm`: soft shadows from exponential variance shadow maps.
//!
//! Andrew Lauritzen, Michael McCool, "Layered Variance Shadow Maps", Graphics Interface 2008, section 7, for the basis: two
//! moments each of depth warped by e^{cu} and by −e^{−cu}. Search, kernel and mean blocker depth are those of
//! [`vssm`](super::vssm), in each warp. The smaller of the two bounds counts, so no part needs the map.
//!
//! # Limits
//! The square of the warp spans e^{4c}, which integers of some 20 bits hold for c up to about 5, so light bleeds more than with
//! the exponents of float maps. `table = float` allows larger ones, with noise. `table = mips` needs no sums and allows any
//! exponent that floats hold, but a part then includes its surroundings.

use crate::techniques::summed::summed_area_table::Sums;
use crate::techniques::summed::{Basis, Filter, SoftDesign, SoftParams, SoftSettings, SoftTechnique, shared_settings};

mod params;

pub use params::{EvssmParams, EvssmTable};

/// Exponential variance soft shadow mapping.
pub type Evssm = SoftTechnique<EvssmParams>;

impl SoftParams for EvssmParams {
    const NAME: &'static str = "evssm";

    fn design(&self) -> SoftDesign {
        let one_table = |sums| SoftDesign::one_table(Basis::ExponentialVariance, sums);
        match self.table {
            EvssmTable::Integer => one_table(Sums::Integer),
            EvssmTable::Float => one_table(Sums::Float),
            EvssmTable::Mips => SoftDesign { basis: Basis::ExponentialVariance, filter: Filter::Mips },
        }
    }

    fn settings(&self) -> SoftSettings {
        SoftSettings { exponent: self.exponent, negative_exponent: self.negative_exponent, ..shared_settings!(self) }
    }
}
