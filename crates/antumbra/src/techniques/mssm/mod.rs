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

use crate::blocks::summed_area_table::Scan;
use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::soft_filter::{Basis, SoftDesign, SoftFilter, SoftSettings};

mod params;

pub use crate::techniques::soft_filter::TableSums;
pub use params::MssmParams;

/// Moment soft shadow mapping.
#[derive(Debug)]
pub struct Mssm {
    filter: SoftFilter,
}

impl Technique for Mssm {
    const KIND: TechniqueKind = TechniqueKind::Mssm;
    type Params = MssmParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, Self::KIND) })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &MssmParams) -> Result<(), Error> {
        let design = SoftDesign { basis: Basis::Moment, sums: params.table.sums(), scan: Scan::Blocks };
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
