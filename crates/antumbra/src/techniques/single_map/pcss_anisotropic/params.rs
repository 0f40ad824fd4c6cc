use antumbra_light::SampleSet;

use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Shape that [`PcssAnisotropic`](super::PcssAnisotropic) samples.
    pub enum AnisotropicKernel {
        /// A parallelogram for a rectangle, an ellipse for everything else.
        Light = "light",
        /// A parallelogram with two horizontal sides, whatever the light.
        Parallelogram = "parallelogram",
        /// An ellipse, whatever the light.
        Ellipse = "ellipse",
    }
}

params! {
    /// Parameters of [`PcssAnisotropic`](super::PcssAnisotropic).
    pub struct PcssAnisotropicParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and fill grow with the square.";
        /// Number of samples of the filter.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae and distances; time grows in proportion.";
        /// Number of samples of the blocker search.
        search_samples: u32 = 64, in 1..=4096, scale Log,
            more "Fewer thin occluders missed; time grows in proportion.";
        /// Shape that is sampled.
        kernel: AnisotropicKernel = AnisotropicKernel::Light,
            more "parallelogram is as published; light is more exact for disks, ellipse softer at a rectangle's corners.";
        /// Distribution of the samples.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson looks more even and converges more slowly.";
        /// Random offset of the samples per pixel.
        rotate: bool = true,
            more "true shows noise, false shows bands.";
        shared seed;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), samples: 16, search_samples: 16, }
    High { map_size: MapSize::Texels(2048), samples: 128, search_samples: 128, }
    Best { map_size: MapSize::Texels(4096), samples: 1024, search_samples: 1024, }
    => Paper {
        kernel: AnisotropicKernel::Parallelogram, ours "An ellipse for a light that is round.";
    } kept {
        "The virtual shadow maps of predicted resolution are not part of this technique.",
        "The search knows several scales and counts what hides a point of the light, as in pcss.",
    }
}
