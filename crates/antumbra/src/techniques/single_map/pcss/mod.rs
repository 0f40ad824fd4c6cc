//! `pcss`: percentage-closer soft shadows, in physical units.
//!
//! Randima Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH 2005 sketches: (1) a blocker search over the part of
//! the map through which the receiver can see the light, (2) the penumbra's width from the blockers' mean depth by
//! similar triangles, (3) percentage-closer filtering of that width.
//!
//! With light and map in one frame, the segment from a receiver at depth `z_r` to the light point with offset `o` on
//! the light's plane crosses depth `z` at light-plane coordinates (tangents)
//!
//! ```text
//! t_r + o · (1/z − 1/z_r)        and, for a sun's direction o,   p_r + o · (z_r − z)
//! ```
//!
//! so search and filter are the light's own shape, scaled by `g = 1/z − 1/z_r`: at the nearest caster's depth for the
//! search, at the mean blocker's for the filter. The nearest caster is found per receiver in a min/max pyramid of the
//! map, by looking three times into ever smaller squares, so that a lamp beside the light does not spread everyone's
//! search over the whole map. Every shape comes out of one formula, and the light's size in metres
//! is the only softness.
//!
//! Where we depart from the sketch, and what it gave (rmse against the ray tracer, 64 + 64 taps, 320 × 180):
//! - A blocker must be in front of the receiver's *plane* at the tap, so that tilted receivers do not block themselves,
//!   and nearer to the light than the receiver, since segments to the light only come nearer to it. On `shanty` .103
//!   became .088.
//! - The sketch searches the whole window that the nearest caster's depth asks for, where most of what it finds hides no
//!   point of the light, and a lamp beside the light ruins the mean for everyone. We search at all scales from the
//!   receiver to that depth, denser near the receiver, and count a blocker only where it hides a point of the light, or
//!   nearly. With the light 5° above `tilted-planes` .095 became .072, on `window` .077 became .068, under a lamp in
//!   Sponza .46 became .22; on `overlap` .042 became .050, on `leaning-plank` .009 became .010.
//! - One mean depth lets light through at contacts, under blockers much nearer than it (`attach_contacts`). Where the
//!   nearest blocker is so near that the light's shape hardly leaves a texel of the map, light points that are free at the
//!   mean's scale are looked at again at the nearest blocker's, where only those nearer than the geometric mean of the two
//!   count. And between texels an edge blurs no more than it could at that distance. With the light at 5, 10 and 20° above
//!   `tilted-planes` umbrae at contacts let through .069, .041, .026 before and .042, .017, .021 now; `tree` .071 became
//!   .066, `shanty` .088 .085, `tilted-planes` at 5° .071 .064.
//! - The map holds what the light's centre sees alone. `layers` more are peeled behind it, and each layer's blockers have a
//!   mean of their own; a light point is seen where no layer hides it at its own scale. One more pass over the casters and
//!   one more map each, and reads where blockers lie behind blockers.
//! - Or (`means=ranges`) the blockers of all layers are parted by their `g`, in quarters of the range of `√g`, each with a
//!   mean depth of its own, which alone it counts about. Where a near and a far occluder overlap, each keeps its width.
//! - `g` is averaged, which is affine in the map's depth, rather than `z`.
//! - Light points below the receiver's horizon count as occluded. Receivers without blockers get the share of the light
//!   above it in closed form (`wesl/horizon.wesl`; a list of points and a rectangle's picture are counted by the taps).
//! - Work stops where nothing is left to find, which at 64 + 64 taps costs 1 in a hundred of rmse on eight scenes.
//!   A search takes no more taps than its window has texels, and ends at the fourth blocker: what costs is to miss the only
//!   one, not the noise of their mean. For that, one of fewer than 16 taps goes on to 16 where it has found none. Where the filter's first 40 taps are dark all are, and layers behind the map are
//!   searched only where it leaves some light. Contacts, and blockers behind blockers, are looked for by fewer of the
//!   taps. Sets of which no run of first points covers the light (stratified and relaxed ones, lists of points) are walked to
//!   their end.
//! - Taps are places in the light's own shape, made once a frame; a receiver takes them to the map by one affine map, or
//!   projective where the light is not flat. Those of a rectangle are shifted on the torus at each pixel, all others turned.
//!
//! | rmse | `overlap` | `lantern-wall` | `leaning-plank` | `stacked-panels` | `window` | `columns` | `tree` |
//! |---|---|---|---|---|---|---|---|
//! | `layers=1` | .0501 | .0429 | .0100 | .0409 | .0646 | .0215 | .0658 |
//! | `layers=2` | .0488 | .0376 | .0100 | .0265 | .0585 | .0213 | .0630 |
//! | `layers=3`, the default | .0488 | .0376 | .0100 | .0149 | .0583 | .0213 | .0624 |
//! | `layers=3`, `means=ranges` | .0211 | .0149 | .0094 | .0172 | .0241 | .0190 | .0636 |
//!
//! With the light 5° above `tilted-planes`, umbrae within five texels of a contact let through .042 with one layer and .023
//! with three: farther slabs hide the contacts from the light's middle. `attach_contacts=false` is the sketch's one layer
//! and one mean depth, which pre-filtered techniques are held against.
//!
//! # Limits
//! One mean depth stands for all blockers of a layer (of a quarter of depths): where a near and a far occluder lie side by
//! side in it, both get a width between theirs, and umbrae behind thin bars are too bright. Behind the last layer nothing is
//! known; behind a host's own depth map neither. With `means=ranges` umbrae that several thin
//! bars make together let more through (`fence-geometry` .14 for .09), as each bar is looked for in its own quarter alone.
//! Few samples show as noise (`rotate`) or bands.

use antumbra_light::Light;

use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::frame::inputs::kind_of;
use crate::gpu::{Embeddable, Gpu, Recorder, Stage};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, OwnMapSettings};
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
        // Lists are walked to their end.
        let least = if taps.are_progressive() { LEAST_BEFORE_LIT } else { 1 };
        let search_count = params.search_samples.max(least);
        let lists = TapLists([(taps, TapUse::Search, search_count), (taps, TapUse::Filter, params.samples)]);
        // What the sketch compares would find the receiver itself; a host's map is all that is known of its casters.
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
        let map = OwnMapSettings { layers, ..OwnMapSettings::narrow(params.map_size) };
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
        self.resolve.embeddable(shaders::PCSS_FUNCTION)
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}

/// No receiver counts as lit before so many taps have found no blocker: with 8 of them and the mean of many frames, the outer
/// penumbra was too bright on `leaning-plank` by a rmse of .016, with these by .009.
const LEAST_BEFORE_LIT: u32 = 16;

/// What the pass is compiled for.
#[derive(Clone, Copy, Debug)]
struct PcssProgram {
    taps: TapsProgram,
    /// One mean depth for each part of the range of depths, of all layers; otherwise one for each layer.
    means_of_ranges: bool,
}

impl PcssProgram {
    /// By their names.
    fn constants(self) -> [(&'static str, f64); 5] {
        let [kind, layers, emission, progressive] = self.taps.constants();
        [kind, layers, ("MEANS_OF_RANGES", f64::from(u8::from(self.means_of_ranges))), emission, progressive]
    }
}

/// The constants of passes that take the search alone, in one layer.
pub(crate) fn search_constants(light: &Light) -> [(&'static str, f64); 1] {
    [("LIGHT_KIND", f64::from(kind_of(&light.shape)))]
}
