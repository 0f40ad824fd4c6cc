//! `hard`: one depth comparison per receiver.
//!
//! Lance Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978. The scene is rendered from the light;
//! a receiver is lit where nothing in its texel is nearer. Here the comparison is with the receiver's plane at the
//! texel's centre, so that no slope bias is needed (see `light_map/bias.wesl`).
//!
//! # Limits
//! The light is a point, whatever its size: no penumbra. Edges are staircases of the map's texels, and an occluder
//! thinner than a texel can be missed.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Embeddable, Gpu, Recorder, Stage};
use crate::light_map::light_view::FollowedLight;
use crate::light_map::map::{MapSearch, MapSettings};
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::{KernelPoints, MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;

use gpu_types::HardUniform;
pub use params::HardParams;

/// The hard shadow map.
#[derive(Debug)]
pub struct Hard {
    resolve: MapResolve<HardUniform>,
}

impl Technique for Hard {
    const NAME: &'static str = "hard";
    type Params = HardParams;
    type Prepared = PreparedMapResolve;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { resolve: MapResolve::new(gpu, Self::NAME, shaders::HARD_RESOLVE, &[], MapSearch::Nothing) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &HardParams,
    ) -> Result<PreparedMapResolve, Error> {
        let uniform = HardUniform { bias_scale: params.bias_scale };
        let map = MapSettings { followed: FollowedLight::Center, ..MapSettings::narrow(params.map_size) };
        let pass = ResolvePass::of(map);
        self.resolve.prepare(stage, frame, &pass, &uniform, KernelPoints::without_points())
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMapResolve) {
        self.resolve.record(recorder, frame, prepared);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.resolve.drawn_map()
    }

    fn embeddable(&self) -> Option<Embeddable> {
        self.resolve.embeddable(shaders::HARD_SHADER_FUNCTION)
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}
