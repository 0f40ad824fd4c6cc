use antumbra_light::SampleSet;

use crate::contract::params;

params! {
    /// Parameters of [`RayTraced`](super::RayTraced).
    pub struct RayTracedParams {
        /// Rays a pixel, to points of the light; a list of points is asked for each.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// How the rays' ends are spread over the light.
        sample_set: SampleSet = SampleSet::Sobol,
            more "sobol is the most even for powers of two, r2 and stratified for other numbers.";
        /// Shift the points by a random offset at each pixel, but for those of a list and of a picture.
        rotate: bool = true,
            more "true shows noise where false shows bands.";
        /// Picks the points.
        seed: u32 = 1, in 0..=65535,
            more "Another set of the same quality.";
        /// Scale of the distance off their surface at which rays start where casters are not closed.
        bias_scale: f32 = 1.0, in 0.0..=8.0,
            more "Above 1 detaches contact shadows by thousandths of a pixel's width, below 1 risks acne on open meshes.";
    }
    Fast { samples: 16, }
    High { samples: 256, }
    Best { samples: 1024, }
}
