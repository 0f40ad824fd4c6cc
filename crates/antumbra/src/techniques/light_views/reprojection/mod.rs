//! `reprojection`: one depth map from the light's centre, its fragments scattered into a map for each light point.
//!
//! Adam Marrs, Benjamin Watson and Christopher Healey, "Fast Multi-View Soft Shadowing via Fragment Reprojection",
//! 2014. Views from points of one light see nearly the same surfaces, so the casters are rasterised once; each fragment
//! of that central map is placed in every view's map, where the nearest one stays (section 3), and the views' hard
//! shadows are averaged as in [`multi_view`](super::multi_view).
//!
//! - **One matrix per view.** Two views' image positions (texels, depth) are projections of one world, so a 4 × 4 matrix
//!   maps those of the centre to those of a view. If the light points lie in one plane across the axis, as a rectangle's and
//!   a disc's do, and for a sun, the matrix is affine: nine multiplications for each fragment and view, and no division.
//! - **Four fragments, eight views.** A thread reprojects 2 × 2 texels of the central map into eight views, whose matrices
//!   are uniform. At a central scale of 2 most of the four fall into one texel of a view; those are merged first, so that
//!   2¼ atomics are left of four. The maps are the same to the bit.
//!   `bring_together = false` stores them one by one, as published; unsynchronised, the last of the four then stays.
//! - **Synchronised** by an atomic maximum on the bits of reversed depth, which is the paper's atomic minimum: every
//!   frame is the same to the bit. Unsynchronised, the last store stays, by relaxed atomics, since WGSL leaves a race of
//!   plain stores undefined.
//! - **Bias after reprojection** (section 3.1.1): a fragment lies anywhere in its texel, so the receiver's plane is
//!   raised by ½ · (|∂z/∂u| + |∂z/∂v|), half a texel's rise, on top of the bias of all our maps.
//! - **Memory** is view_size² · 4 bytes for each light point (times the faces of a cube), in batches of at most 64 MiB
//!   that add up in the mask: at 512² 64 points are one batch, and 1024 points need no more memory. The central map
//!   adds (central_scale · view_size)² · 4 bytes; `filter = copy` or `draw` doubles the batch, as section 4.3 says.
//! - **A light inside a room** (the paper's future work) has a central cube and a cube for each light point, whose
//!   faces have half the side of a plane view and overlap by two texels at their edges, so that 2 × 2 comparisons never
//!   leave one. A fragment is scattered only to the faces in which a light point may see it, mostly one.
//! - **Filtering** (section 4.1.2): four loads from the integers, a copy into a float texture, or a drawn depth texture
//!   for the hardware's comparison. Manual filtering is the default: it saves a pass over all maps, of which the
//!   receivers read a part, and half the memory.
//!
//! # Limits
//! Surfaces that the light's centre does not see cast no shadow: light leaks beneath layered occluders, more so as the light
//! grows. Views have gaps where a surface is stretched, fewer with a larger central map; but the more fragments fall into a
//! texel, the wider the nearest makes every occluder. [`reprojection_layered`](super::reprojection_layered) repairs
//! both. A scatter costs the same for any geometry: on a software rasteriser 64 views of 512² take ½ s of processor time,
//! and drawing them 1.4 s for 23 500 triangles, 9.2 s for a million. `multi_view` warps its windows to where the camera
//! looks; these views are not warped.

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::techniques::light_views::PointChoice;
use crate::techniques::{Coverage, Technique};
use glam::Vec2;

pub(crate) mod batches;
mod behind;
mod central;
#[cfg(test)]
mod cpu;
pub(crate) mod gpu_types;
mod params;
mod program;
mod resolve;
mod scatter;
mod scatter_program;
pub(crate) mod settings;
mod surfel_list;
#[cfg(test)]
mod tests;

use batches::{Engine, PreparedEngine};
pub use params::{ReprojectionBias, ReprojectionParams};
pub use settings::{ReprojectionFilter, ReprojectionPath, ReprojectionProjection};
use settings::{Settings, Source, Splat};

/// Reprojection of one central map.
#[derive(Debug)]
pub struct Reprojection {
    engine: Engine,
}

impl Technique for Reprojection {
    const NAME: &'static str = "reprojection";
    type Params = ReprojectionParams;
    type Prepared = PreparedEngine;

    fn coverage(params: &ReprojectionParams) -> Coverage {
        params.projection.coverage()
    }

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { engine: Engine::new(gpu, Self::NAME, false) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &ReprojectionParams,
    ) -> Result<PreparedEngine, Error> {
        let settings = Settings {
            view_size: params.view_size,
            central_size: params.view_size * params.central_scale,
            points: PointChoice {
                samples: params.samples,
                sample_set: params.sample_set,
                seed: params.seed,
                shift: if params.jitter { self.engine.next_jitter() } else { Vec2::ZERO },
            },
            splat: Splat::Point,
            source: match params.path {
                ReprojectionPath::Compute => Source::LayersByCompute(1),
                ReprojectionPath::Fragment => Source::LayerByFragments,
                ReprojectionPath::FragmentTwoPass => Source::NearestWhileRasterising,
            },
            synchronized: params.synchronized,
            brings_together: params.bring_together,
            filter: params.filter,
            projection: params.projection,
            bias_before: params.bias == ReprojectionBias::Before,
            bias_scale: params.bias_scale,
        };
        self.engine.prepare(stage, frame, &settings)
    }

    fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedEngine) {
        self.engine.record(recorder, frame, prepared);
    }

    fn drawn_maps(&self) -> Vec<DrawnMap> {
        self.engine.drawn_maps()
    }

    fn memory_bytes(&self) -> u64 {
        self.engine.memory_bytes()
    }
}
