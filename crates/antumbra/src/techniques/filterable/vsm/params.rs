use crate::techniques::filterable::{MomentStorage, filterable_params};

filterable_params! {
    /// Parameters of [`Vsm`](super::Vsm).
    pub struct VsmParams {
        /// How the moments are stored.
        storage: MomentStorage = MomentStorage::Float32,
            more "float32 holds deep scenes; unorm16 and float16 take half of the memory and bleed from noise.";
        /// Visibilities up to this count as dark, and the rest is stretched.
        bleeding_reduction: f32 = 0.0, in 0.0..=0.95,
            more "Less light bleeding, and narrower penumbrae.";
    }
}
