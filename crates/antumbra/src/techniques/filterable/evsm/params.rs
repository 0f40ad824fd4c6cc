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
            more "four also works on receivers that are not planar, for twice the memory.";
        /// Exponent c of the positive warp e^{cu}, u from −1 at the near plane to 1 at the far plane; at most 42 in float32,
        /// 5.5 in float16.
        exponent: f32 = 5.0, in 0.5..=42.0, scale Log,
            more "Less light bleeding, and more failures in foliage.";
        /// Exponent of the negative warp −e^{−cu}, with the same bounds.
        exponent_negative: f32 = 10.0, in 0.5..=42.0, scale Log,
            more "Smoother shadows on near receivers, and less light bleeding where two occluders lie close.";
        /// Storage format of the moments.
        storage: FloatStorage = FloatStorage::Float32,
            more "float16 takes half of the memory and allows small exponents alone.";
    } => Paper {
        anisotropy: 16, ours "8 probes have the same error at half the reads.";
        depth_axis: DepthAxis::Distance, ours "Depth is measured along the world's axis nearest to the light's.";
    } kept {
        "u runs from −1 to 1, where the paper's x runs from 0 to 1: its c is twice ours. It names no value for c.",
    }
}
