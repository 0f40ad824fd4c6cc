//! `bitmask`: a bit for each point of the light, set where a texel of the light map hides the point.
//!
//! Michael Schwarz, Marc Stamminger, "Bitmask Soft Shadows", Computer Graphics Forum 26(3) (Eurographics 2007), 515–524. The map
//! represents the casters: each texel is a *micro-patch*, a square at the texel's depth (`micro_patches`). Projected from the receiver
//! onto the light's plane it hides a rectangle of the light that is parallel to the map's axes; Guennebaud, Barthe, Paulin
//! ("Real-time soft shadow mapping by backprojection", EGSR 2006) add up such rectangles' areas. Here each of a set of light points has a
//! bit that records whether it is hidden: where patches overlap, a point counts once, and each further layer of casters is one more set
//! of patches.
//!
//! For each receiver:
//! 1. **Search area.** The part of the map through which the receiver sees the light, narrowed down by a min/max pyramid of the map.
//! 2. **Patches** (`window.wesl`). A quadtree over that part. A square whose nearest depth hides nothing of the light is skipped. If one
//!    surface in front of the receiver fills a square without a gap, judged by its nearest and farthest depth, the square as a whole hides
//!    what segments reach through it at all depths between; its parts are skipped if they can hide no other point. Otherwise a square whose
//!    patch may be wider than the light's width / `patches` is split, down to texels. A square of several texels shows the depth of one of
//!    them, chosen at random per pixel and evenly spread over squares: the fraction of squares that count as covered is then that of
//!    their area, whereas the nearest depth of each would darken whatever is near a silhouette. Surfaces in front of the receiver's plane
//!    are patches. The map comes first, then the layers behind it for the points that the map leaves visible.
//! 3. **Gaps** (`gaps`). The common side of two squares at different depths projects to two places on the light's plane. Each patch is
//!    extended to where its neighbours begin, corners included, as Guennebaud et al. fill gaps; with bits, overlaps do no harm. Between two
//!    occluders the gap stays open, as it is in space: the layers behind hold what one hides of the other.
//! 4. **Bits** (`light_bits.wesl`). A table of the points, sorted into 32 bins along either axis, gives those that may lie in the
//!    rectangle; they are tested one by one. The search ends when all are hidden.
//!
//! # Departures from the paper
//! `bitmask:paper` turns off the departures that have a parameter; the parameters' declarations list them.
//! - The points are those of the other single-map techniques, moved per pixel (`rotate`); the paper's are the same at all pixels, which
//!   shows bands.
//! - The table holds prefixes of bins for a rectangle's, a disk's, a sun's or a sphere's points in their own coordinates, and the points
//!   are tested exactly. All points of an ellipsoid or a list are tested.
//! - A patch blocks if it is in front of the receiver's plane at the texel's centre and nearer to the light than the receiver.
//! - Squares of a quadtree replace the paper's single level of the map for the whole search area.
//! - Points below the receiver's horizon are hidden. Receivers without blockers get the fraction of the light above it in closed form.
//!
//! # Limits
//! Silhouettes are staircases of texels, and no penumbra is narrower than a texel. Nothing is known behind the last layer, nor behind
//! a host's own depth map: light leaks in below stacked occluders. Micro-patches are parallel to the map: the paper's micro-quads between
//! texel centres are not implemented. Few points show as noise (`rotate`) or bands, and so do squares of several texels in wide
//! penumbrae. On a software renderer it takes 7 times as long as `smrt` on `columns` and `overlap`, 12 times on `tree` (320 × 180).
//! Loops are bounded by the counts of patches, layers and points.

use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, MapSettings};
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::taps::{TapLists, TapUse, Taps, TapsProgram};
use crate::techniques::single_map::{MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;
#[cfg(test)]
mod tests;

use gpu_types::{BitmaskUniform, MAX_WORDS};
pub use params::{BitmaskGaps, BitmaskParams};

/// Bitmask soft shadows.
#[derive(Debug)]
pub struct Bitmask {
    resolve: MapResolve<BitmaskUniform>,
}

impl Bitmask {
    /// Creates the technique with the given resolve shader.
    fn with_shader(gpu: &Gpu, wgsl: &'static str) -> Self {
        let defaults = BitmaskParams::default();
        let constants = constants(TapsProgram::usual(defaults.layers), defaults.samples);
        Self { resolve: MapResolve::new(gpu, Self::NAME, wgsl, &constants, MapSearch::Layers) }
    }
}

impl Technique for Bitmask {
    const NAME: &'static str = "bitmask";
    type Params = BitmaskParams;
    type Prepared = PreparedMapResolve;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self::with_shader(gpu, shaders::BITMASK_RESOLVE))
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &BitmaskParams,
    ) -> Result<PreparedMapResolve, Error> {
        let taps = Taps { light: frame.light, set: params.sample_set, seed: params.seed, run: stage.noise_frame() };
        let spread = LightSpread::of(frame.light);
        let is_own = matches!(frame.casters, PreparedCasters::Draws(_));
        let layers = if is_own { params.layers } else { 1 };
        let uniform = BitmaskUniform {
            sample_count: params.samples,
            patches: params.patches,
            rotate: params.rotate.into(),
            steepest_gap: match params.gaps {
                BitmaskGaps::Open => -1.0,
                BitmaskGaps::Surfaces => 1.0,
                BitmaskGaps::All => f32::MAX,
            },
            light_extent: spread.extent,
            light_extent_axis: spread.extent_axis,
            bias_scale: params.bias_scale,
        };
        let map = MapSettings { layers, ..MapSettings::narrow(params.map_size) };
        let constants = constants(TapsProgram::of(&taps, layers), params.samples);
        let pass = ResolvePass { map, constants: &constants, is_sparse: false };
        let lists = TapLists([(taps, TapUse::Filter, params.samples)]);
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

/// Override constants of the resolve shader, by name.
fn constants(taps: TapsProgram, samples: u32) -> [(&'static str, f64); 4] {
    // The shader visits all points, whatever their order.
    let [kind, layers, emission, _] = taps.constants();
    [kind, layers, emission, ("WORD_COUNT", f64::from(samples.div_ceil(32).min(MAX_WORDS)))]
}
