//! Weights of light samples, in techniques that test each sample by itself.

use std::fmt;

use super::{ParamSpec, ParamType, param_choice};

param_choice! {
    /// Weight of a light sample in a receiver's mask.
    pub enum SampleWeights {
        /// Luminance: the mask is visibility, and lighting is separate.
        Emission = "emission",
        /// Irradiance: emission times both cosines over the squared distance. The mask is the fraction of the light's unshadowed irradiance
        /// that arrives, by which analytic irradiance is multiplied; 0 where all of the light is below the horizon.
        Irradiance = "irradiance",
    }
}

impl SampleWeights {
    /// Name of the parameter, in all techniques that have it.
    pub const KEY: &'static str = "weights";

    /// Whether a technique has the parameter.
    pub fn is_parameter_of(specs: &[ParamSpec]) -> bool {
        specs.iter().any(|spec| spec.key == Self::KEY && spec.choices == <Self as ParamType>::CHOICES)
    }
}

impl fmt::Display for SampleWeights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value().fmt(f)
    }
}
