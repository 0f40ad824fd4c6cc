//! `pcss`: percentage-closer soft shadows, in physical units.
//!
//! Randima Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH 2005 sketches, in three steps:
//! 1. *Blocker search* over the part of the map through which the receiver can see the light (`search.wesl`).
//! 2. *Penumbra width* from the blockers' mean depth by similar triangles (`penumbra_width.wesl`).
//! 3. *Percentage-closer filtering* of that width (`filter.wesl`, whose comparisons are in `comparison.wesl`).
//!
//! With light and map in one frame, the segment from a receiver at depth `z_r` to the light point with offset `o` on
//! the light's plane crosses depth `z` at light-plane coordinates (tangents)
//!
//! ```text
//! t_r + o · (1/z − 1/z_r)        and, for a sun's direction o,   p_r + o · (z_r − z)
//! ```
//!
//! so search and filter use the light's own shape, scaled by `g = 1/z − 1/z_r`: the search at scales up to the nearest caster's,
//! the filter at the mean blocker's. The nearest caster is found per receiver in a min/max pyramid of the map, by three lookups in
//! ever smaller squares. One formula serves every shape, and softness depends on the light's size in metres alone.
//!
//! # Departures from the sketch
//! `bench/measurements.md` lists the contribution of each.
//! - A blocker is in front of the receiver's *plane* at the tap, so that tilted receivers do not block themselves, and nearer to
//!   the light than the receiver, since segments only approach the light.
//! - A receiver that faces away from the light's centre and sees part of the light is compared from its front, where blockers are farther
//!   from the light than its plane (`map_receiver.wesl`). That plane is nearly edge-on in the map, and of four texels some are behind it:
//!   so one texel decides, the nearest in front.
//! - The search covers all scales from the receiver to the nearest caster, denser near the receiver, and counts a blocker only if it hides
//!   a light point, or nearly. The sketch's window, as wide as the nearest caster requires, mostly finds surfaces that hide nothing.
//! - *Contacts* (`attach_contacts`): one mean depth lets light through under blockers that are much nearer to the receiver. If the nearest
//!   is so near that the light's shape spans about a texel of the map, light points that are visible at the mean's scale are tested again
//!   at the nearest blocker's. Between texels an edge blurs no more than it could at that distance. Without `attach_contacts`, `pcss` has
//!   the sketch's one layer and one mean depth, which pre-filtered techniques are compared with.
//! - *Blockers hide by their own depth* (`attach_contacts`): at the mean's scale a light point falls on a texel. If that texel's surface
//!   is nearer to the receiver than a blocker that hides the point, it hides another point, or none, as a wall beside a lamp does.
//!   The point is then looked up once more, at that surface's own scale. At 320 × 180 the rmse of `overlap` is .032
//!   (at the mean's scale alone .050), of `lantern-wall` .025 (.039), of `window` .044 (.059).
//! - *Layers behind the map* (`layers`): the map holds what the light's centre sees. More layers are peeled behind it, each with its own
//!   mean; a light point is visible if no layer hides it at that layer's scale. Each costs a pass over the casters and a map.
//! - *Means of ranges* (`means=ranges`): the blockers of all layers are grouped by their `g`, in quarters of the range of `√g`, each with
//!   its own mean depth. A near and a far occluder that overlap keep their own penumbra widths.
//! - The mean is taken of `g`, which is affine in the map's depth, rather than of `z`.
//! - Light points below the receiver's horizon count as occluded. Receivers without blockers get the fraction of the light above the
//!   horizon in closed form (`light_map/horizon.wesl`); for lists of points and emission textures the taps count it.
//! - Work stops early. A search takes no more taps than its window has texels, and ends at the fourth blocker; one of fewer than 16 taps
//!   continues to 16 if it has found none. If the filter's first taps are all dark, the others count as dark, too. Contacts and layers
//!   behind the map use fewer taps. Sets without a prefix that covers the light (stratified and relaxed ones, lists of points) are used
//!   in full.
//! - Taps are positions in the light's own shape, made once per frame; each receiver maps them by one affine map, or a projective one if
//!   the light is not flat. Taps of a rectangle are shifted on the torus per pixel, all others rotated.
//!
//! # Limits
//! One mean depth represents all blockers of a layer (or of a quarter of depths): where a near and a far occluder lie side by side in it,
//! the far one gets a width between theirs, and umbrae behind thin bars are too bright. Nothing is known behind the last layer, nor
//! behind a host's own depth map. Few samples show as noise (`rotate`) or bands.

use antumbra_light::Light;

use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::gpu::{Embeddable, Gpu, Recorder, Stage};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, MapSettings};
use crate::receivers::inputs::kind_of;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::taps::{TapLists, TapUse, Taps, TapsProgram};
use crate::techniques::single_map::{MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;

use gpu_types::PcssUniform;
pub use params::{PcssCompare, PcssMeans, PcssParams};

/// Percentage-closer soft shadows.
#[derive(Debug)]
pub struct Pcss {
    resolve: MapResolve<PcssUniform>,
}

impl Technique for Pcss {
    const NAME: &'static str = "pcss";
    type Params = PcssParams;
    type Prepared = PreparedMapResolve;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let layers = PcssParams::default().layers;
        let program = PcssProgram { taps: TapsProgram::usual(layers), means_of_ranges: false };
        let constants = program.constants();
        Ok(Self { resolve: MapResolve::new(gpu, Self::NAME, shaders::PCSS_RESOLVE, &constants, MapSearch::Layers) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &PcssParams,
    ) -> Result<PreparedMapResolve, Error> {
        let run = stage.noise_frame();
        let taps = Taps { light: frame.light, set: params.sample_set, seed: params.seed, run };
        // Lists of points are used in full.
        let least = if taps.are_progressive() { MIN_BEFORE_LIT } else { 1 };
        let search_count = params.search_samples.max(least);
        let lists = TapLists([(taps, TapUse::Search, search_count), (taps, TapUse::Filter, params.samples)]);
        // With the sketch's comparison the nearest blocker would be the receiver itself. A host's map has no further layers.
        let is_own = matches!(frame.casters, PreparedCasters::Draws(_));
        let attach_contacts = params.attach_contacts && params.compare == PcssCompare::Plane;
        let layers = if is_own && attach_contacts { params.layers } else { 1 };
        let uniform = PcssUniform {
            rotate: params.rotate.into(),
            bias_scale: params.bias_scale,
            is_flat: (params.compare == PcssCompare::Flat).into(),
            attach_contacts: attach_contacts.into(),
            search_enough: params.search_samples,
            ..PcssUniform::of(search_count, params.samples, &LightSpread::of(frame.light))
        };
        let program = PcssProgram {
            taps: TapsProgram::of(&taps, layers),
            means_of_ranges: attach_contacts && params.means == PcssMeans::Ranges,
        };
        let map = MapSettings { layers, ..MapSettings::narrow(params.map_size) };
        let pass = ResolvePass { map, constants: &program.constants(), is_sparse: params.sub };
        lists.with_kernel(|kernel| self.resolve.prepare(stage, frame, &pass, &uniform, kernel))
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMapResolve) {
        self.resolve.record(recorder, frame, prepared);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.resolve.drawn_map()
    }

    fn embeddable(&self) -> Option<Embeddable> {
        self.resolve.embeddable(shaders::PCSS_SHADER_FUNCTION)
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}

/// Minimum number of search taps without a blocker before a receiver counts as lit. With 8 of them and the mean of many frames, the
/// outer penumbra on `leaning-plank` is too bright by an rmse of .016; with these, by .009.
const MIN_BEFORE_LIT: u32 = 16;

/// Override constants of the pass.
#[derive(Clone, Copy, Debug)]
struct PcssProgram {
    taps: TapsProgram,
    /// Whether there is one mean depth for each part of the range of depths, over all layers; otherwise one for each layer.
    means_of_ranges: bool,
}

impl PcssProgram {
    /// Values of the constants, by name.
    fn constants(self) -> [(&'static str, f64); 5] {
        let [kind, layers, emission, progressive] = self.taps.constants();
        [kind, layers, ("MEANS_OF_RANGES", f64::from(u8::from(self.means_of_ranges))), emission, progressive]
    }
}

/// Constants of passes that use only the search, in one layer.
pub(crate) fn search_constants(light: &Light) -> [(&'static str, f64); 1] {
    [("LIGHT_KIND", f64::from(kind_of(&light.shape)))]
}
