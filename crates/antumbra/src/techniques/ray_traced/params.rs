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
            more "sobol is the most even for powers of two, r2 and stratified for other numbers.";
        shared weights, more "irradiance: the mask is the part of an area light's own irradiance that arrives; with more rays than a \
                              pass has, 4 bytes a pixel.";
        /// Random offset of the samples at each pixel, except for lights of points and emission textures.
        rotate: bool = true,
            more "true shows noise, false shows bands.";
        /// Seed of the samples.
        seed: u32 = 1, in 0..=65535,
            more "Another set of the same quality.";
        /// Scale of the ray offset on casters that are not closed.
        bias_scale: f32 = 1.0, in 0.0..=8.0,
            more "Above 1 detaches contact shadows by thousandths of a pixel, below 1 risks acne on open meshes.";
    }
    Fast { samples: 16, }
    High { samples: 256, }
    Best { samples: 1024, }
}
