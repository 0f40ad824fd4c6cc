//! `smrt`: shadow map ray tracing, through the layers of a light map.
//!
//! Rays to light points are traced through the light map, each tested by itself: there is no mean depth of blockers
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
//! 1. **Search** (`bins.wesl`). The depths from the farthest receiver to the nearest blocker that a pyramid of the map allows are divided
//!    into 32 bins. Bins are wider farther from the receiver, where shadows blur more: with bins of one width everything near the receiver
//!    shares one bin if something is near the light (`sponza.glb`, 640 × 360: umbra leak .178 with bins of one width and .076 with these,
//!    roughness .019 and .011). A few taps of every pixel mark the bins with blockers for all pixels: neighbours find what one pixel
//!    misses. Taps lie at all scales of the light's shape, as in [`pcss`](super::pcss). Those of a tile's pixels are one set, spread over
//!    the light; half of them are even over the scales, half are spread as the bins are. A blocker also marks half a bin's width to
//!    either side, because a tilted surface reaches farther in depth than taps find it (640 × 360, without and with: roughness on `window`
//!    .0070 and .0061, on `lamp-room` .0052 and .0038, umbra leak .0016 and .0013, .0022 and .0013).
//!    Behind the last layer rays are blocked only in marked bins. A bin that the last layer hides is marked, too, if taps find surfaces
//!    beside the light's shape and none sees through the bin: otherwise single tiles miss an occluder of which the map shows only a sliver
//!    (1280 × 720, `window`: tiles of .05 to .08 in the umbra beside the table without, 0 with).
//! 2. **Rays** (`resolve.wesl`). A ray reads one texel in each marked bin, at a random position between the depths of the blockers
//!    found there. A surface of that texel in the bin blocks the ray if the ray crosses the surface's depth within a texel of the read;
//!    otherwise the texel that it crosses there decides, because a wall that rises through a whole bin would darken receivers that face
//!    it. A surface that is steep in the map, such as a riser beside the light, shows near the ray in no read at all. If a ray is behind a
//!    surface at one read and in front of one at the next, and the slope between them allows that they are one, two reads of false
//!    position find the crossing (1280 × 720, `staircase`: umbra leak .039 without and .008 with).
//!    Gaps between occluders cost nothing; if there are more bins than `steps`, neighbours are joined.
//!    If a receiver's plane runs through the light, the part of the light above the plane is known exactly: rays that end below it
//!    have no weight, and the others give the visible fraction of that part.
//! 3. **Early end.** If the first quarter of the rays of all 64 pixels are free, or all blocked, the others count as such; without
//!    `smooth`, the same holds for a pixel whose first half agree.
//! 4. **Means over pixels** (`smooth`; `mask/smoothing`). In penumbrae wider than eight pixels only the first quarter of the rays is
//!    traced. Means over neighbours on the same surface remove their noise; they are much narrower than the penumbra, and their width
//!    follows from the light's shape and the nearest blocker that the rays found. In narrower penumbrae all rays are traced, and means
//!    reach less far.
//!
//! With `weights=irradiance` a ray is weighted by the irradiance from its light point, as in [`ray_traced`](crate::techniques::ray_traced):
//! the mask is the fraction of the light's own irradiance that arrives, and the horizon reduces that irradiance, not the mask.
//!
//! At any time the rays of all of a tile's pixels end in the same cell of a rectangle, each pixel's at its own position within the
//! cell: neighbours read nearby texels, which costs a GPU a seventh less than ends all over the light.
//!
//! # What blocks
//! A texel's surface blocks a ray if it is in front of the receiver's biased plane at the texel's centre and nearer to the light
//! than the receiver, as in `pcss`, and if a slab behind it, `thickness` texel widths thick, overlaps the ray's bin. A map shows only
//! fronts: without a thickness light leaks through steep surfaces, with an infinite one everything behind an occluder is dark (in a
//! prototype over six scenes rmse .025 with none, .085 with an infinite one, .015 with four texels). Behind the last layer nothing
//! is known, and its slab is thicker (`last_thickness`).
//!
//! If a surface hides the ray but is behind the receiver's plane at the texel's centre, the nearest texel in front of that plane
//! decides: texel centres of a wall that is edge-on to the light lie on either side of it (without and with: eaves under a lamp, a host
//! test, .101 and .001 of the dark part lit; 640 × 360, roughness on `window` .0023 and .0010).
//!
//! A receiver that faces away from the light's centre and sees part of the light is compared from its other side: surfaces nearer
//! to the light than its plane are behind it, its own among them, and surfaces farther than the plane and nearer than the receiver
//! are in front (posts' sides beside a wide lamp, a host test).
//!
//! The automatic bias is one texel's width, twice that of the techniques that gather texels by fours: a single texel shows a
//! surface that lies up to half a texel away.
//!
//! Each ray is moved across by up to half a texel, which blurs edges, also at contacts, whose staircases become gradients as wide as
//! a texel. (480 × 270, 256 light points, compared with less blur where blockers are near: rmse on `tilted-planes` .0209 and .0227, on
//! `flight-helmet.glb` .0192 and .0211, roughness .0024 and .0036, .0045 and .0071; of fifteen scenes one is rougher.)
//!
//! # Limits
//! Noise that means over pixels leave shows in narrow penumbrae, and where a blocker near the receiver keeps the means narrow;
//! [`Denoise`](crate::Denoise) removes it. No penumbra is narrower than a texel.
//! Behind the last layer light is lost behind thin surfaces, and leaks through many small open surfaces one behind another, such
//! as leaves. A host's depth map has one layer: `pcss` is better there. Loops are bounded by the counts of rays, bins and layers.

use antumbra_light::{Light, LightShape, SampleSet};
use glam::{UVec2, Vec2};

use crate::contract::{DrawnMap, Error, PreparedCasters, PreparedFrame, SampleWeights};
use crate::gpu::{Bindings, Gpu, Recorder, Stage, bindings, passed_texture};
use crate::light_map::light_spread::LightSpread;
use crate::light_map::map::{MapSearch, MapSettings};
use crate::mask::smoothing::NOISY_FORMAT;
use crate::shaders;
use crate::techniques::Technique;
use crate::techniques::single_map::taps::{TapLists, TapUse, Taps, TapsProgram};
use crate::techniques::single_map::{MapResolve, PreparedMapResolve, ResolvePass};

pub(crate) mod gpu_types;
mod params;

use gpu_types::SmrtUniform;
pub use params::SmrtParams;

/// Number of pixels of a tile, which share the blockers that they find.
const TILE_PIXELS: u32 = 64;

/// Maximum number of search taps of a tile: so many over the light and all scales leave no gap that matters.
const MAX_SEARCH_TAPS: u32 = 4096;

bindings! {
    struct NoisyWritten = "noisy visibility, written", COMPUTE, group 3 of [SMRT_RESOLVE] {
        0 noisy: WrittenTexture(NOISY_FORMAT),
    }
}

/// Passes of one frame.
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
    /// Placeholder of one texel, for visibility that is written to the mask instead.
    no_noisy: wgpu::TextureView,
}

impl Technique for Smrt {
    const NAME: &'static str = "smrt";
    type Params = SmrtParams;
    type Prepared = PreparedSmrt;

    /// Whether the visibility is noisy. Penumbrae of a list of points have steps, which are no noise.
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
        // Taps of all of a tile's pixels, up to a number that is enough for any.
        let tile_search_count = (TILE_PIXELS * params.search_samples).min(MAX_SEARCH_TAPS.max(params.search_samples));
        let uniform = SmrtUniform {
            tile_search_count,
            search_count: params.search_samples,
            ray_count: params.samples,
            max_steps: params.steps,
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
        let map = MapSettings { layers, ..MapSettings::narrow(params.map_size) };
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

/// Override constants of the resolve shader, by name.
fn constants(taps: TapsProgram, is_smooth: bool, weights: SampleWeights) -> [(&'static str, f64); 6] {
    let [kind, layers, emission, progressive] = taps.constants();
    let is = |is| f64::from(u8::from(is));
    let weighs_irradiance = weights == SampleWeights::Irradiance;
    let smoothed = ("IS_SMOOTHED", is(is_smooth));
    [kind, layers, emission, progressive, smoothed, ("WEIGHS_IRRADIANCE", is(weighs_irradiance))]
}

/// Number of cells along each side of the unit square that have equal numbers of ray ends, whatever part of the rays is traced: any 16
/// points of Sobol's sequence from a multiple of 16 on have one in each of 4 × 4 cells.
fn cells_of(params: &SmrtParams) -> u32 {
    if params.sample_set == SampleSet::Sobol && params.samples.is_multiple_of(64) { 4 } else { 1 }
}

/// Half the narrow side of the light, metres; for a sun, the tangent of its half-angle.
fn narrow_half_extent(light: &Light) -> f32 {
    match &light.shape {
        LightShape::Rectangle { size_m } => 0.5 * size_m.min_element(),
        LightShape::Ellipsoid { radii_m } => radii_m.min_element(),
        LightShape::Disk { radius_m } | LightShape::Sphere { radius_m } => *radius_m,
        LightShape::Sun { .. } => light.bounding_radius(),
        LightShape::Points { .. } => 0.0,
    }
}
