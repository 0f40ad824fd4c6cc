use crate::techniques::filterable::filterable_params;

filterable_params! {
    /// Parameters of [`Convolution`](super::Convolution).
    pub struct ConvolutionParams {
        /// Number of terms M of the Fourier series, two bytes per texel each.
        terms: u32 = 16, in 2..=64,
            more "Contacts leak less far; memory, blur and lookup all grow in proportion.";
    }
}
