//! `sample_based`: soft shadows by exact visibility of up to 1024 light points from every receiver.
//!
//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, "Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps",
//! EGSR 2008, section 4. Each receiver has a bit for each light point. A triangle hides the points behind all of its
//! planes as seen from the receiver, an AND over planes; what triangles hide together is the OR. Visibility is the
//! weight of the bits left. `techniques/view_samples` holds the passes, and says where they depart from the paper.
//!
//! Every shape of light is taken as it is, volumes, textured rectangles and lists of points too: a plane through the
//! receiver is an affine function of a light point's coordinates in the light's frame. Points are sorted into words of
//! 32 that lie close together, so that a plane settles most words at once.
//!
//! Casters that tint dim what is seen of the light by the share of it that they cover (section 6), each mesh by its
//! front faces and by its back faces.
//!
//! # Limits
//! All receivers share one set of light points, so few of them show as overlapping hard shadows: bands. `rotate` trades
//! bands for noise where the light's shape allows. Tinted casters that overlap are multiplied as if they covered the
//! light independently. Time grows with the triangles between receiver and light: foliage close to a large light is the
//! worst case. A mesh that says it is closed and is not leaks where it is open.

use antumbra_light::{Light, LightShape};

use crate::contract::{Error, Frame, Technique, TechniqueKind};
use crate::gpu::{Gpu, Recorder};
use crate::techniques::view_samples::{
    CULL_FACING, CUT_BY_PLANE, Options, PENUMBRA_ONLY, STOP_WHEN_OCCLUDED, ViewSamples, local_points,
};

mod params;

pub use params::{SampleBasedParams, SampleEvaluation};

/// Exact soft shadows.
#[derive(Debug)]
pub struct SampleBased {
    passes: ViewSamples,
    /// For each bit of a pixel, its light point's index in the sample set or the light's list.
    bit_order: Vec<u32>,
    keeps_bits: bool,
    counts_tests: bool,
}

impl Technique for SampleBased {
    const KIND: TechniqueKind = TechniqueKind::SampleBased;
    type Params = SampleBasedParams;

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self {
            passes: ViewSamples::new(gpu, Self::KIND),
            bit_order: Vec::new(),
            keeps_bits: false,
            counts_tests: false,
        })
    }

    fn prepare(&mut self, gpu: &Gpu, frame: &Frame<'_>, params: &SampleBasedParams) -> Result<(), Error> {
        let technique = Self::KIND.name();
        frame.light.validate().map_err(|source| Error::Light { technique, source })?;
        let points = local_points(frame.light, params.sample_set, params.samples, params.seed);
        self.bit_order = points.iter().map(|point| point.index).collect();
        self.keeps_bits = params.keep_bits;
        self.counts_tests = params.count_tests;
        let switches = [
            (params.stop_when_occluded, STOP_WHEN_OCCLUDED),
            (params.penumbra_only, PENUMBRA_ONLY),
            (params.cut_by_plane, CUT_BY_PLANE),
            (params.cull_facing, CULL_FACING),
        ];
        let options = Options {
            points,
            map_size: params.map_size,
            switches: switches.into_iter().filter(|(on, _)| *on).map(|(_, bit)| bit).sum(),
            lookup_size: if params.evaluation == SampleEvaluation::Lookup { params.lookup_size } else { 0 },
            rotations: if params.rotate { rotations_of(frame.light) } else { 0 },
            turn: 0.0,
            hair_scale: params.bias_scale,
            keep_bits: params.keep_bits,
            counts: params.count_tests,
        };
        self.passes.prepare(gpu, frame, &options)
    }

    fn record(&self, recorder: &mut Recorder<'_>, _frame: &Frame<'_>) {
        self.passes.record(recorder);
    }

    fn memory_bytes(&self) -> u64 {
        self.passes.memory_bytes()
    }
}

impl SampleBased {
    /// The bits of the last frame where [`keep_bits`](SampleBasedParams::keep_bits) is set: for each pixel, row after
    /// row, `⌈points / 32⌉` words of `u32`, 1 where the light point is seen; usage `COPY_SRC`. Pixels without geometry,
    /// out of the light's reach or turned away from all of it hold anything. [`Self::bit_order`] says which bit is
    /// which point.
    pub fn bits(&self) -> Option<&wgpu::Buffer> {
        self.passes.bits().filter(|_| self.keeps_bits)
    }

    /// What the last frame tested, where [`count_tests`](SampleBasedParams::count_tests) is set: eight words of `u32`, of
    /// which the last six count modulo 2³² the boxes of triangles and the triangles held against groups of receivers,
    /// the triangles held against receivers, those of them that come near the light, words of light points held against
    /// these, and light points; usage `COPY_SRC`.
    pub fn test_counts(&self) -> Option<&wgpu::Buffer> {
        self.passes.counters().filter(|_| self.counts_tests)
    }

    /// For each bit of a pixel, from the first word's lowest on, the index of its light point in the sample set, or in
    /// the light's own list.
    pub fn bit_order(&self) -> &[u32] {
        &self.bit_order
    }
}

/// How many turns about its axis leave a light as it is; 1 for any angle, 0 for none but whole ones.
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
