use crate::techniques::filterable::filterable_params;

filterable_params! {
    /// Parameters of [`Esm`](super::Esm).
    pub struct EsmParams {
        /// Exponent c of e^{−c(t − z)}, over the light's depth range.
        exponent: f32 = 40.0, in 1.0..=80.0, scale Log,
            more "Less light leaks at contacts, but more errors on non-planar receivers.";
    }
}
