//! `moment`: moment shadow maps with four moments.
//!
//! Christoph Peters, Reinhard Klein, "Moment Shadow Mapping", I3D 2015; quantisation and bias after Peters, Münstermann,
//! Wetzstein, Klein, "Improved Moment Shadow Maps for Translucent Occluders, Soft Shadows and Single Scattering", JCGT 2017.
//! Among all depth distributions that have the filtered moments, a closed form finds the one with least in front of the
//! receiver. Its bound is sharper than that of two moments, and exact for two occluders over a receiver, at 64 bits per texel.
//!
//! # Limits
//! Three or more occluders under one kernel leave light bleeding, weaker than `vsm`'s. Rounding makes the fourth moment
//! uncertain, so moments are moved towards a valid distribution (a fraction 6·10⁻⁵ of the way in 16 bits). This brightens
//! shadows within a few thousandths of the light's range of their occluder. The width is in texels, the same for every
//! occluder.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::primitives::packed_map::Packing;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::filterable::{BasisShaders, Filterable, PreparedBasis};

pub(crate) mod gpu_types;
mod params;

use gpu_types::MomentUniform;
pub use params::{FourMomentStorage, MomentParams, MomentProblem};

/// Moment shadow maps.
#[derive(Debug)]
pub struct Moment {
    map: Filterable<MomentUniform>,
}

impl Technique for Moment {
    const NAME: &'static str = "moment";
    type Params = MomentParams;
    type Prepared = PreparedBasis;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::MOMENT_ENCODE,
            encode_multisampled: shaders::MOMENT_ENCODE_MULTISAMPLED,
            resolve: shaders::MOMENT_RESOLVE,
        };
        Ok(Self { map: Filterable::new(gpu, Self::NAME, shaders) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &MomentParams,
    ) -> Result<PreparedBasis, Error> {
        // Peters et al. 2017, section 2.3, for 16 bits. In floats, the filter's sums and the single-precision solver round.
        let (packing, moment_bias) = match params.storage {
            FourMomentStorage::Unorm16 => (Packing::Unorm16, 6e-5),
            FourMomentStorage::Float32 => (Packing::Float32, 5e-6),
        };
        let uniform = MomentUniform {
            moment_bias,
            is_bounded: (params.problem == MomentProblem::Hausdorff).into(),
            ..MomentUniform::default()
        };
        let map = self.map.prepare_map(stage, frame, &params.settings())?;
        Ok(self.map.prepare_basis(stage, &map, 4, packing, packing.step(), &uniform, None))
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
