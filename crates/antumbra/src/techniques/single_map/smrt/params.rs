use antumbra_light::SampleSet;

use crate::contract::{MapSize, SampleWeights, params};

params! {
    /// Parameters of [`Smrt`](super::Smrt).
    pub struct SmrtParams {
        shared map_size = MapSize::Auto, more "Sharper contacts and finer occluders; memory and fill cost grow with the square \
             of the size.";
        /// Number of rays to the light; with `smooth`, a quarter of them where penumbrae are wide, at least 16.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Smoothing over neighbouring pixels of the same surface, much narrower than the penumbra.
        smooth: bool = true,
            more "true has less noise with fewer rays; false uses only the rays of each pixel itself.";
        /// Maximum number of map reads along a ray: fewer where blockers lie at few depths.
        steps: u32 = 8, in 1..=32, scale Log,
            more "Rays miss fewer thin occluders; time grows in proportion where blockers have different depths.";
        /// Samples per pixel of the search for blocker depths, shared by the 64 pixels of a tile.
        search_samples: u32 = 8, in 1..=4096, scale Log,
            more "The blocker search of a tile misses fewer thin occluders.";
        /// Distribution of the rays' ends over the light.
        sample_set: SampleSet = SampleSet::Sobol,
            more "sobol is the most uniform for powers of two, r2 and stratified for other numbers.";
        shared weights, more "With irradiance, the mask is the visible fraction of an area light's irradiance.";
        /// Number of peeled layers of casters that rays may hit; one with a host's map.
        layers: u32 = 3, in 1..=4,
            more "Less light leaks below stacked occluders; each layer takes one more pass over the casters and one more map.";
        /// Assumed thickness of the surface in a texel, in texel widths: rays behind it pass.
        thickness: f32 = 4.0, in 0.0..=4096.0, unit "texels",
            more "Less light leaks through steep surfaces, but more light is lost behind thin ones.";
        /// Assumed thickness of the last layer, behind which nothing is known, in texel widths.
        last_thickness: f32 = 1024.0, in 0.0..=65536.0, unit "texels",
            more "Less light leaks through surfaces that are in no layer, but more light is lost behind thin ones.";
        /// Random offset of a rectangle's samples per pixel, random rotation of other shapes' samples.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        shared seed;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(640), samples: 16, layers: 2, steps: 4, }
    High { map_size: MapSize::Texels(2048), samples: 128, search_samples: 16, layers: 4, steps: 16, }
    Best { map_size: MapSize::Texels(4096), samples: 1024, search_samples: 64, layers: 4, steps: 32, }
}
