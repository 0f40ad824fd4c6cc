use antumbra_light::SampleSet;

use crate::contract::{MapSize, param_choice, params};

param_choice! {
    /// Depth that [`Pcss`](super::Pcss) compares a texel with.
    pub enum PcssCompare {
        /// The receiver's plane at the texel's centre.
        Plane = "plane",
        /// The receiver's own depth, as in the sketch; papers compare against this form.
        Flat = "flat",
    }
}

param_choice! {
    /// Blockers of which [`Pcss`](super::Pcss) takes a mean depth.
    pub enum PcssMeans {
        /// The blockers of each layer.
        Layers = "layers",
        /// The blockers of all layers in each quarter of the range of depths.
        Ranges = "ranges",
    }
}

params! {
    /// Parameters of [`Pcss`](super::Pcss).
    pub struct PcssParams {
        shared map_size, more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Number of samples of the filter.
        samples: u32 = 64, in 1..=4096, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Number of samples of the blocker search.
        search_samples: u32 = 64, in 1..=4096, scale Log,
            more "Fewer thin occluders are missed; time grows in proportion.";
        /// Distribution of the samples over the light.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson looks more uniform, but converges more slowly.";
        /// Depth that each texel is compared with.
        compare: PcssCompare = PcssCompare::Plane,
            more "With flat, as published, tilted receivers shadow themselves unless `bias_scale` is larger, which detaches contacts.";
        /// Second search at the scale of the nearest blocker, where it is much nearer than the mean; only with `plane`.
        attach_contacts: bool = true,
            more "false, as published, uses one layer and one mean depth of all blockers, and leaks light at contacts.";
        /// Number of peeled layers of casters to search; needs `attach_contacts`, and one with a host's map.
        layers: u32 = 3, in 1..=4,
            more "Less light leaks below stacked occluders; each layer takes one more pass over the casters and one more map.";
        /// Blockers that share a mean depth; needs `attach_contacts`.
        means: PcssMeans = PcssMeans::Layers,
            more "ranges computes separate widths for near and far occluders, and reads every layer for each.";
        /// Random offset of a rectangle's samples per pixel, random rotation of other shapes' samples.
        rotate: bool = true,
            more "true shows noise, false shows banding.";
        shared seed;
        shared sub;
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(640), samples: 40, search_samples: 32, layers: 1, }
    High { map_size: MapSize::Texels(2048), samples: 128, search_samples: 128, layers: 4, }
    Best { map_size: MapSize::Texels(4096), samples: 1024, search_samples: 1024, layers: 4, means: PcssMeans::Ranges, }
}
