//! `backprojection`: the area of the light that a map's texels hide, projected from the receiver.
//!
//! Gaël Guennebaud, Loïc Barthe, Mathias Paulin, "Real-time soft shadow mapping by backprojection", EGSR 2006, 227–234; the same,
//! "High-quality adaptive soft shadow mapping", Computer Graphics Forum 26(3) (Eurographics 2007), 525–533. The map represents
//! the casters: each texel is a *micro-patch*, a square at the texel's depth (`micro_patches`), which hides a rectangle of the light's
//! plane whose sides are parallel to the map's axes.
//!
//! For each receiver:
//! 1. **Search area.** The part of the map through which the receiver sees the light, narrowed down by a min/max pyramid of the map.
//!    Squares of one size cover it, of one texel or more, at most `squares` along a side. Blockers at up to half the scale lie in its
//!    middle half: there the squares are half as large, and so on in rings, down to single texels or until nothing inside blocks.
//! 2. **Occluders** (`occluders`). `patches` (2006): each square by itself, extended to its left and its lower neighbour, so that no light
//!    passes between two patches at different depths; their areas are added up. `outlines` (2007): the boundary between squares that block
//!    and squares that do not, by marching squares, each of its points at the depth of the blocking square beside it. What an outline
//!    encloses counts once, whatever its depths; and only the boundary is projected.
//! 3. **Area** (`light_area.wesl`). The area that an outline shares with the light, a rectangle or a disc, is a sum over the outline's
//!    edges in closed form. A sphere is the disc that faces the receiver. For a light without an area of uniform weight (an ellipsoid, an
//!    emission texture, a list of points, a light seen edge-on), the light points inside the outline are counted instead.
//!
//! # Departures from the papers
//! `backprojection:paper` is the paper of 2006; the parameters' declarations list the differences.
//! - Rings. With squares of one size, small occluders near the receiver would be lost beside a large one near the light, and a square that
//!   shows a texel just in front of the receiver would hide the whole light.
//! - Each square shows one texel of the full map, chosen at random per pixel: a coarser level's nearest depth would darken whatever is
//!   near a silhouette.
//! - A texel blocks if it is in front of the receiver's plane at the texel's centre and nearer to the light than the receiver. Blockers
//!   hide only light points above the receiver's horizon; the part of the light below it is subtracted in closed form.
//!
//! # Limits
//! One layer: surfaces that the light's centre does not see are missing, so light leaks in below stacked occluders. Two occluders that are
//! apart in the map are added where they cover the same part of the light: too dark. An outline closes the opening between two that touch
//! in the map at different depths (`gaps=surfaces` leaves it open, and has larger errors on `overlap`, `columns`, `window` and `tree`). No
//! penumbra is narrower than a texel. A closed shell close around a bulb lets light through (`shell_0.08`: rmse .075). Loops are bounded by
//! the numbers of squares, of square sizes and of points.

use crate::contract::{DrawnMap, Error, PreparedFrame};
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

use gpu_types::{BackprojectionUniform, MAX_SQUARES};
pub use params::{BackprojectionGaps, BackprojectionOccluders, BackprojectionParams};

/// Additional squares along a ring: at either end two of the size of one square of the ring outside, and one that shows nothing.
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
            squares: params.squares.min(MAX_SQUARES - CUT_AND_EMPTY),
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
            map: MapSettings::narrow(params.map_size),
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

/// Override constants of the resolve shader, by name.
fn constants(taps: TapsProgram, occluders: BackprojectionOccluders) -> [(&'static str, f64); 3] {
    let is_patches = occluders == BackprojectionOccluders::Patches;
    // The shader has one layer, and visits all points, whatever their order.
    let [kind, _, emission, _] = taps.constants();
    [kind, emission, ("IS_PATCHES", f64::from(u8::from(is_patches)))]
}
