use antumbra_light::SampleSet;

use crate::contract::{SampleWeights, param_choice, params};
use crate::techniques::receiver_lists::Traversal;

param_choice! {
    /// Method by which [`SampleBased`](super::SampleBased) finds the light points behind a plane.
    pub enum SampleEvaluation {
        /// Each light point is tested.
        Exact = "exact",
        /// A table of planes contains the bits of 128 points at a time.
        Lookup = "lookup",
    }
}

param_choice! {
    /// Region of the light's map over which a triangle is drawn.
    pub enum RegionOfInfluence {
        /// The convex hull of three boxes, twelve corners.
        Boxes = "boxes",
        /// The convex hull of three hexagons about the ellipses that the light projects through the corners, as published.
        Hexagons = "hexagons",
    }
}

params! {
    /// Parameters of [`SampleBased`](super::SampleBased).
    pub struct SampleBasedParams {
        /// Number of light samples. A light of points has one for each point.
        samples: u32 = 256, in 1..=1024, scale Log,
            more "Smoother penumbrae; eight times as many cost about twice as much.";
        /// Distribution of the light samples.
        sample_set: SampleSet = SampleSet::Relaxed,
            more "relaxed and stratified have the least error; r2 and sobol a tenth more; poisson converges more slowly.";
        shared seed;
        /// Method that finds the light samples behind a plane.
        evaluation: SampleEvaluation = SampleEvaluation::Exact,
            more "exact gives the ray tracer's bits; lookup is the paper's, and off by the table's cells.";
        /// Cells along each axis of the lookup table.
        lookup_size: u32 = 128, in 16..=256, unit "cells", scale Log,
            more "Finer planes; memory grows with the cube, 32 MiB at 128 for each 128 light points.";
        shared map_size of lists;
        /// Method by which triangles find the receivers that they may shadow.
        traversal: Traversal = Traversal::Groups,
            more "raster is the paper's way; the shadow is the same, bit for bit.";
        /// Region of the light's map over which a triangle is drawn, where triangles are drawn.
        region: RegionOfInfluence = RegionOfInfluence::Boxes,
            more "hexagons is the paper's: an ellipsoid about the light, a pass over the triangles; the shadow is the same, bit for bit.";
        /// Stores receivers' positions in the lists, where triangles are drawn; otherwise they come from the depth buffer.
        stored_positions: bool = false,
            more "Saves each test a read of the depth buffer, for 32 bytes per pixel; changes nothing else.";
        /// Early depth test that discards fragments over empty lists, on devices that have one.
        stencil: bool = false,
            more "Saves fragments that would end at once, for a pass over each window; changes nothing else.";
        /// Stops when every light sample of every receiver of a group is hidden.
        stop_when_occluded: bool = true,
            more "Saves time in the umbra, changes nothing else.";
        /// Tests a single light sample where no silhouette lies between the receivers and the light.
        penumbra_only: bool = false,
            more "Saves tests in wide umbrae and costs a silhouette test everywhere; changes nothing else.";
        /// Skips triangles whose plane has receivers and light on one side; drawn ones are clipped by their plane.
        cut_by_plane: bool = true,
            more "Saves time near large triangles, changes nothing else.";
        /// Skips triangles of closed meshes that face all of the light.
        cull_facing: bool = true,
            more "Saves up to half of the triangles, changes nothing else.";
        shared weights, more "irradiance is equation 1: the mask is the part of an area light's own irradiance that arrives, channel by channel; \
                  costs a pass, and 4 bytes a pixel for each 32 samples.";
        shared sub;
        /// Random rotation of the light samples at each pixel, where the light's shape allows.
        rotate: bool = false,
            more "Shows noise instead of bands with few samples.";
        /// Different light samples in each frame, averaged over the frames since something last moved.
        accumulate: bool = false,
            more "Noise and bands fade while nothing moves; costs a pass over pixels and casters, and 12 bytes a pixel.";
        /// Keeps every pixel's bits for the host to read.
        keep_bits: bool = false,
            more "Costs a bit of memory for each pixel and light point.";
        /// Counts tests, for the host to read.
        count_tests: bool = false,
            more "Costs a little time.";
        shared bias_scale of rays;
    }
    Fast { samples: 32, }
    High { samples: 512, }
    Best { samples: 1024, }
    => Paper {
        evaluation: SampleEvaluation::Lookup, ours "Each light point is tested against each plane.";
        traversal: Traversal::Raster, ours "Groups of 64 receivers walk the triangles before them.";
        region: RegionOfInfluence::Hexagons, ours "The hull of three boxes, twelve corners.";
        stored_positions: true, ours "Lists hold pixels, whose positions come from the depth buffer.";
        stencil: true, ours "Fragments over empty lists end where they begin.";
        penumbra_only: true, ours "All light points are tested everywhere: looking for silhouettes takes longer than it saves.";
        stop_when_occluded: false, ours "A group of which all is hidden stops.";
    } kept {
        "Bits are cleared by atomics: fragments of WebGPU have no bitwise blending.",
        "The paper's stencil is a depth test; what silhouettes' regions leave out of it is a word for each texel.",
        "A silhouette's region is that of its triangles, where the paper has the edge's own.",
        "A triangle's plane cuts its region off where fragments begin, where the paper cuts the polygon.",
        "Lists take distance from the light into account by the groups alone.",
    }
}
