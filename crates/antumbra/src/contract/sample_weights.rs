//! What light samples count, of techniques that test each by itself.

use std::fmt;

use super::{ParamSpec, ParamType, param_choice};

param_choice! {
    /// What each light sample counts in a receiver's visibility.
    pub enum SampleWeights {
        /// Its luminance: lighting and visibility are apart.
        Emission = "emission",
        /// What it gives the receiver: emission, both cosines, the distance. The mask is then the part of the light's own irradiance that
        /// arrives, 0 where the light is wholly below the horizon: analytic irradiance times the mask is what arrives.
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
