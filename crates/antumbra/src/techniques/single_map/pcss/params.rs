use antumbra_light::SampleSet;

use crate::contract::{param_choice, params};

param_choice! {
    /// What [`Pcss`](super::Pcss) compares a texel with.
    pub enum PcssCompare {
        /// The receiver's plane at the texel's centre.
        Plane = "plane",
        /// The receiver's own depth, as the sketch does and papers measure against.
        Flat = "flat",
    }
}

param_choice! {
    /// What [`Pcss`](super::Pcss) takes a mean depth of.
    pub enum PcssMeans {
        /// Each layer's blockers.
        Layers = "layers",
        /// The blockers of each quarter of the range of depths, of all layers.
        Ranges = "ranges",
    }
}

params! {
    /// Parameters of [`Pcss`](super::Pcss).
    pub struct PcssParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and fill grow with the square.";
        /// Taps of the filter.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Taps of the blocker search.
        search_samples: u32 = 64, in 1..=4096, scale Log,
            more "Fewer thin occluders missed; time grows in proportion.";
        /// How the taps are spread over the light.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge alike; poisson is more even to the eye and slower to converge.";
        /// What each texel is compared with.
        compare: PcssCompare = PcssCompare::Plane,
            more "flat is the sketch's: tilted receivers shadow themselves, unless `bias_scale` rises and contacts detach.";
        /// Look again at the nearest blocker's own scale where it is much nearer than the mean; with `plane` alone.
        attach_contacts: bool = true,
            more "false takes one layer and one mean depth for all blockers, as the sketch does, and leaks at contacts.";
        /// Layers of casters that are searched, each the nearest of what lies behind the one before; with `attach_contacts`
        /// and a map of our own.
        layers: u32 = 3, in 1..=4,
            more "Light leaks less under stacked occluders; each is one more pass over the casters and one more map.";
        /// What a mean depth is taken of; with `attach_contacts`.
        means: PcssMeans = PcssMeans::Layers,
            more "ranges gives a near and a far occluder widths of their own, and reads every layer for each.";
        /// Shift a rectangle's taps by a random offset at each pixel; turn those of other shapes by a random angle.
        rotate: bool = true,
            more "true shows noise where false shows bands.";
        shared seed;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: 640, samples: 40, search_samples: 32, layers: 1, }
    High { map_size: 2048, samples: 128, search_samples: 128, layers: 4, }
    Best { map_size: 4096, samples: 1024, search_samples: 1024, layers: 4, means: PcssMeans::Ranges, }
}
