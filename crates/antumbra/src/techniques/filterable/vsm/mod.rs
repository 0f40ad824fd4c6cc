//! `vsm`: filtered variance shadow maps.
//!
//! William Donnelly, Andrew Lauritzen, "Variance Shadow Maps", I3D 2006; numerics after Andrew Lauritzen, "Summed-Area Variance
//! Shadow Maps", GPU Gems 3, chapter 8, 2007. Each texel stores the first two moments of depth, which can be filtered like
//! colours. Chebyshev's inequality turns a filtered texel into an upper bound on visibility, which is exact for one planar
//! occluder over one planar receiver. The cost of the blur depends on the map's size, not on the image's.
//!
//! Differences from the paper: depth is linear along the light's axis. The second moment is taken about the middle of the
//! range, which keeps two more bits. The least variance comes from the receiver's plane and from the storage step, and the
//! receiver is moved towards the light as everywhere in this library, so there is no bias to tune.
//!
//! # Limits
//! Light bleeds where occluders overlap: if A and B are far apart and B is close to C, A's penumbra shows on C through B
//! (Lauritzen & McCool 2008, eq. 4). `bleeding_reduction` reduces it at the price of narrower penumbrae; [`lvsm`](super::lvsm)
//! and [`evsm`](super::evsm) remove it. The width is in texels, the same for every occluder. 16-bit storage adds noise to the
//! variance and suits ranges of at most a few metres.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::primitives::packed_map::Packing;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::filterable::{BasisShaders, Filterable, PreparedBasis};

pub(crate) mod gpu_types;
mod params;

use gpu_types::VsmUniform;
pub use params::VsmParams;

/// Variance shadow maps.
#[derive(Debug)]
pub struct Vsm {
    map: Filterable<VsmUniform>,
}

impl Technique for Vsm {
    const NAME: &'static str = "vsm";
    type Params = VsmParams;
    type Prepared = PreparedBasis;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let shaders = BasisShaders {
            encode: shaders::VSM_ENCODE,
            encode_multisampled: shaders::VSM_ENCODE_MULTISAMPLED,
            resolve: shaders::VSM_RESOLVE,
        };
        Ok(Self { map: Filterable::new(gpu, Self::NAME, shaders) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &VsmParams,
    ) -> Result<PreparedBasis, Error> {
        let packing = Packing::from(params.storage);
        let uniform = VsmUniform { bleeding_reduction: params.bleeding_reduction, ..VsmUniform::default() };
        let map = self.map.prepare_map(stage, frame, &params.settings())?;
        Ok(self.map.prepare_basis(stage, &map, 2, packing, packing.step(), &uniform, None))
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
