use crate::techniques::filterable::filterable_params;

filterable_params! {
    /// Parameters of [`Convolution`](super::Convolution).
    pub struct ConvolutionParams {
        /// Number of terms M of the Fourier series, two bytes per texel each.
        terms: u32 = 16, in 2..=64,
            more "Light leaks less far at contacts; memory and the times of blur and lookup grow in proportion.";
    }
}
