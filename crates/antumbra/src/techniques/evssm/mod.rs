//! `evssm`: soft shadows from exponential variance shadow maps.
//!
//! Andrew Lauritzen, Michael McCool, "Layered Variance Shadow Maps", Graphics Interface 2008, section 7, for the basis: two
//! moments of depth warped by e^{cu} and by −e^{−cu}. Search, kernel and mean blocker depth are those of
//! [`vssm`](super::vssm), in each warp; the lesser of the two bounds counts, so no part needs the map.
//!
//! # Limits
//! The square of the warp spans e^{4c}, which integers of some 20 bits hold for c up to about 5: light bleeds more than
//! with the exponents of float maps. With `table = float` larger ones can be had, and noise with them.

use crate::blocks::summed_area_table::Scan;
use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::soft_filter::{Basis, SoftDesign, SoftFilter, SoftSettings};

mod params;

pub use crate::techniques::soft_filter::TableSums;
pub use params::EvssmParams;

/// Exponential variance soft shadow mapping.
#[derive(Debug)]
pub struct Evssm {
    filter: SoftFilter,
}

impl Technique for Evssm {
    const KIND: TechniqueKind = TechniqueKind::Evssm;
    type Params = EvssmParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, Self::KIND) })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &EvssmParams) -> Result<(), Error> {
        let design = SoftDesign { basis: Basis::ExponentialVariance, sums: params.table.sums(), scan: Scan::Blocks };
        let settings = SoftSettings {
            map_size: params.map_size,
            bias_scale: params.bias_scale,
            exponent: params.exponent,
            negative_exponent: params.negative_exponent,
            subdivisions: params.subdivisions,
            search_scales: params.search_scales,
            bleeding_reduction: params.bleeding_reduction,
            ..SoftSettings::default()
        };
        self.filter.prepare(gpu, frame, design, &settings)
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.filter.record(recorder, frame);
    }

    fn memory_bytes(&self) -> u64 {
        self.filter.memory_bytes()
    }
}
