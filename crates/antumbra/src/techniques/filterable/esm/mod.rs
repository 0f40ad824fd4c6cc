//! `esm`: exponential shadow maps.
//!
//! Thomas Annen, Tom Mertens, Hans-Peter Seidel, Eddy Flerackers, Jan Kautz, "Exponential Shadow Maps", Graphics Interface
//! 2008; Marco Salvi, "Rendering Filtered Shadows with Exponential Shadow Maps", ShaderX6, 2008. The comparison of a receiver
//! at t with a depth z is replaced by e^{−c(t − z)} = e^{−ct} · e^{cz}: one channel that can be filtered like a colour. The map
//! stores e^{c(z − 1)}, which a 32-bit float holds up to c = 80.
//!
//! # Limits
//! Shadows are too bright near contacts, within 1/c of the light's range. Where part of a kernel lies beyond the receiver,
//! e^{−c(t − z)} exceeds 1 without bound. It is clamped to lit, which eats into shadows at silhouettes and on receivers that
//! are not planar or tilt away. The width is in texels, the same for every occluder.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::primitives::packed_map::Packing;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::filterable::{BasisShaders, Filterable, PreparedBasis};

pub(crate) mod gpu_types;
mod params;

use gpu_types::EsmUniform;
pub use params::EsmParams;

/// Exponential shadow maps.
#[derive(Debug)]
pub struct Esm {
    map: Filterable<EsmUniform>,
}

impl Technique for Esm {
    const NAME: &'static str = "esm";
    type Params = EsmParams;
    type Prepared = PreparedBasis;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::ESM_ENCODE,
            encode_multisampled: shaders::ESM_ENCODE_MULTISAMPLED,
            resolve: shaders::ESM_RESOLVE,
        };
        Ok(Self { map: Filterable::new(gpu, Self::NAME, shaders) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &EsmParams,
    ) -> Result<PreparedBasis, Error> {
        let packing = Packing::Float32;
        let uniform = EsmUniform { exponent: params.exponent, ..EsmUniform::default() };
        let map = self.map.prepare_map(stage, frame, &params.settings())?;
        // Floats have a constant relative error of e^{cz}, whose derivative is c e^{cz}.
        Ok(self.map.prepare_basis(stage, &map, 1, packing, packing.step() / params.exponent, &uniform, None))
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
