use crate::contract::param_choice;
use crate::techniques::filterable::filterable_params;

param_choice! {
    /// Depth distributions that [`Moment`](super::Moment) considers.
    pub enum MomentProblem {
        /// Distributions over all depths: cheaper, and the common choice.
        Hamburger = "hamburger",
        /// Distributions within the light's depth range only: slightly less light bleeding.
        Hausdorff = "hausdorff",
    }
}

param_choice! {
    /// Storage format of four moments.
    pub enum FourMomentStorage {
        /// 16-bit fixed point, 64 bits per texel.
        Unorm16 = "unorm16",
        /// 32-bit float, 128 bits per texel.
        Float32 = "float32",
    }
}

filterable_params! {
    /// Parameters of [`Moment`](super::Moment).
    pub struct MomentParams {
        /// Depth distributions that are considered.
        problem: MomentProblem = MomentProblem::Hamburger,
            more "hausdorff uses the fact that no depth is outside the light's range, and takes more arithmetic.";
        /// Storage format of the moments.
        storage: FourMomentStorage = FourMomentStorage::Unorm16,
            more "float32 needs less bias against rounding, so less light bleeds, and takes twice the memory.";
    }
}
