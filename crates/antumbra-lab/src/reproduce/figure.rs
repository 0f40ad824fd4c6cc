//! Figures that rules compare.

use std::fmt;

/// Kind of measured value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Time of the row's passes, milliseconds.
    Ms,
    /// Root mean square error.
    Rmse,
    /// Mean visibility where the reference is umbra.
    UmbraLeak,
    /// Mean missing visibility where the reference is lit.
    LitLoss,
    /// Rms of the error's detail where the reference is smooth: noise, bands, texels, seams.
    Noise,
    /// Rms change of the mask between frames minus that of the truth.
    Flicker,
    /// Memory, MiB.
    MemoryMib,
}

impl Figure {
    /// Returns whether the figure requires a comparison of images.
    pub fn is_of_images(self) -> bool {
        matches!(self, Self::Rmse | Self::UmbraLeak | Self::LitLoss | Self::Noise | Self::Flicker)
    }

    /// Formats a value for readers.
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
