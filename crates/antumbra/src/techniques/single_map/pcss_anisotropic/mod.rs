//! `pcss_anisotropic`: percentage-closer soft shadows filtered over the light's shape and the pixel's footprint at once.
//!
//! Li Shen, Gaël Guennebaud, Baoguang Yang, Jieqing Feng, "Predicted Virtual Soft Shadow Maps with High Quality
//! Filtering", Computer Graphics Forum 30(2), 2011. A pixel far away covers many texels of the map, along one direction
//! more than along the other; a filter of the light's shape alone aliases, because its taps miss what lies between. Here the pixel's
//! square, projected to the map through the receiver's plane, and the light's shape at the blockers' depth add their
//! covariances, and the filter is a parallelogram of the sum with two horizontal sides, or for round lights an ellipse
//! (`kernel = parallelogram` is the paper's for all), sampled by brute force.
//!
//! The search is that of [`pcss`](super::pcss). The paper's virtual shadow maps of predicted resolution are not part of this
//! technique.
//!
//! # Limits
//! Those of `pcss`. The filter treats the receiver as a plane as large as the pixel, less a quarter of each half towards a
//! neighbour that sees another surface: so a shadow extends by part of a pixel beyond an edge of its receiver.
//! A kernel that covers many texels needs more taps than the default 64.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, MapSettings};
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::pcss::gpu_types::PcssUniform;
use crate::techniques::single_map::pcss::search_constants;
use crate::techniques::single_map::taps::{TapLists, TapUse, Taps};
use crate::techniques::single_map::{MapResolve, PreparedMapResolve, ResolvePass};

mod params;

pub use params::{AnisotropicKernel, PcssAnisotropicParams};

/// Percentage-closer soft shadows over the light's shape and the pixel's footprint.
#[derive(Debug)]
pub struct PcssAnisotropic {
    resolve: MapResolve<PcssUniform>,
}

impl Technique for PcssAnisotropic {
    const NAME: &'static str = "pcss_anisotropic";
    type Params = PcssAnisotropicParams;
    type Prepared = PreparedMapResolve;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let wgsl = shaders::PCSS_ANISOTROPIC_RESOLVE;
        Ok(Self { resolve: MapResolve::new(gpu, Self::NAME, wgsl, &[("LIGHT_KIND", 0.0)], MapSearch::Layers) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &PcssAnisotropicParams,
    ) -> Result<PreparedMapResolve, Error> {
        let taps = Taps { light: frame.light, set: params.sample_set, seed: params.seed, run: stage.noise_frame() };
        let search = (taps, TapUse::Search, params.search_samples);
        let lists = TapLists([search, (taps, TapUse::Square, params.samples)]);
        let light = LightSpread::of(frame.light);
        let uniform = PcssUniform {
            rotate: params.rotate.into(),
            bias_scale: params.bias_scale,
            is_ellipse: match params.kernel {
                AnisotropicKernel::Light => light.is_round,
                AnisotropicKernel::Parallelogram => false,
                AnisotropicKernel::Ellipse => true,
            }
            .into(),
            light_covariance: light.covariance,
            light_mean: light.mean,
            ..PcssUniform::of(params.search_samples, params.samples, &light)
        };
        let pass = ResolvePass {
            map: MapSettings::square(params.map_size),
            constants: &search_constants(frame.light),
            is_sparse: params.sub,
        };
        lists.with_kernel(|kernel| self.resolve.prepare(stage, frame, &pass, &uniform, kernel))
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMapResolve) {
        self.resolve.record(recorder, frame, prepared);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.resolve.drawn_map()
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}
