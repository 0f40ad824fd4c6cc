use crate::techniques::filterable::{MomentStorage, filterable_params};

filterable_params! {
    /// Parameters of [`Vsm`](super::Vsm).
    pub struct VsmParams {
        /// Storage format of the moments.
        storage: MomentStorage = MomentStorage::Float32,
            more "float32 is precise enough for deep scenes; unorm16 and float16 take half the memory, but their rounding bleeds light.";
        /// Visibility up to this value becomes 0; the rest is rescaled to [0, 1].
        bleeding_reduction: f32 = 0.0, in 0.0..=0.95,
            more "Less light bleeding, but narrower penumbrae.";
    }
}
