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
        shared map_size, more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Number of samples of the filter.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae and smoother shadows in the distance; time grows in proportion.";
        /// Number of samples of the blocker search.
        search_samples: u32 = 64, in 1..=4096, scale Log,
            more "Fewer thin occluders are missed; time grows in proportion.";
        /// Shape that is sampled.
        kernel: AnisotropicKernel = AnisotropicKernel::Light,
            more "parallelogram is as published; light is more exact for disks; ellipse is softer at the corners of a rectangle.";
        /// Distribution of the samples.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson looks more uniform, but converges more slowly.";
        /// Random offset of the samples per pixel.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        shared seed;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), samples: 16, search_samples: 16, }
    High { map_size: MapSize::Texels(2048), samples: 128, search_samples: 128, }
    Best { map_size: MapSize::Texels(4096), samples: 1024, search_samples: 1024, }
    => Paper {
        kernel: AnisotropicKernel::Parallelogram, ours "The kernel of a round light is an ellipse.";
    } kept {
        "The virtual shadow maps of predicted resolution are not part of this technique.",
        "The blocker search has several scales and counts only blockers that hide a point of the light, as in pcss.",
    }
}
