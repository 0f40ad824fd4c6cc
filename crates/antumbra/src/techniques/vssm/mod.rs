//! `vssm`: variance soft shadow mapping.
//!
//! Baoguang Yang, Zhao Dong, Jieqing Feng, Hans-Peter Seidel, Jan Kautz, "Variance Soft Shadow Mapping", Computer Graphics
//! Forum 29(7), 2010. The mean blocker depth, too, comes from mean and variance: with V the lit share by Chebyshev's
//! inequality and what is lit taken to lie at the receiver's own depth, mean = V t + (1 − V) z (eq. 5). Kernels are cut
//! into n × n parts; a part whose mean lies beyond the receiver, where the inequality says nothing, is filtered by 2 × 2
//! comparisons (section 4.2).
//!
//! # Limits
//! Light bleeds where occluders of different depths overlap within one part (`overlap`). Tilted receivers have a variance
//! of their own, which softens what falls on them. One mean depth stands for all blockers, as in `pcss`.

use crate::blocks::summed_area_table::Scan;
use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::soft_filter::{Basis, SoftDesign, SoftFilter, SoftSettings};

mod params;

pub use crate::techniques::soft_filter::TableSums;
pub use params::VssmParams;

/// Variance soft shadow mapping.
#[derive(Debug)]
pub struct Vssm {
    filter: SoftFilter,
}

impl Technique for Vssm {
    const KIND: TechniqueKind = TechniqueKind::Vssm;
    type Params = VssmParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, Self::KIND) })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &VssmParams) -> Result<(), Error> {
        let design = SoftDesign { basis: Basis::Variance, sums: params.table.sums(), scan: Scan::Blocks };
        let settings = SoftSettings {
            map_size: params.map_size,
            bias_scale: params.bias_scale,
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
