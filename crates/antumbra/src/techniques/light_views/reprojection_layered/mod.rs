//! `reprojection_layered`: fragments of several layers, each covering its footprint in every view.
//!
//! [`reprojection`](super::reprojection) (Marrs, Watson, Healey 2014) leaks light where the centre does not see an
//! occluder, and widens occluders where several fragments share a texel. Two changes repair it:
//!
//! - **Layers.** The nearest surfaces behind the first one are reprojected too, peeled one geometry pass each (Everitt
//!   2001). Back faces of closed meshes are left out, because a solid's front blocks what its back would block: the second
//!   layer is then the next object and not the first one's far side. `source = all` peels nothing and reprojects every
//!   fragment of one rasterisation.
//! - **Surfels.** A fragment is a piece of a plane, whose gradient the rasteriser knows. Its square in the central map
//!   is some quadrilateral in a view; it is stored at the texel centres inside it, with the plane's depth there. Depths
//!   are then those of a rasterised view: no bias beyond the one of all our maps, no widening, no gaps in a stretched
//!   surface, and at a central scale of 2 three of four fragments store nothing, which saves their atomics.
//!
//! Alternatives, at 64 × ½ points of 512² views on a software adapter, 256 × 144 pixels: rmse (leak) against
//! `multi_view` with the same points, and the scatter's time in units of `reprojection`'s.
//!
//! | | window | shanty | knot | columns | tree | time |
//! |---|---|---|---|---|---|---|
//! | `reprojection`, scale 2 | .067 (.012) | .076 (.015) | .043 (.011) | .025 (.001) | .089 (.040) | 1 |
//! | 4 layers, points, scale 2 | .037 (.002) | .058 (.004) | .024 (.002) | .025 (.000) | .059 (.006) | 2–3 |
//! | 2 layers, points near a centre, scale 4 | .022 (.002) | .035 (.003) | .016 (.002) | .014 (.000) | .053 (.020) | 3–8 |
//! | 4 layers, surfels, scale 1 | .024 (.004) | .055 (.007) | .019 (.003) | .016 (.002) | .038 (.013) | ½–1 |
//! | 2 layers, surfels, scale 2 | .016 (.003) | .026 (.005) | .013 (.003) | .009 (.001) | .063 (.035) | 1½–2 |
//! | 4 layers, surfels, scale 2: the default | .014 (.003) | .024 (.004) | .011 (.002) | .009 (.001) | .026 (.011) | 2–3 |
//!
//! Two layers with the solids' far sides (`shanty`: .068, .019) are as good as one layer without them; every fragment
//! (`source = all`) leaks least (`shanty`: half of four layers' leak) but costs a software rasteriser four times the
//! time. Shortening a surfel's rising end where its neighbours in the centre do not continue it gains 5 % of rmse for
//! four loads per fragment and layer, and is not done.
//!
//! **Flat pieces.** 2 × 2 fragments of one plane, with slopes within a sixteenth of a texel's width per texel, are one
//! surfel of twice the side, at a quarter of the cost (`window`: the scatter takes .72 of the time without flat pieces).
//!
//! **Error over the light's size**, the paper's one limitation: `shanty` at 256 × 144, 64 views of 512², rmse (leak)
//! against the ray tracer. The error of a small light is from the map's texels, which a large one blurs.
//!
//! | light | ¼ | ½ | 1 | 2 | 4 | 8 times |
//! |---|---|---|---|---|---|---|
//! | `reprojection` | .104 (.008) | .093 (.010) | .092 (.017) | .103 (.026) | .095 (.034) | .105 (.050) |
//! | `reprojection_layered` | .070 (.010) | .061 (.009) | .052 (.008) | .043 (.008) | .039 (.010) | .040 (.014) |
//!
//! **Memory.** A view is view_size² · 4 bytes, 4 MiB at the default 1024²; at most 64 MiB of them exist at the same time and
//! are added to the mask, whatever their number. A layer is (central_scale · view_size)² · 8 bytes, depth and a 16-bit
//! gradient: four layers of 2048² are 128 MiB. The list of surfels has space for one name per texel, 4 bytes each, up to 64 MiB. So
//! the default takes 256 MiB in all; at a `view_size` of 512, 112 MiB.
//!
//! **Work.** Surfels are listed once per frame, and each group of eight views visits only listed ones, because behind the first layer
//! most texels are empty; this halves the time of the scatter. Flat pieces whose planes have every receiver on the light's side, such
//! as ground and walls, hide nothing and are not listed if the host's `bounds` of receivers show that: on `overlap` the scatter takes
//! .34 of the time, on `tree` .77. Errors change by at most .0002, except on `lantern-wall` (.0087 instead of .0089) and `hall`
//! (.0195 instead of .0220, 160 × 90), whose walls then do not darken themselves.
//!
//! **Casters near the light.** If casters may be nearer to the light than a view from its centre holds them, the central view is from
//! behind the light (`reprojection/behind.rs`); surfaces behind the light are left out, and take one layer more. Surfaces that a light
//! point sees from nearer than the central view does have larger surfels, up to 33 texels a side; surfaces at a grazing angle keep their
//! slope. Under the panel of `cover_0.01`, of 60 cm with a sheet 1 cm in front of it, the rmse is .02 instead of .90; on `sconce_near`,
//! where a bulb grazes a wall, .02 instead of .22; on `overlap`, `tree`, `window` and `columns` steep surfels change it by less than .0003.
//!
//! # Limits
//! Each fragment and view takes about twice the time of a point. Silhouettes are those of the central map, and
//! several layers' silhouettes together are a little wider than one's. A solid's side that only some light points see
//! is missing where the solid's front faces do not cover it. Meshes that are not marked closed need twice the layers. Occluders on
//! ground that is not listed do not continue along it within a texel: with a cube's coarse faces contacts come out darker.

use glam::Vec2;

use crate::contract::{DrawnMap, Error, PreparedFrame};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::techniques::light_views::PointChoice;
use crate::techniques::light_views::reprojection::batches::{Engine, PreparedEngine};
use crate::techniques::light_views::reprojection::settings::{Settings, Source, Splat};
use crate::techniques::{Coverage, Technique};

mod params;

pub use params::{ReprojectionLayeredParams, ReprojectionSource, ReprojectionSplat};

/// Maximum distance from a texel's centre at which a fragment counts as being there, texels.
const NEAR_CENTRE_TEXELS: f32 = 0.25;

/// Reprojection of several layers of one central view.
#[derive(Debug)]
pub struct ReprojectionLayered {
    engine: Engine,
}

impl Technique for ReprojectionLayered {
    const NAME: &'static str = "reprojection_layered";
    type Params = ReprojectionLayeredParams;
    type Prepared = PreparedEngine;

    fn coverage(params: &ReprojectionLayeredParams) -> Coverage {
        params.projection.coverage()
    }

    fn new(gpu: &Gpu) -> Result<Self, Error> {
        Ok(Self { engine: Engine::new(gpu, Self::NAME, true) })
    }

    fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        params: &ReprojectionLayeredParams,
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
            splat: match params.splat {
                ReprojectionSplat::Surfel => Splat::Surfel(params.steepest),
                ReprojectionSplat::NearCentre => Splat::NearCentre(NEAR_CENTRE_TEXELS),
                ReprojectionSplat::Point => Splat::Point,
            },
            source: match params.source {
                ReprojectionSource::All => Source::AllWhileRasterising,
                ReprojectionSource::Layers => Source::LayersByCompute(params.layers),
            },
            synchronized: true,
            brings_together: true,
            filter: params.filter,
            projection: params.projection,
            bias_before: false,
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
