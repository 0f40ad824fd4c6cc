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
            more "Sharper contacts and finer occluders; memory and fill grow with the square.";
        /// Number of light samples, and of views. A light of points has one for each point.
        samples: u32 = 64, in 1..=1024, scale Log,
            more "Smoother penumbrae; time grows in proportion.";
        /// Distribution of the light samples.
        sample_set: SampleSet = SampleSet::R2,
            more "stratified, r2 and sobol converge equally fast; poisson is as published and converges more slowly.";
        /// Side of the central map, as a multiple of a view's.
        central_scale: u32 = 2, in 1..=4,
            more "Fills gaps that leak light, and widens occluders; time grows with the square.";
        /// Keeps the nearest fragment of a texel; otherwise the last one stored remains.
        synchronized: bool = true,
            more "true gives the same image every time; without it, scenes of high depth complexity flicker.";
        /// Combines fragments of 2 × 2 texels that fall into one texel, nearest first, before storing. Not for
        /// fragment_two_pass, which stores them one by one.
        bring_together: bool = true,
            more "false is as published: twice the stores and the same image; unsynchronised, a coarser one.";
        /// Shader stage that scatters.
        path: ReprojectionPath = ReprojectionPath::Compute,
            more "compute and fragment differ in time alone; fragment_two_pass needs no central map but draws the \
                  casters again for each batch, and reprojects hidden fragments too.";
        /// Comparison of the integer maps with receivers.
        filter: ReprojectionFilter = ReprojectionFilter::Manual,
            more "manual and copy compare each texel with the receiver's plane; draw compares one depth, as the paper \
                  does, and detaches grazing contacts.";
        /// Step at which the bias is added.
        bias: ReprojectionBias = ReprojectionBias::After,
            more "before is the paper's counter-example: surfaces shadow themselves.";
        /// Shape of the central map.
        projection: ReprojectionProjection = ReprojectionProjection::Auto,
            more "cube sees all around a light inside a room, at five or six times the memory.";
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
        bring_together: false, ours "Of four neighbours that meet in a texel the nearest alone is stored.";
        filter: ReprojectionFilter::Draw, ours "Each texel is compared with the receiver's plane; the hardware's filter compares one depth.";
        projection: ReprojectionProjection::Plane, ours "A light inside a room has a cube for a centre.";
    } kept {
        "Unsynchronised stores (synchronized = false) are relaxed atomics, since a race of plain stores is undefined.",
        "The bias is derived from the texel and the receiver's slope; the paper names none.",
        "Maps are made in batches of at most 64 MiB, which add up in the mask.",
    }
}
