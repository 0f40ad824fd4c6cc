use crate::contract::param_choice;
use crate::techniques::filterable::{DepthAxis, FloatStorage, filterable_params};

param_choice! {
    /// Warps of [`Evsm`](super::Evsm).
    pub enum EvsmComponents {
        /// Two moments of the positive warp.
        Two = "two",
        /// Two moments of each warp.
        Four = "four",
    }
}

filterable_params! {
    /// Parameters of [`Evsm`](super::Evsm).
    pub struct EvsmParams {
        /// Warps in use.
        components: EvsmComponents = EvsmComponents::Four,
            more "four also works on non-planar receivers, and takes twice the memory.";
        /// Exponent c of the positive warp e^{cu}, u from −1 at the near plane to 1 at the far plane; at most 42 in float32,
        /// 5.5 in float16.
        exponent: f32 = 5.0, in 0.5..=42.0, scale Log,
            more "Less light bleeding, but more errors in foliage.";
        /// Exponent of the negative warp −e^{−cu}, with the same bounds.
        exponent_negative: f32 = 10.0, in 0.5..=42.0, scale Log,
            more "Smoother shadows on near receivers, and less light bleeding where two occluders are close to each other.";
        /// Storage format of the moments.
        storage: FloatStorage = FloatStorage::Float32,
            more "float16 takes half the memory, but allows only small exponents.";
    } => Paper {
        anisotropy: 16, ours "8 probes have the same error with half the reads.";
        depth_axis: DepthAxis::Distance, ours "Depth is measured along the world axis closest to the light's axis.";
    } kept {
        "u is in [−1, 1], the paper's x in [0, 1], so its c is twice ours. The paper states no value for c.",
    }
}
