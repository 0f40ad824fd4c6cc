//! `alias_free`: hard shadows that equal the ray tracer's, independent of a resolution and without a bias.
//!
//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, "Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps",
//! EGSR 2008, section 3; after Aila and Laine 2004 and Johnson et al. 2005. The light map stores the receivers
//! themselves, in a list per texel, and every triangle near a list is tested against each receiver in it: against the
//! triangle's supporting plane, and the three planes through the light and an edge. `techniques/receiver_lists` contains
//! the passes. By default triangles are rasterised conservatively over the lists (section 3.2), which for one light point
//! is faster than groups of receivers that search for them. If lists are crowded, as for a sun over a town, groups are
//! used. The device chooses in each frame, and the shadow is the same.
//!
//! A closed mesh casts by the triangles that a segment from the receiver *enters*, on which no receiver can lie, and so
//! needs no bias. Open meshes cast from both sides; there the segment starts at a ray offset, on the side that the camera
//! sees: 2⁻¹⁸ of the receiver's distances to the origin and to the camera, 40 µm at 5 m from both, which covers the
//! rounding of the depth buffer and of single precision.
//!
//! # Limits
//! The light is a point, whatever its size: no penumbra. A position is only as precise as the depth buffer: a receiver
//! within that rounding of a shadow's edge can fall on either side. Time grows with the triangles between receivers and
//! light, not with a map's size. A mesh that claims to be closed and is not leaks where it is open.

use glam::Vec3;

use crate::contract::{DrawnLists, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::techniques::receiver_lists::{
    CULL_FACING, CUT_BY_PLANE, LocalPoint, Options, PreparedSamples, RasterOptions, Region, STOP_WHEN_OCCLUDED,
    ViewSamples,
};
use crate::techniques::{Coverage, Technique};

mod params;

pub use params::{AliasFreeParams, RegionHull, TestedPlanes};

/// Technique for exact hard shadows.
#[derive(Debug)]
pub struct AliasFree {
    passes: ViewSamples,
}

impl Technique for AliasFree {
    const NAME: &'static str = "alias_free";
    type Params = AliasFreeParams;
    type Prepared = PreparedSamples;

    fn coverage(_params: &AliasFreeParams) -> Coverage {
        Coverage::Everything
    }

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { passes: ViewSamples::new(gpu, Self::NAME) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &AliasFreeParams,
    ) -> Result<PreparedSamples, Error> {
        let options = Options {
            points: vec![LocalPoint::white(Vec3::ZERO)],
            map_size: params.map_size,
            traversal: params.traversal,
            drawn: RasterOptions {
                region: match params.region {
                    RegionHull::Boxes => Region::Boxes,
                    RegionHull::SixVertices => Region::SixVertices,
                },
                light_planes: params.planes == TestedPlanes::Triangle,
                stored_positions: params.stored_positions,
                stencil: params.stencil,
            },
            switches: STOP_WHEN_OCCLUDED | CUT_BY_PLANE | CULL_FACING,
            lookup_size: 0,
            rotations: 0,
            turn: 0.0,
            ray_offset_scale: params.bias_scale,
            keep_bits: false,
            counts: false,
            is_sparse: false,
            weighs_irradiance: false,
        };
        self.passes.prepare(stage, frame, &options)
    }

    fn record(&self, recorder: &mut Recorder<'_>, _frame: &PreparedFrame<'_>, prepared: &PreparedSamples) {
        self.passes.record(recorder, prepared);
    }

    fn drawn_lists(&self) -> Vec<DrawnLists> {
        self.passes.drawn_lists()
    }

    fn memory_bytes(&self) -> u64 {
        self.passes.memory_bytes()
    }
}
