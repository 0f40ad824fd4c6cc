//! `smrt`: shadow map ray tracing through layers of light maps.

use antumbra_light::{Light, LightShape};

use crate::contract::{Casters, DrawnMap, Error, Frame};
use crate::frame::inputs::kind_of;
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, OwnMapSettings};
use crate::shaders;
use crate::techniques::single_map::pcss::taps::Taps;
use crate::techniques::single_map::{MapResolve, ResolvePass};
use crate::techniques::{Technique, TechniqueKind};

pub(crate) mod gpu_types;
mod params;

use gpu_types::SmrtUniform;
pub use params::SmrtParams;

/// Shadow map ray tracing.
#[derive(Debug)]
pub struct Smrt {
    resolve: MapResolve<SmrtUniform>,
}

impl Technique for Smrt {
    const KIND: TechniqueKind = TechniqueKind::Smrt;
    type Params = SmrtParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let layers = SmrtParams::default().layers;
        let program = SmrtProgram { layers, is_progressive: true, ..SmrtProgram::default() };
        let constants = program.constants();
        Ok(Self { resolve: MapResolve::new(gpu, Self::KIND, shaders::SMRT_RESOLVE, &constants, MapSearch::Layers) })
    }

    fn prepare(&mut self, stage: &Stage<'_>, frame: &Frame<'_>, params: &SmrtParams) -> Result<(), Error> {
        let taps = Taps { light: frame.light, set: params.sample_set, seed: params.seed, run: stage.noise_frame() };
        let spread = LightSpread::of(frame.light);
        let is_own = matches!(frame.casters, Casters::Meshes(_));
        let layers = if is_own { params.layers } else { 1 };
        let program = SmrtProgram {
            light_kind: kind_of(&frame.light.shape),
            layers,
            has_emission: has_emission(frame.light),
            is_progressive: taps.are_progressive(),
        };
        let uniform = SmrtUniform {
            search_count: params.search_samples,
            ray_count: params.samples,
            most_steps: params.steps,
            rotate: params.rotate.into(),
            light_extent: spread.extent,
            light_extent_axis: spread.extent_axis,
            bias_scale: params.bias_scale,
            thickness_texels: params.thickness,
            ..SmrtUniform::default()
        };
        let taps = [taps.of_search(params.search_samples), taps.of_filter(params.samples)].concat();
        let map = OwnMapSettings { layers, ..OwnMapSettings::narrow(params.map_size) };
        let pass = ResolvePass { map, constants: &program.constants(), is_sparse: params.sub };
        self.resolve.prepare(stage, frame, &pass, &uniform, &taps)
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        self.resolve.record(recorder, frame);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.resolve.drawn_map()
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}

/// What the pass is compiled for: the constants of `light_taps.wesl` and `resolve.wesl`. By default a rectangle's.
#[derive(Clone, Copy, Debug, Default)]
struct SmrtProgram {
    /// Of a light source in `frame/light.wesl`.
    light_kind: u32,
    /// Of the casters, the light map's own included.
    layers: u32,
    /// The light is a rectangle with a picture.
    has_emission: bool,
    /// Any number of first taps covers the light.
    is_progressive: bool,
}

impl SmrtProgram {
    /// By their ids.
    fn constants(self) -> [(&'static str, f64); 4] {
        [
            ("0", f64::from(self.light_kind)),
            ("1", f64::from(self.layers)),
            ("3", f64::from(u8::from(self.has_emission))),
            ("4", f64::from(u8::from(self.is_progressive))),
        ]
    }
}

/// Whether the light is a rectangle with a picture.
fn has_emission(light: &Light) -> bool {
    matches!(light.shape, LightShape::Rectangle { .. }) && light.emission.is_some()
}
