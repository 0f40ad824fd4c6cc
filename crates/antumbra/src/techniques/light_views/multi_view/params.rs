use antumbra_light::SampleSet;

use crate::contract::{param_choice, params};

param_choice! {
    /// Comparison of a receiver with a map of [`MultiView`](super::MultiView).
    pub enum MultiViewCompare {
        /// Exact test against the triangles that texels show; the same as `sharp` if a caster is not opaque. The casters'
        /// buffers must be readable in compute.
        Triangles = "triangles",
        /// Slopes of the texels' surfaces, with hardly any bias. Texels whose centres are nearest to the receiver count most,
        /// the more so the nearer the occluder is.
        Sharp = "sharp",
        /// Four texels, each compared with the receiver's plane at its own centre.
        Gather = "gather",
        /// The hardware's comparison sampler, with one reference depth for all four texels.
        Hardware = "hardware",
    }
}

param_choice! {
    /// Placement of [`MultiView`](super::MultiView)'s texels.
    pub enum MultiViewWindow {
        /// Windows warped to where the camera looks, with texels shifted from view to view.
        Warped = "warped",
        /// Even over the smallest rectangle, as in the papers.
        Plain = "plain",
    }
}

params! {
    /// Parameters of [`MultiView`](super::MultiView).
    pub struct MultiViewParams {
        /// Texels along a side of each view.
        view_size: u32 = 1024, in 16..=8192, unit "texels", scale Log,
            more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Number of light samples, and of views. A light of points has one for each point.
        samples: u32 = 64, in 1..=1024, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Distribution of the light samples.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson is as published and converges more slowly.";
        /// Placement of each view's texels.
        window: MultiViewWindow = MultiViewWindow::Warped,
            more "warped has finer texels near the camera and averages over what the texels of one view miss; plain has texels \
                 of one size.";
        /// Comparison of texels with a receiver.
        compare: MultiViewCompare = MultiViewCompare::Triangles,
            more "triangles finds exact edges and takes 32 bytes per pixel and at least 48 per triangle; sharp estimates edges \
                 from the texels of all views and takes 24 bytes per pixel; gather takes no memory; hardware, the papers' \
                 form, detaches contacts at grazing angles.";
        shared seed;
        shared bias_scale;
    }
    Fast { view_size: 512, samples: 16, }
    High { samples: 256, }
    Best { samples: 1024, }
}
