//! `smrt`: shadow map ray tracing, through the layers of a light map.
//!
//! Rays to points of the light are followed through the light map, each tested by itself: there is no mean depth of blockers
//! and no estimate of a penumbra's width, so that near and far occluders keep their own penumbrae where they meet. Sources:
//! Agrawala, Ramamoorthi, Heirich, Moll, "Efficient image-based methods for rendering soft shadows", SIGGRAPH 2000 (rays
//! through layered depth images); Xie, Tabellion, Pearce, "Soft shadows by ray tracing multilayer transparent shadow maps",
//! EGSR 2007 (layers, and a surface's thickness).
//!
//! With light and map in one frame, the ray from a receiver at depth `z_r` to the light point with offset `o` on the light's
//! plane crosses depth `z` at light-plane coordinates
//!
//! ```text
//! t_r + o · g,   g = 1/z − 1/z_r   (perspective)        p_r + o · g,   g = z_r − z   (sun, o a tangent)
//! ```
//!
//! a straight line in the map along `g` (`map_receiver.wesl`, `fan.wesl`). For each tile of 8 × 8 pixels:
//!
//! 1. **Search** (`bins.wesl`). The depths from the farthest receiver to the nearest blocker that a pyramid of the map allows
//!    are cut into 32 bins, wider the farther they lie from the receiver, as shadows are blurred: with bins of one width all that
//!    is near the receiver shares one where something is near the light (`sponza.glb`, 640 × 360: umbra leak .178 and .076,
//!    roughness .019 and .011). A few taps of every pixel mark the bins with blockers, for all pixels: what one misses its
//!    neighbour finds. Taps lie at all scales of the light's shape, as in [`pcss`](super::pcss); those of a tile's pixels are
//!    one set, spread over the light, and half evenly over the scales, half as the bins are. A blocker marks half a bin's width to either side, too: a tilted surface reaches
//!    farther in depth than where taps found it (640 × 360: roughness on `window` .0070 and .0061, on `lamp-room` .0052 and .0038,
//!    umbra leak .0016 and .0013, .0022 and .0013).
//!    Behind the last layer rays are blocked in marked bins alone. A bin that the last layer hides is marked, too, where taps find
//!    surfaces beside the light's shape and none sees through the bin: else an occluder that shows in the map by a sliver is missed by
//!    single tiles (1280 × 720, `window`: tiles of .05 to .08 in the umbra beside the table, now 0).
//! 2. **Rays** (`resolve.wesl`). A ray reads one texel in each marked bin, at a random place between the depths of the
//!    blockers found there. A surface of that texel in the bin blocks it, if the ray is within a texel where it crosses the
//!    surface's depth; else the texel that it crosses there decides: a wall that rises through a whole bin would darken receivers
//!    that face it. A surface that is steep in the map, as a riser beside the light is, shows near the ray in no read at all: where a ray
//!    is behind a surface at one read and in front of one at the next, which may be the same by its slope, the place of the crossing
//!    is found by two reads of false position (1280 × 720, `staircase`: umbra leak .039 and .008).
//!    Gaps between occluders cost nothing; if there are more bins than `steps`, neighbours are joined.
//!    Of a receiver whose plane runs through the light the part above it is known exactly: rays that end below it have no weight,
//!    and what the others find is a share of that part.
//! 3. **Early end.** Where the first quarter of the rays of all 64 pixels are free, or all blocked, so are the others; without
//!    `smooth` likewise those of a pixel whose first half are.
//! 4. **Means over pixels** (`smooth`; `mask/smoothing`). In penumbrae wider than eight pixels the first quarter of
//!    the rays is all: what noise they leave is taken out by means over neighbours on the same surface, much narrower than the
//!    penumbra, whose width follows from the light's shape and the nearest blocker that the rays found. In narrower ones all
//!    rays are followed, and means reach less far.
//!
//! With `weights=irradiance` a ray counts what its point of the light gives the receiver, as in [`ray_traced`](crate::techniques::ray_traced):
//! the mask is the part of the light's own irradiance that arrives, and the horizon's share is part of that irradiance, not of the mask.
//!
//! A rectangle's rays end in the same cell of the light for all of a tile's pixels at a time, at a place of each pixel's own within
//! it: neighbours read nearby texels, which costs a graphics card a seventh less than places all over the light.
//!
//! # What blocks
//! A texel's surface blocks a ray where it is in front of the receiver's biased plane at the texel's centre and nearer to the
//! light than the receiver, as in `pcss`; and only where a slab behind it, `thickness` texels' widths thick, has a part in
//! the ray's bin. A map shows fronts alone: without a thickness light leaks through steep surfaces, with an infinite one all
//! that lies behind an occluder is dark (in a prototype over six scenes rmse .025 with none, .085 with an infinite one, .015
//! with four texels). Behind the last layer nothing is known, and its slab is thicker (`last_thickness`).
//!
//! Where a surface hides the ray but is behind the receiver's plane at the texel's centre, the nearest texel in front of that plane
//! decides: of a wall that is edge-on to the light, texels' centres lie to either side (eaves under a lamp, a host test: .101 and .001
//! of what is dark was lit; 640 × 360: roughness on `window` .0023 and .0010).
//!
//! A receiver that faces away from the light's middle and sees a part of the light is compared from its other side: what is nearer
//! to the light than its plane is behind it, its own surface among that, and what is farther than the plane and nearer than the
//! receiver is in front (posts' sides beside a wide lamp, a host test).
//!
//! The automatic bias is one texel's width, twice that of the techniques that gather texels by fours: a single texel shows a
//! surface that lies up to half a texel away.
//!
//! Edges are blurred by moving each ray by up to half a texel across, contacts too, whose steps are then a gradient as wide as a
//! texel. (480 × 270, 256 light points, against less blur where blockers are near: rmse on `tilted-planes` .0209 and .0227, on
//! `flight-helmet.glb` .0192 and .0211, roughness .0024 and .0036, .0045 and .0071; of fifteen scenes one was rougher.)
//!
//! # Limits
//! What noise means over pixels leave shows in narrow penumbrae, and where a blocker near to the receiver keeps them narrow;
//! [`Denoise`](crate::Denoise) takes it out. No penumbra is narrower than a texel.
//! Behind the last layer light is lost behind thin surfaces, and through many small open surfaces one behind another, as
//! leaves are, it leaks. A host's depth map has one layer: `pcss` is better there. Loops are bounded by the
//! counts of rays, bins and layers.

use antumbra_light::{Light, LightShape, SampleSet};
use glam::{UVec2, Vec2};

use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame, SampleWeights};
use crate::gpu::{Bindings, Gpu, Recorder, Stage, bindings, passed_texture};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, OwnMapSettings};
use crate::mask::smoothing::NOISY_FORMAT;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::taps::{TapLists, TapUse, Taps, TapsProgram};
use crate::techniques::single_map::{MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;

use gpu_types::SmrtUniform;
pub use params::SmrtParams;

/// Pixels of a tile, which share what they find.
const TILE_PIXELS: u32 = 64;

/// Taps over the light and all scales that leave no gap which matters, however many a pixel takes.
const MOST_SEARCH_TAPS: u32 = 4096;

bindings! {
    struct NoisyWritten = "noisy visibility, written", COMPUTE, group 3 of [SMRT_RESOLVE] {
        0 noisy: WrittenTexture(NOISY_FORMAT),
    }
}

/// The passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedSmrt {
    resolve: PreparedMapResolve,
    written: wgpu::BindGroup,
}

/// Shadow map ray tracing.
#[derive(Debug)]
pub struct Smrt {
    resolve: MapResolve<SmrtUniform>,
    noisy_layout: wgpu::BindGroupLayout,
    /// A texture of one texel, where visibility goes into the mask.
    no_noisy: wgpu::TextureView,
}

impl Technique for Smrt {
    const NAME: &'static str = "smrt";
    type Params = SmrtParams;
    type Prepared = PreparedSmrt;

    /// Of a list of points penumbrae have steps, which are no noise.
    fn is_noisy(params: &SmrtParams, light: &Light) -> bool {
        params.smooth && !matches!(light.shape, LightShape::Points { .. })
    }

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        let defaults = SmrtParams::default();
        let constants = constants(TapsProgram::usual(defaults.layers), defaults.smooth, defaults.weights);
        let noisy_layout = NoisyWritten::layout(gpu);
        let layouts = vec![noisy_layout.clone()];
        let resolve =
            MapResolve::with_groups(gpu, Self::NAME, shaders::SMRT_RESOLVE, &constants, MapSearch::Layers, layouts);
        let no_noisy = passed_texture("antumbra no noisy visibility", NOISY_FORMAT, UVec2::ONE, 1);
        let no_noisy = gpu.device.create_texture(&no_noisy);
        let no_noisy = gpu.device.create_view(&no_noisy, &wgpu::TextureViewDescriptor::default());
        Ok(Self { resolve, noisy_layout, no_noisy })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &SmrtParams,
    ) -> Result<PreparedSmrt, Error> {
        let taps = Taps { light: frame.light, set: params.sample_set, seed: params.seed, run: stage.noise_frame() };
        let spread = LightSpread::of(frame.light);
        let is_own = matches!(frame.casters, PreparedCasters::Draws(_));
        let layers = if is_own { params.layers } else { 1 };
        let program = TapsProgram::of(&taps, layers);
        // Of a tile's pixels together, up to what is enough for any.
        let tile_search_count = (TILE_PIXELS * params.search_samples).min(MOST_SEARCH_TAPS.max(params.search_samples));
        let uniform = SmrtUniform {
            tile_search_count,
            search_count: params.search_samples,
            ray_count: params.samples,
            most_steps: params.steps,
            rotate: params.rotate.into(),
            bias_scale: params.bias_scale,
            light_extent: spread.extent,
            light_extent_axis: spread.extent_axis,
            cells: cells_of(params) as f32,
            thickness_texels: Vec2::new(params.thickness, params.last_thickness),
            narrow_half_extent: narrow_half_extent(frame.light),
            padding: 0,
        };
        let search_taps = Taps { set: SampleSet::Sobol, ..taps };
        let search = (search_taps, TapUse::Search, tile_search_count);
        let lists = TapLists([search, (taps, TapUse::Filter, params.samples)]);
        let map = OwnMapSettings { layers, ..OwnMapSettings::narrow(params.map_size) };
        let pass = ResolvePass {
            map,
            constants: &constants(program, frame.noisy.is_some(), params.weights),
            is_sparse: false,
        };
        let resolve = lists.with_kernel(|kernel| self.resolve.prepare(stage, frame, &pass, &uniform, kernel))?;
        let noisy = frame.noisy.unwrap_or(&self.no_noisy);
        Ok(PreparedSmrt { resolve, written: NoisyWritten { noisy }.group(stage, &self.noisy_layout) })
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedSmrt) {
        self.resolve.record_with(recorder, frame, &prepared.resolve, &[&prepared.written]);
    }

    fn drawn_map(&self) -> Option<DrawnMap> {
        self.resolve.drawn_map()
    }

    fn memory_bytes(&self) -> u64 {
        self.resolve.memory_bytes()
    }
}

/// Of the resolve's shader, by their names.
fn constants(taps: TapsProgram, is_smooth: bool, weights: SampleWeights) -> [(&'static str, f64); 6] {
    let [kind, layers, emission, progressive] = taps.constants();
    let is = |is| f64::from(u8::from(is));
    let weighs_irradiance = weights == SampleWeights::Irradiance;
    let smoothed = ("IS_SMOOTHED", is(is_smooth));
    [kind, layers, emission, progressive, smoothed, ("WEIGHS_IRRADIANCE", is(weighs_irradiance))]
}

/// Along each side of the unit square, cells with equal numbers of the rays' ends, whatever part of the rays is followed: any 16
/// points of Sobol's sequence from a multiple of 16 on have one in each of 4 × 4.
fn cells_of(params: &SmrtParams) -> u32 {
    if params.sample_set == SampleSet::Sobol && params.samples.is_multiple_of(64) { 4 } else { 1 }
}

/// Half the narrow side of the light, metres; of a sun the tangent of its half-angle.
fn narrow_half_extent(light: &Light) -> f32 {
    match &light.shape {
        LightShape::Rectangle { size_m } => 0.5 * size_m.min_element(),
        LightShape::Ellipsoid { radii_m } => radii_m.min_element(),
        LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => *radius_m,
        LightShape::Sun { .. } => light.bounding_radius(),
        LightShape::Points { .. } => 0.0,
    }
}
