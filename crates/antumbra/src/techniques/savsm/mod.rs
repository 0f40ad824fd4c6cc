//! `savsm`: summed-area variance shadow maps with penumbrae that harden towards contacts.
//!
//! Andrew Lauritzen, "Summed-Area Variance Shadow Maps", GPU Gems 3, chapter 8, 2007. A summed-area table of depth and its
//! square gives mean and variance over any rectangle in constant time; Chebyshev's inequality bounds the lit share from
//! above. The penumbra's width comes from a brute-force blocker search as in `pcss`.
//!
//! # Limits
//! One mean and one variance stand for a whole kernel: where occluders of different depths overlap, light bleeds through
//! (`overlap`), and where the kernel's mean lies beyond the receiver the bound says lit. [`vssm`](super::vssm) cuts the
//! kernel to mend the latter. The search is not constant in time, and its taps are a grid.

use crate::blocks::summed_area_table::Scan;
use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::soft_filter::{Basis, SoftDesign, SoftFilter, SoftSettings};

mod params;

pub use crate::techniques::soft_filter::TableSums;
pub use params::SavsmParams;

/// Summed-area variance shadow maps.
#[derive(Debug)]
pub struct Savsm {
    filter: SoftFilter,
}

impl Technique for Savsm {
    const KIND: TechniqueKind = TechniqueKind::Savsm;
    type Params = SavsmParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, Self::KIND) })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &SavsmParams) -> Result<(), Error> {
        let design = SoftDesign { basis: Basis::Variance, sums: params.table.sums(), scan: Scan::Blocks };
        let settings = SoftSettings {
            map_size: params.map_size,
            bias_scale: params.bias_scale,
            subdivisions: 1,
            search_scales: params.search_scales,
            search_taps: params.search_samples,
            bleeding_reduction: params.bleeding_reduction,
            may_read_map: false,
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
