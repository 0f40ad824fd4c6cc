use antumbra_light::SampleSet;

use super::settings::{ReprojectionFilter, ReprojectionPath, ReprojectionProjection};
use crate::contract::{param_choice, params};

param_choice! {
    /// Step at which [`Reprojection`](super::Reprojection) adds its bias.
    pub enum ReprojectionBias {
        /// After reprojection, to the receiver's plane in each view.
        After = "after",
        /// Before reprojection, to the central map's fragments.
        Before = "before",
    }
}

params! {
    /// Parameters of [`Reprojection`](super::Reprojection).
    pub struct ReprojectionParams {
        /// Texels along a side of each view, twice those of a cube's face.
        view_size: u32 = 512, in 16..=4096, unit "texels", scale Log,
            more "Sharper contacts and finer occluders; memory and fill cost grow with the square of the size.";
        /// Number of light samples, and of views. A light of points has one for each point.
        samples: u32 = 64, in 1..=1024, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Distribution of the light samples.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson is as published and converges more slowly.";
        /// Side of the central map, as a multiple of a view's.
        central_scale: u32 = 2, in 1..=4,
            more "Fills gaps that leak light, but widens occluders; time grows with the square of the scale.";
        /// Keeps the nearest fragment of a texel; otherwise the last one stored remains.
        synchronized: bool = true,
            more "true gives the same image every time; with false, scenes of high depth complexity flicker.";
        /// Combines fragments of 2 × 2 texels that fall into one texel, nearest first, before storing. Not for
        /// fragment_two_pass, which stores them one by one.
        bring_together: bool = true,
            more "false, as published, takes twice the stores for the same image, or a coarser image if unsynchronised.";
        /// Shader stage that scatters.
        path: ReprojectionPath = ReprojectionPath::Compute,
            more "compute and fragment differ only in time; fragment_two_pass needs no central map, but draws the casters \
                 again for each batch and reprojects hidden fragments too.";
        /// Comparison of the integer maps with receivers.
        filter: ReprojectionFilter = ReprojectionFilter::Manual,
            more "manual and copy compare each texel with the receiver's plane; draw compares one depth, as in the paper, and \
                 detaches contacts at grazing angles.";
        /// Step at which the bias is added.
        bias: ReprojectionBias = ReprojectionBias::After,
            more "before is the paper's counterexample: surfaces shadow themselves.";
        /// Shape of the central map.
        projection: ReprojectionProjection = ReprojectionProjection::Auto,
            more "cube covers all directions around a light inside a room, and takes five to six times the memory.";
        /// Moves all light samples together in every frame.
        jitter: bool = false,
            more "The mean over frames converges; a single frame is no better.";
        shared seed;
        shared bias_scale;
    }
    Fast { view_size: 256, samples: 16, }
    High { samples: 256, }
    Best { view_size: 1024, samples: 1024, }
    => Paper {
        sample_set: SampleSet::PoissonDisc, ours "Points of the R2 sequence.";
        bring_together: false, ours "Of four neighbours that fall into one texel, only the nearest is stored.";
        filter: ReprojectionFilter::Draw, ours "Each texel is compared with the receiver's plane; the hardware filter compares one depth.";
        projection: ReprojectionProjection::Plane, ours "A light inside a room has a cube as its central map.";
    } kept {
        "Unsynchronised stores (synchronized = false) are relaxed atomics, because a race of plain stores is undefined behaviour.",
        "The bias is derived from the texel and the receiver's slope; the paper states none.",
        "Maps are created in batches of at most 64 MiB, which are added to the mask one after the other.",
    }
}
