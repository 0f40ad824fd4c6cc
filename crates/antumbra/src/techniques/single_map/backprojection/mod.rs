//! `backprojection`: the area of the light that a map's texels hide, projected from the receiver.
//!
//! Gaël Guennebaud, Loïc Barthe, Mathias Paulin, "Real-time soft shadow mapping by backprojection", EGSR 2006, 227–234; the same,
//! "High-quality adaptive soft shadow mapping", Computer Graphics Forum 26(3) (Eurographics 2007), 525–533. The map stands for
//! the casters: each texel is a *micro-patch*, a square at the texel's depth (`micro_patches`), which hides an upright rectangle of the light's
//! plane.
//!
//! For each receiver:
//! 1. **Search area.** The part of the map through which the receiver sees the light, which a min/max pyramid of the map narrows down. Squares
//!    of one size cover it, texels or more, so that there are at most so many along a side (`squares`). What blocks at half the scale lies in
//!    the middle half of it: there the squares are half as large, and so on in rings, down to texels or until nothing inside blocks.
//! 2. **Occluders** (`occluders`). `patches`, 2006: each square by itself, carried on to its left and its lower neighbour, so that no light
//!    passes between two patches at different depths; their areas are added up. `outlines`, 2007: the boundary between squares that block and
//!    squares that do not, by marching squares, each of its points at the depth of the blocking square beside it. An outline's area is
//!    that of what it encloses, at whatever depths, counted once; and only the boundary is projected.
//! 3. **Area** (`light_area.wesl`). An edge's part in the area that the outline has in common with the light, a rectangle or a disc, in closed
//!    form. A sphere is the disc that faces the receiver. Where a light has no area of even weight (an ellipsoid, an emission texture, a
//!    list of points, a light seen edge-on), points of it are counted for which the outline goes about them.
//!
//! # Departures from the papers
//! `backprojection:paper` is the paper of 2006; the parameters' declarations list what it has otherwise.
//! - Rings. In squares of one size, small occluders near the receiver would be lost beside a large one near the light, and a square that shows
//!   a texel close before the receiver would hide all of the light.
//! - Each square shows a texel of the full map that is random at each pixel: a coarser level's nearest depth would darken whatever is
//!   near a silhouette.
//! - A texel blocks where it is in front of the receiver's plane at the texel's centre and nearer to the light than the receiver. What
//!   blocks hides points above the receiver's horizon alone; those below are taken off in closed form.
//!
//! # Limits
//! One layer: what the map hides from the light's middle is missing, and light leaks in below stacked occluders. Two occluders that the map shows
//! apart are added where they cover the same part of the light: too dark. An outline closes the opening between two that touch in the map at
//! different depths (`gaps=surfaces` leaves it open, and is further from the truth on `overlap`, `columns`, `window` and `tree`). No penumbra is
//! narrower than a texel. A closed shell close about a bulb lets light through (`shell_0.08`: rmse .075). Loops are bounded by the numbers of
//! squares, of their sizes and of points.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, OwnMapSettings};
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::taps::{TapLists, TapUse, Taps, TapsProgram};
use crate::techniques::single_map::{MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;
#[cfg(test)]
mod tests;

use gpu_types::{BackprojectionUniform, MOST_SQUARES};
pub use params::{BackprojectionGaps, BackprojectionOccluders, BackprojectionParams};

/// Squares besides: at either end two about those that are looked through, of a square of the ring outside, and one that shows nothing.
const CUT_AND_EMPTY: u32 = 6;

/// Soft shadow mapping by backprojection.
#[derive(Debug)]
pub struct Backprojection {
    resolve: MapResolve<BackprojectionUniform>,
}

impl Technique for Backprojection {
    const NAME: &'static str = "backprojection";
    type Params = BackprojectionParams;
    type Prepared = PreparedMapResolve;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let constants = constants(TapsProgram::usual(1), BackprojectionOccluders::Outlines);
        let wgsl = shaders::BACKPROJECTION_RESOLVE;
        Ok(Self { resolve: MapResolve::new(gpu, Self::NAME, wgsl, &constants, MapSearch::Layers) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &BackprojectionParams,
    ) -> Result<PreparedMapResolve, Error> {
        let taps = Taps { light: frame.light, set: params.sample_set, seed: params.seed, run: stage.noise_frame() };
        let spread = LightSpread::of(frame.light);
        let uniform = BackprojectionUniform {
            sample_count: params.samples,
            squares: params.squares.min(MOST_SQUARES - CUT_AND_EMPTY),
            rotate: params.rotate.into(),
            bias_scale: params.bias_scale,
            light_extent: spread.extent,
            light_extent_axis: spread.extent_axis,
            steepest_gap: match params.gaps {
                BackprojectionGaps::Surfaces => 1.0,
                BackprojectionGaps::All => f32::MAX,
            },
        };
        let pass = ResolvePass {
            map: OwnMapSettings::narrow(params.map_size),
            constants: &constants(TapsProgram::of(&taps, 1), params.occluders),
            is_sparse: false,
        };
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

/// Of the resolve's shader, by their names.
fn constants(taps: TapsProgram, occluders: BackprojectionOccluders) -> [(&'static str, f64); 3] {
    let is_patches = occluders == BackprojectionOccluders::Patches;
    // One layer; and points are walked to their end, whatever their order.
    let [kind, _, emission, _] = taps.constants();
    [kind, emission, ("IS_PATCHES", f64::from(u8::from(is_patches)))]
}
