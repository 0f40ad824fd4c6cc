use antumbra_light::SampleSet;

use crate::contract::params;

params! {
    /// Parameters of [`Smrt`](super::Smrt).
    pub struct SmrtParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and fill grow with the square.";
        /// Rays to points of the light; with `smooth` a quarter of them where penumbrae are wide, but 16.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Take means over neighbouring pixels on the same surface, much narrower than the penumbra.
        smooth: bool = true,
            more "true leaves less noise of fewer rays; false gives each pixel its own rays alone.";
        /// Reads of the map along a ray at the most: fewer where blockers lie at few depths.
        steps: u32 = 8, in 1..=32, scale Log,
            more "Fewer thin occluders missed by rays; time grows in proportion where blockers differ in depth.";
        /// Taps a pixel of the search for depths with blockers, which the 64 pixels of a tile share.
        search_samples: u32 = 8, in 1..=4096, scale Log,
            more "Fewer thin occluders missed by all of a tile.";
        /// How the rays' ends are spread over the light.
        sample_set: SampleSet = SampleSet::Sobol,
            more "sobol is the most even for powers of two, r2 and stratified for other numbers.";
        /// Layers of casters that rays may hit, each the nearest of what lies behind the one before; one with a host's map.
        layers: u32 = 3, in 1..=4,
            more "Light leaks less under stacked occluders; each is one more pass over the casters and one more map.";
        /// How far behind the surface that a texel shows rays are blocked, in widths of a texel.
        thickness: f32 = 4.0, in 0.0..=4096.0, unit "texels",
            more "Less light leaks through steep surfaces; more is lost behind thin ones.";
        /// The same of the last layer, behind which nothing is known.
        last_thickness: f32 = 1024.0, in 0.0..=65536.0, unit "texels",
            more "Less light leaks through what the layers do not show; more is lost behind thin surfaces.";
        /// Shift a rectangle's points by a random offset at each pixel; turn those of other shapes by a random angle.
        rotate: bool = true,
            more "true shows noise where false shows bands.";
        shared seed;
        shared bias_scale;
    }
    Fast { map_size: 640, samples: 16, layers: 2, steps: 4, }
    High { map_size: 2048, samples: 128, search_samples: 16, layers: 4, steps: 16, }
    Best { map_size: 4096, samples: 1024, search_samples: 64, layers: 4, steps: 32, }
}
