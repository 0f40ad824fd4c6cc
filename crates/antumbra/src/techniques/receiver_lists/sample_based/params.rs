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
            more "Smoother penumbrae; eight times as many samples take about twice the time.";
        /// Distribution of the light samples.
        sample_set: SampleSet = SampleSet::Relaxed,
            more "relaxed and stratified have the least error, r2 and sobol a tenth more; poisson converges more slowly.";
        shared seed;
        /// Method that finds the light samples behind a plane.
        evaluation: SampleEvaluation = SampleEvaluation::Exact,
            more "exact gives the same bits as the ray tracer; lookup, the paper's, has an error of up to a cell of the table.";
        /// Cells along each axis of the lookup table.
        lookup_size: u32 = 128, in 16..=256, unit "cells", scale Log,
            more "Finer planes; memory grows with the cube of the size: 32 MiB at 128 for each 128 light points.";
        shared map_size of lists;
        /// Method by which triangles find the receivers that they may shadow.
        traversal: Traversal = Traversal::Groups,
            more "raster is the paper's; the shadows are identical.";
        /// Region of the light's map over which a triangle is drawn, where triangles are drawn.
        region: RegionOfInfluence = RegionOfInfluence::Boxes,
            more "hexagons, the paper's, encloses the light in an ellipsoid and takes a pass over the triangles; the shadows \
                 are identical.";
        /// Stores receivers' positions in the lists, where triangles are drawn; otherwise they come from the depth buffer.
        stored_positions: bool = false,
            more "true saves a depth buffer read per test and takes 32 bytes per pixel; the shadow is the same.";
        /// Early depth test that discards fragments over empty lists, on devices that have one.
        stencil: bool = false,
            more "true skips fragments over empty lists and takes a pass over each window; the shadow is the same.";
        /// Stops when every light sample of every receiver of a group is hidden.
        stop_when_occluded: bool = true,
            more "true saves time in the umbra; the shadow is the same.";
        /// Tests a single light sample where no silhouette lies between the receivers and the light.
        penumbra_only: bool = false,
            more "true saves tests in wide umbrae and takes a silhouette test everywhere; the shadow is the same.";
        /// Skips triangles whose plane has receivers and light on one side; drawn ones are clipped by their plane.
        cut_by_plane: bool = true,
            more "true saves time near large triangles; the shadow is the same.";
        /// Skips triangles of closed meshes that face all of the light.
        cull_facing: bool = true,
            more "true saves up to half of the triangles; the shadow is the same.";
        shared weights, more "With irradiance, equation 1, the mask is the visible fraction of an area light's irradiance in \
             each channel; it takes a pass, and 4 bytes per pixel for each 32 samples.";
        shared sub;
        /// Random rotation of the light samples at each pixel, where the light's shape allows.
        rotate: bool = false,
            more "With few samples, true shows noise instead of banding.";
        /// Different light samples in each frame, averaged over the frames since something last moved.
        accumulate: bool = false,
            more "With true, noise and banding fade while nothing moves; takes a pass over pixels and casters, and 12 bytes per pixel.";
        /// Keeps every pixel's bits for the host to read.
        keep_bits: bool = false,
            more "true takes one bit of memory per pixel and light point.";
        /// Counts tests, for the host to read.
        count_tests: bool = false,
            more "true takes a little time.";
        shared bias_scale of rays;
    }
    Fast { samples: 32, }
    High { samples: 512, }
    Best { samples: 1024, }
    => Paper {
        evaluation: SampleEvaluation::Lookup, ours "Each light point is tested against each plane.";
        traversal: Traversal::Raster, ours "Groups of 64 receivers test the triangles in front of them.";
        region: RegionOfInfluence::Hexagons, ours "The convex hull of three boxes, with twelve corners.";
        stored_positions: true, ours "Lists contain pixels, whose positions are read from the depth buffer.";
        stencil: true, ours "Fragments over empty lists are not discarded early; they return at once.";
        penumbra_only: true, ours "All light points are tested everywhere: finding silhouettes takes longer than it saves.";
        stop_when_occluded: false, ours "A group of receivers stops once all its light samples are hidden.";
    } kept {
        "Bits are cleared by atomics, because WebGPU has no bitwise blending.",
        "A depth test replaces the paper's stencil, and a word per texel records which texels the regions of silhouettes exclude.",
        "The region of a silhouette edge is that of its triangles; the paper computes one for the edge.",
        "A region is clipped by its triangle's plane per fragment; the paper clips the polygon.",
        "Only groups use the receivers' distance from the light; lists do not.",
    }
}
