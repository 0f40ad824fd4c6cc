//! `evsm`: exponential variance shadow maps.
//!
//! Andrew Lauritzen, Michael McCool, "Layered Variance Shadow Maps", Graphics Interface 2008, section 7. Depth is warped by
//! e^{cu} before its moments are computed, which compresses far occluders and so removes most light bleeding. A second,
//! negative warp −e^{−cu} holds where the first fails, on receivers that are not planar. Each gives an upper bound on
//! visibility; the result is the smaller of the two.
//!
//! u runs from −1 to 1 over the light's range, so that a float holds twice the exponent that [0, 1] allows. Exponents are
//! limited so that squares can be stored: 42 in 32-bit floats, 5.5 in 16-bit ones. The defaults measured best of nine pairs of
//! exponents over the 21 built-in scenes: rmse .0611 against exact filtering; 7 and 10 have .0613, 5 and 5 .0614, 10 and 10
//! .0619. The best pairs for single scenes are 10 and 5 for foliage, 3 and 6 for hair, 10 and 20 for grass.
//!
//! # Limits
//! In foliage and wherever a kernel holds many depths, the positive warp resolves only the farthest: large exponents shade too
//! little there and flicker at edges. Exponents apply to the light's whole depth range, so in deep scenes the same exponent
//! does less. The width is in texels, the same for every occluder.

use glam::Vec2;

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::primitives::packed_map::Packing;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::filterable::{BasisShaders, Filterable, PreparedBasis};

pub(crate) mod gpu_types;
mod params;

use gpu_types::EvsmUniform;
pub use params::{EvsmComponents, EvsmParams};

/// Exponential variance shadow maps.
#[derive(Debug)]
pub struct Evsm {
    map: Filterable<EvsmUniform>,
}

impl Technique for Evsm {
    const NAME: &'static str = "evsm";
    type Params = EvsmParams;
    type Prepared = PreparedBasis;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::EVSM_ENCODE,
            encode_multisampled: shaders::EVSM_ENCODE_MULTISAMPLED,
            resolve: shaders::EVSM_RESOLVE,
        };
        Ok(Self { map: Filterable::new(gpu, Self::NAME, shaders) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &EvsmParams,
    ) -> Result<PreparedBasis, Error> {
        let packing = Packing::from(params.storage);
        // e^{2c} is the largest stored value, so c is limited to half of the logarithm of the format's maximum.
        let largest = match packing {
            Packing::Float16 => 0.5 * 65504f32.ln(),
            _ => 42.0,
        };
        let exponents = Vec2::new(params.exponent, params.exponent_negative).min(Vec2::splat(largest));
        let component_count = match params.components {
            EvsmComponents::Two => 2,
            EvsmComponents::Four => 4,
        };
        let uniform = EvsmUniform { exponents, component_count, padding: 0 };
        // Floats have a constant relative error of the warped depth w, and dw = 2c w dt.
        let t_step = packing.step() / (2.0 * exponents.min_element());
        let map = self.map.prepare_map(stage, frame, &params.settings())?;
        Ok(self.map.prepare_basis(stage, &map, component_count, packing, t_step, &uniform, None))
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
