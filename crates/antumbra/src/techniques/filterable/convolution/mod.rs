//! `convolution`: convolution shadow maps.
//!
//! Thomas Annen, Tom Mertens, Philippe Bekaert, Hans-Peter Seidel, Jan Kautz, "Convolution Shadow Maps", EGSR 2007. The depth
//! comparison is written as a Fourier series. Its M pairs of terms are functions of the stored depth alone and can be filtered;
//! a receiver reads all of them. They are stored in 8-bit fixed point.
//!
//! Differences from the paper: the receiver is moved towards the light to the series' first maximum, which needs no tuned
//! scale. Depths are limited to 1 − 1/M of the half period, so that the far end of the range does not wrap around.
//!
//! # Limits
//! The series takes 1/(2M) of the light's range to fall, so light leaks within that distance of every contact, under every
//! occluder. Elsewhere it rings by a few percent. Every pixel reads all terms. The width is in texels, the same for every
//! occluder.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::primitives::packed_map::Packing;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::filterable::{BasisShaders, Filterable, PreparedBasis};

pub(crate) mod gpu_types;
mod params;

use gpu_types::ConvolutionUniform;
pub use params::ConvolutionParams;

/// Convolution shadow maps.
#[derive(Debug)]
pub struct Convolution {
    map: Filterable<ConvolutionUniform>,
}

impl Technique for Convolution {
    const NAME: &'static str = "convolution";
    type Params = ConvolutionParams;
    type Prepared = PreparedBasis;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::CONVOLUTION_ENCODE,
            encode_multisampled: shaders::CONVOLUTION_ENCODE_MULTISAMPLED,
            resolve: shaders::CONVOLUTION_RESOLVE,
        };
        Ok(Self { map: Filterable::new(gpu, Self::NAME, shaders) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &ConvolutionParams,
    ) -> Result<PreparedBasis, Error> {
        let uniform = ConvolutionUniform {
            term_count: params.terms,
            depth_scale: 1.0 - 1.0 / params.terms as f32,
            ..ConvolutionUniform::default()
        };
        let map = self.map.prepare_map(stage, frame, &params.settings())?;
        Ok(self.map.prepare_basis(stage, &map, 2 * params.terms, Packing::Unorm8, 0.0, &uniform, None))
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedBasis) {
        self.map.record_map(recorder, frame, prepared);
        prepared.record(recorder);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.map.drawn_map()
    }

    fn memory_bytes(&self) -> u64 {
        self.map.memory_bytes()
    }
}
