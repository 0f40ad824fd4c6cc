use antumbra_light::SampleSet;

use crate::contract::{SampleWeights, params};

params! {
    /// Parameters of [`RayTraced`](super::RayTraced).
    pub struct RayTracedParams {
        /// Number of rays per pixel; a light of points gets one ray to each point.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Distribution of the rays' ends over the light.
        sample_set: SampleSet = SampleSet::Sobol,
            more "sobol is the most uniform for powers of two, r2 and stratified for other numbers.";
        shared weights, more "With irradiance, the mask is the visible fraction of an area light's irradiance; if the rays \
             need several passes, it takes 4 bytes per pixel.";
        /// Random offset of the samples at each pixel, except for lights of points and emission textures.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        /// Seed of the samples.
        seed: u32 = 1, in 0..=65535,
            more "Selects another sample set of the same quality.";
        /// Scale of the ray offset on casters that are not closed.
        bias_scale: f32 = 1.0, in 0.0..=8.0,
            more "Values above 1 detach contact shadows by thousandths of a pixel; values below 1 risk acne on open meshes.";
    }
    Fast { samples: 16, }
    High { samples: 256, }
    Best { samples: 1024, }
}
