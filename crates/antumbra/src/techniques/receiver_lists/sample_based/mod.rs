//! `sample_based`: soft shadows by exact visibility of up to 1024 light points from every receiver.
//!
//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, "Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps",
//! EGSR 2008, section 4. Each receiver has a bit for each light point. A triangle hides the points behind all of its
//! planes as seen from the receiver, an AND over planes; several triangles combine by OR. Visibility is the weight of
//! the remaining bits. `techniques/receiver_lists` contains the passes, and describes the departures from the paper.
//!
//! Every shape of light is supported exactly, including volumes, textured rectangles and lists of points: a plane
//! through the receiver is an affine function of a light point's coordinates in the light's frame. Points are sorted
//! into words of 32 that are close together, so that a plane decides most words at once.
//!
//! Translucent casters without tint hide light points in proportion to the light that they stop: each triangle has a random
//! number for each point, stratified over points that are close together (`primitives/stochastic`). Transmittances of several
//! surfaces thus multiply along each segment, which the fraction of section 6 does not achieve. Tinted casters dim the
//! visible light by the fraction of it that they cover (section 6), each mesh by its front faces and by its back faces.
//!
//! All receivers share one set of light points, so few of them show as overlapping hard shadows: bands. `rotate` replaces
//! bands by noise if the light's shape allows it: every pixel rotates the points about the light's axis by another angle
//! (section 4.2). `accumulate` takes other points in each frame (with the table and a light that is the same at any angle,
//! the same points at other angles, which averages over angles alone), and returns the mean of the frames since the last
//! change (figure 7); `mask/accumulation` defines changes. The first frame after a change is the same as without it.
//!
//! **Lighting and visibility** are separate, as in the paper: a light point counts by its luminance, and the host shades.
//! `weights=irradiance` is equation 1 instead: each point gives a receiver its emission, in colour, times both cosines over the
//! squared distance, and the mask is the fraction of the irradiance without casters that arrives, by channel. The host
//! multiplies an area light's own irradiance by it. If the light is small relative to its distance both are the same.
//!
//! `sub` lists every other pixel in both directions, interpolates within surfaces, and lists the pixels that this would
//! get wrong in a second round (section 4.3, which proposes "a view-sample subset" and "a reconstruction step").
//!
//! # Limits
//! During motion, few points show as bands or noise; `accumulate` helps only in still frames. Several layers of partly
//! covering casters have noise, which decreases with the number of points. Overlapping tinted casters multiply as if
//! they covered the light independently. Time grows with the triangles between receiver and light: foliage close to a
//! large light is the worst case. A mesh that claims to be closed and is not leaks where it is open.

use std::hash::{DefaultHasher, Hash, Hasher};

use antumbra_light::{Light, LightShape, SampleSet};
use glam::Vec3;

use crate::contract::{DrawnLists, Error, PreparedFrame};
use crate::gpu::{Cached, Gpu, Recorder, Stage};
use crate::mask::accumulation::{Accumulation, PreparedAccumulation};
use crate::techniques::receiver_lists::{
    CULL_FACING, CUT_BY_PLANE, Options, PENUMBRA_ONLY, PreparedSamples, RasterOptions, Region, STOP_WHEN_OCCLUDED,
    ViewSamples, local_points,
};
use crate::techniques::{Coverage, Technique};

mod params;
#[cfg(test)]
mod tests;

pub use crate::contract::SampleWeights;
pub use crate::techniques::receiver_lists::Traversal;
pub use params::{RegionOfInfluence, SampleBasedParams, SampleEvaluation};

/// Technique for exact soft shadows.
#[derive(Debug)]
pub struct SampleBased {
    passes: ViewSamples,
    /// For each bit of a pixel, its light point's index in the sample set or the light's list.
    bit_order: Vec<u32>,
    keeps_bits: bool,
    counts_tests: bool,
    unit_points: UnitPoints,
    /// Created when a frame first needs it.
    accumulation: Option<Accumulation>,
}

/// Passes of one frame.
#[derive(Debug)]
#[doc(hidden)]
pub struct PreparedSampleBased {
    samples: PreparedSamples,
    /// Accumulation; `None` if it is off.
    accumulation: Option<PreparedAccumulation>,
}

/// Cached points of the unit cube from which the light's points are computed, with their key.
#[derive(Debug, Default)]
struct UnitPoints(Cached<(SampleSet, u32, u32, u32), Vec<Vec3>>);

impl UnitPoints {
    /// Returns the points of a set's run; see [`SampleSet::run`]. Relaxed ones take a tenth of a second to compute.
    fn of(&mut self, set: SampleSet, run: u32, samples: u32, seed: u32) -> &[Vec3] {
        self.0.get_or_make((set, run, samples, seed), || set.run(run, samples, seed))
    }
}

/// Rotation from one frame to the next as a fraction of a turn, if pixels are rotated: the golden ratio, so that any
/// number of frames divide the circle evenly.
const TURN_OF_FRAME: f64 = 0.618_033_988_749_894_8;

impl Technique for SampleBased {
    const NAME: &'static str = "sample_based";
    type Params = SampleBasedParams;
    type Prepared = PreparedSampleBased;

    fn coverage(_params: &SampleBasedParams) -> Coverage {
        Coverage::Everything
    }

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self {
            passes: ViewSamples::new(gpu, Self::NAME),
            bit_order: Vec::new(),
            keeps_bits: false,
            counts_tests: false,
            unit_points: UnitPoints::default(),
            accumulation: None,
        })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &SampleBasedParams,
    ) -> Result<PreparedSampleBased, Error> {
        let technique = Self::NAME;
        frame.light.validate().map_err(|source| Error::Light { technique, source })?;
        let mut run = 0;
        if params.accumulate {
            let inputs = self.passes.inputs();
            let accumulation = self.accumulation.get_or_insert_with(|| Accumulation::new(stage, inputs));
            run = accumulation.begin(frame, stage.casters(), hash_of(params));
        } else {
            self.accumulation = None;
        }
        let rotations = if params.rotate { rotations_of(frame.light) } else { 0 };
        // If any rotation will do, another one is as good as other points, and the table of planes stays valid.
        // Otherwise every pixel keeps its rotation, because rotated runs of points would not complement each other.
        let keeps_points = params.evaluation == SampleEvaluation::Lookup && rotations == 1;
        let (run_of_points, run_of_turns) = if keeps_points { (0, run) } else { (run, 0) };
        let unit_points = self.unit_points.of(params.sample_set, run_of_points, params.samples, params.seed);
        let points = local_points(frame.light, unit_points);
        self.bit_order = points.iter().map(|point| point.index).collect();
        self.keeps_bits = params.keep_bits;
        self.counts_tests = params.count_tests;
        let switches = [
            (params.stop_when_occluded, STOP_WHEN_OCCLUDED),
            (params.penumbra_only, PENUMBRA_ONLY),
            (params.cut_by_plane, CUT_BY_PLANE),
            (params.cull_facing, CULL_FACING),
        ];
        let weighs_irradiance = params.weights == SampleWeights::Irradiance;
        let options = Options {
            points,
            map_size: params.map_size,
            traversal: params.traversal,
            drawn: RasterOptions {
                region: match params.region {
                    RegionOfInfluence::Boxes => Region::Boxes,
                    RegionOfInfluence::Hexagons => Region::Hexagons,
                },
                light_planes: false,
                stored_positions: params.stored_positions,
                stencil: params.stencil,
            },
            switches: switches.into_iter().filter(|(on, _)| *on).map(|(_, bit)| bit).sum(),
            lookup_size: if params.evaluation == SampleEvaluation::Lookup { params.lookup_size } else { 0 },
            rotations,
            turn: (f64::from(run_of_turns) * TURN_OF_FRAME).fract() as f32,
            ray_offset_scale: params.bias_scale,
            keep_bits: params.keep_bits || weighs_irradiance,
            counts: params.count_tests,
            is_sparse: params.sub,
            weighs_irradiance,
        };
        let samples = self.passes.prepare(stage, frame, &options)?;
        let accumulation = self.accumulation.as_mut().map(|accumulation| accumulation.prepare(stage, technique, frame));
        Ok(PreparedSampleBased { samples, accumulation: accumulation.transpose()? })
    }

    fn record(&self, recorder: &mut Recorder<'_>, _frame: &PreparedFrame<'_>, prepared: &PreparedSampleBased) {
        self.passes.record(recorder, &prepared.samples);
        if let (Some(accumulation), Some(of_frame)) = (&self.accumulation, &prepared.accumulation) {
            accumulation.record(recorder, prepared.samples.inputs(), of_frame);
        }
    }

    fn is_settled(&self, params: &SampleBasedParams, _still_frames: u32) -> bool {
        !params.accumulate
    }

    fn drawn_lists(&self) -> Vec<DrawnLists> {
        self.passes.drawn_lists()
    }

    fn memory_bytes(&self) -> u64 {
        self.passes.memory_bytes() + self.accumulation.as_ref().map_or(0, Accumulation::memory_bytes)
    }
}

impl SampleBased {
    /// Bits of the last frame if [`keep_bits`](SampleBasedParams::keep_bits) is set: for each pixel, row after row,
    /// `⌈points / 32⌉` words of `u32`, 1 where the light point is visible; usage `COPY_SRC`. Bits are undefined for
    /// pixels without geometry, out of the light's reach or facing away from all of it, and for those that
    /// [`sub`](SampleBasedParams::sub) interpolates. [`Self::bit_order`] maps bits to points.
    pub fn bits(&self) -> Option<&wgpu::Buffer> {
        self.passes.bits().filter(|_| self.keeps_bits)
    }

    /// Counters of the last frame if [`count_tests`](SampleBasedParams::count_tests) is set: eight words of `u32`, of
    /// which the last six count modulo 2³² the boxes of triangles and the triangles tested against groups of receivers
    /// (drawn ones against texels), the triangles tested against receivers, those of them that come near the light, words
    /// of light points tested against these, and light points; usage `COPY_SRC`.
    pub fn test_counts(&self) -> Option<&wgpu::Buffer> {
        self.passes.counters().filter(|_| self.counts_tests)
    }

    /// Index of each bit's light point, in the sample set or in the light's own list; bits start at the lowest of the
    /// first word.
    pub fn bit_order(&self) -> &[u32] {
        &self.bit_order
    }
}

/// Returns a hash of parameters, by their `Debug` form: different parameters have different forms.
fn hash_of(params: &SampleBasedParams) -> u64 {
    let mut hasher = DefaultHasher::new();
    format!("{params:?}").hash(&mut hasher);
    hasher.finish()
}

/// Returns the number of rotations about its axis that leave a light unchanged; 1 for any angle, 0 for none but whole turns.
fn rotations_of(light: &Light) -> u32 {
    if light.emission.is_some() {
        return 0;
    }
    match &light.shape {
        LightShape::Disk { .. } | LightShape::Sphere { .. } | LightShape::Sun { .. } => 1,
        LightShape::Ellipsoid { radii_m } if radii_m.x == radii_m.y => 1,
        LightShape::Rectangle { size_m } if size_m.x == size_m.y => 4,
        LightShape::Rectangle { .. } | LightShape::Ellipsoid { .. } => 2,
        LightShape::Points { .. } => 0,
    }
}
