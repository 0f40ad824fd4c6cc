use antumbra_light::SampleSet;

use crate::contract::{param_choice, params};
use crate::techniques::light_views::reprojection::{ReprojectionFilter, ReprojectionProjection};

param_choice! {
    /// Texels in which [`ReprojectionLayered`](super::ReprojectionLayered) stores a fragment.
    pub enum ReprojectionSplat {
        /// Every texel whose centre lies in its footprint.
        Surfel = "surfel",
        /// The texel that it falls in, if it is at most a quarter of a texel from its centre.
        NearCentre = "near_centre",
        /// The texel that it falls in.
        Point = "point",
    }
}

param_choice! {
    /// Fragments that [`ReprojectionLayered`](super::ReprojectionLayered) reprojects.
    pub enum ReprojectionSource {
        /// All fragments, while they are rasterised.
        All = "all",
        /// Fragments of the nearest layers.
        Layers = "layers",
    }
}

params! {
    /// Parameters of [`ReprojectionLayered`](super::ReprojectionLayered).
    pub struct ReprojectionLayeredParams {
        /// Texels along a side of each view, twice those of a cube's face.
        view_size: u32 = 1024, in 16..=4096, unit "texels", scale Log,
            more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Number of light samples, and of views. A light of points has one for each point.
        samples: u32 = 64, in 1..=1024, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Distribution of the light samples.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson is as published and converges more slowly.";
        /// Side of the central map, as a multiple of a view's.
        central_scale: u32 = 2, in 1..=4,
            more "More exact silhouettes; time grows with the square of the scale.";
        /// Fragments that are reprojected.
        source: ReprojectionSource = ReprojectionSource::Layers,
            more "all misses no surface, however many layers there are.";
        /// Number of nearest layers of the central view, if the source is layers.
        layers: u32 = 4, in 1..=8,
            more "Fewer hidden surfaces are missed; each layer takes a geometry pass.";
        /// Texels in which a fragment is stored.
        splat: ReprojectionSplat = ReprojectionSplat::Surfel,
            more "surfel stores exact depths without gaps; near_centre needs a central_scale of 4; point widens \
                  occluders.";
        /// Steepest surface that a surfel follows, depth per width.
        steepest: f32 = 1000.0, in 0.0..=1000.0, scale Log,
            more "Fewer gaps on steep sides; surfaces at grazing angles keep their position and do not shadow themselves.";
        /// Comparison of the integer maps with receivers.
        filter: ReprojectionFilter = ReprojectionFilter::Manual,
            more "manual and copy compare each texel with the receiver's plane; draw compares one depth, as in the paper, and \
                 detaches contacts at grazing angles.";
        /// Shape of the central map.
        projection: ReprojectionProjection = ReprojectionProjection::Auto,
            more "cube covers all directions around a light inside a room, and takes five to six times the memory.";
        /// Moves all light samples together in every frame.
        jitter: bool = false,
            more "The mean over frames converges; a single frame is no better.";
        shared seed;
        shared bias_scale;
    }
    Fast { view_size: 512, samples: 16, }
    High { samples: 256, }
    Best { samples: 1024, layers: 8, }
}
