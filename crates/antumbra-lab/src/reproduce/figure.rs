//! Figures that rules are about.

use std::fmt;

/// Which figure a rule is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Milliseconds of what the row names.
    Ms,
    /// Root of the mean squared error.
    Rmse,
    /// Mean visibility where the reference is umbra.
    UmbraLeak,
    /// Mean of what is missing where the reference is lit.
    LitLoss,
    /// Rms of the error's detail where the reference is smooth: noise, bands, texels, seams.
    Noise,
    /// Rms of the mask's change from frame to frame less the truth's.
    Flicker,
    /// Memory, MiB.
    MemoryMib,
}

impl Figure {
    /// Whether images are compared for it.
    pub fn is_of_images(self) -> bool {
        matches!(self, Self::Rmse | Self::UmbraLeak | Self::LitLoss | Self::Noise | Self::Flicker)
    }

    /// A value for readers.
    pub fn text(self, value: f64) -> String {
        match self {
            Self::Ms => format!("{value:.3} ms"),
            Self::Rmse | Self::UmbraLeak | Self::LitLoss | Self::Noise | Self::Flicker => format!("{value:.4}"),
            Self::MemoryMib => format!("{value:.1} MiB"),
        }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ms => "time",
            Self::Rmse => "rmse",
            Self::UmbraLeak => "umbra leak",
            Self::LitLoss => "lit loss",
            Self::Noise => "noise",
            Self::Flicker => "flicker",
            Self::MemoryMib => "memory",
        })
    }
}
