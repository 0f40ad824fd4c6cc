//! `cssm`: convolution soft shadow maps.
//!
//! Thomas Annen, Zhao Dong, Tom Mertens, Philippe Bekaert, Hans-Peter Seidel, Jan Kautz, "Real-Time, All-Frequency Shadows
//! in Dynamic Scenes", SIGGRAPH 2008. The shadow test is a Fourier series of four terms in depth, whose factors part;
//! summed-area tables of the sines and cosines filter it, and those of their products with depth give the mean blocker
//! depth (eq. 10). Both sides of the step are bounded, so no part needs the map.
//!
//! # Limits
//! Four terms take an eighth of the range of depth to rise: contact shadows are lost, and what is nearer than that to its
//! receiver casts none. Five tables of four channels: at 4096² more than a gigabyte.

use crate::blocks::summed_area_table::Scan;
use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::soft_filter::{Basis, SoftDesign, SoftFilter, SoftSettings};

mod params;

pub use crate::techniques::soft_filter::TableSums;
pub use params::CssmParams;

/// Convolution soft shadow maps.
#[derive(Debug)]
pub struct Cssm {
    filter: SoftFilter,
}

impl Technique for Cssm {
    const KIND: TechniqueKind = TechniqueKind::Cssm;
    type Params = CssmParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { filter: SoftFilter::new(gpu, Self::KIND) })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &CssmParams) -> Result<(), Error> {
        let design = SoftDesign { basis: Basis::Convolution, sums: params.table.sums(), scan: Scan::Blocks };
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
