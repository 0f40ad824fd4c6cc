use antumbra_light::SampleSet;

use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Part of a map that [`Backprojection`](super::Backprojection) treats as one occluder.
    pub enum BackprojectionOccluders {
        /// Each texel: a rectangle parallel to the map, extended to its left and its lower neighbour.
        Patches = "patches",
        /// All adjacent texels, inside one outline.
        Outlines = "outlines",
    }
}

param_choice! {
    /// Neighbours that [`Backprojection`](super::Backprojection) treats as the same occluder.
    pub enum BackprojectionGaps {
        /// Neighbours on the same surface: the step between the two is no steeper than 83 degrees.
        Surfaces = "surfaces",
        /// All neighbours in front of the receiver.
        All = "all",
    }
}

params! {
    /// Parameters of [`Backprojection`](super::Backprojection).
    pub struct BackprojectionParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Occluders that are projected onto the light.
        occluders: BackprojectionOccluders = BackprojectionOccluders::Outlines,
            more "outlines counts each area of a surface once; patches adds the areas of all texels, which is too dark where they overlap.";
        /// Neighbours at another depth that an outline includes, or to which a patch is extended.
        gaps: BackprojectionGaps = BackprojectionGaps::All,
            more "surfaces leaks light between two occluders where the map does not show what is there, and counts areas that \
                 both hide twice.";
        /// Maximum number of squares along the part of the map through which a receiver sees the light, and along each inner ring of
        /// smaller squares. A square of several texels shows one of them.
        squares: u32 = 16, in 4..=64, scale Log,
            more "Finer occluders in wide penumbrae and less noise; time grows with the square of the number.";
        /// Number of points of an ellipsoid, an emission texture, a list of points, or a light seen edge-on; other lights are areas.
        samples: u32 = 64, in 1..=256, scale Log,
            more "Smoother penumbrae of such lights; time grows in proportion.";
        /// Distribution of the points over such a light.
        sample_set: SampleSet = SampleSet::Sobol,
            more "sobol is the most uniform for powers of two, r2 and stratified for other numbers.";
        /// Random choice per pixel of the texel that a square of several shows, and random offset of the points.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        shared seed;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(640), squares: 8, samples: 32, }
    High { map_size: MapSize::Texels(2048), squares: 32, samples: 128, }
    Best { map_size: MapSize::Texels(4096), squares: 64, samples: 256, }
    => Paper {
        occluders: BackprojectionOccluders::Patches, ours "The outlines of the 2007 paper: each area of a surface is counted once.";
        squares: 64, ours "Few squares represent many texels.";
        rotate: false, ours "Each pixel chooses at random which texel a square represents: noise instead of banding.";
    } kept {
        "Rings of squares that are smaller towards the receiver and represent one texel each; the papers use one coarser level \
         of the map per receiver.",
        "The area of a disk, a sphere and a sun is exact too; the papers have rectangles only.",
        "An emission texture is sampled at points; the papers take sums from a table.",
        "The part of the light below the receiver's horizon is hidden.",
    }
}
