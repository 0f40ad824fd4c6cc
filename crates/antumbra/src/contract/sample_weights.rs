//! What light samples count, of techniques that test each by itself.

use super::param_choice;

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
