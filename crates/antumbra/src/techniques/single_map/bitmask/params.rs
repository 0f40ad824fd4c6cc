use antumbra_light::SampleSet;

use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Neighbours to which [`Bitmask`](super::Bitmask) extends a patch.
    pub enum BitmaskGaps {
        /// No neighbours: gaps stay open.
        Open = "open",
        /// Neighbours on the same surface: the step between the two is no steeper than 83 degrees.
        Surfaces = "surfaces",
        /// All neighbours in front of the receiver.
        All = "all",
    }
}

params! {
    /// Parameters of [`Bitmask`](super::Bitmask).
    pub struct BitmaskParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Number of light points, one bit each.
        samples: u32 = 64, in 1..=256, scale Log,
            more "Smoother penumbrae; time grows less than in proportion.";
        /// Number of patches along the light: squares of the map are split until each hides less of the light, or is a texel.
        /// A square of several texels shows one of them.
        patches: u32 = 16, in 4..=64, scale Log,
            more "Finer occluders in wide penumbrae and less noise; time grows with the square of the number.";
        /// Gaps that are filled between patches at different depths.
        gaps: BitmaskGaps = BitmaskGaps::Surfaces,
            more "open leaks light through tilted occluders, which fall apart into strips; all also closes real gaps between \
                 two occluders.";
        /// Distribution of the points over the light.
        sample_set: SampleSet = SampleSet::Sobol,
            more "sobol is the most uniform for powers of two, r2 and stratified for other numbers.";
        /// Number of peeled layers of casters that hide points; one with a host's map.
        layers: u32 = 3, in 1..=4,
            more "Less light leaks below stacked occluders; each layer takes one more pass over the casters and one more map.";
        /// Random offset of a rectangle's points per pixel, random rotation of other shapes' points, and random choice of the
        /// texel that a patch of several shows.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        shared seed;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(640), samples: 32, patches: 8, layers: 2, }
    High { map_size: MapSize::Texels(2048), samples: 128, patches: 32, layers: 4, }
    Best { map_size: MapSize::Texels(4096), samples: 256, patches: 64, layers: 4, }
    => Paper {
        gaps: BitmaskGaps::All, ours "Gaps between two surfaces stay open.";
        patches: 64, ours "Squares of up to a sixteenth of the light's width represent their texels.";
        rotate: false, ours "The points are offset at each pixel: noise instead of banding.";
    } kept {
        "A square of several texels that is narrower than 1/64 of the light is represented by one of them; the paper projects every texel.",
        "Squares are nodes of a quadtree over a min/max pyramid; the paper has a multi-scale map.",
        "A table narrows the points down to a few, which are tested one by one; the paper takes the bits of a rectangle from tables.",
        "Only micro-patches are implemented; the paper also has micro-quads between texel centres.",
        "Points below the receiver's horizon are hidden.",
    }
}
