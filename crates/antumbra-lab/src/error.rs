//! Errors of the laboratory, from scene to report.

use antumbra_reference::ReferenceError;
use antumbra_scene::SceneError;

use crate::cut_short::CutShort;
use crate::device::DeviceError;
use crate::metrics::MetricsError;
use crate::output_files::FileError;

/// Reason why an image, comparison or time could not be produced.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// A scene or a setup file is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The graphics device is missing or failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A technique cannot run, or a parameter is wrong.
    #[error(transparent)]
    Technique(#[from] antumbra::Error),
    /// The truth cannot be traced.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// Images cannot be compared.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    /// A file cannot be written or read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A technique ran out of space for its lists, however far they were enlarged.
    #[error(
        "{technique}: {overflow}, even after the frame was drawn several times; reduce the size of the map or the image"
    )]
    NoRoom {
        /// Technique that failed.
        technique: antumbra::TechniqueKind,
        /// Lists that overflowed.
        overflow: antumbra::Overflow,
    },
    /// A time limit passed before the first valid frame.
    #[error("{technique}: {cut}")]
    CutShort {
        /// Technique that was measured.
        technique: antumbra::TechniqueKind,
        /// Limit, duration and number of frames.
        cut: CutShort,
    },
    /// The request is invalid; the message names the argument and the alternatives.
    #[error("{0}")]
    Request(String),
}

impl LabError {
    /// Returns whether the run's deadline passed before there was a result.
    pub fn is_deadline(&self) -> bool {
        matches!(
            self,
            Self::CutShort { cut: CutShort { limit: None, .. }, .. } | Self::Reference(ReferenceError::Cancelled)
        )
    }

    /// Returns the reason of a skipped measurement after which others continue: the device lacks a feature, lists overflow, or the
    /// technique exceeds its time limit.
    pub fn why_skipped(&self) -> Option<String> {
        match self {
            Self::Technique(antumbra::Error::Unsupported { .. }) | Self::NoRoom { .. } | Self::CutShort { .. } => {
                Some(self.to_string())
            }
            _ => None,
        }
    }

    /// Returns the limit that cut a measurement short, seconds; `None` for other errors.
    pub fn limit_s(&self) -> Option<f64> {
        match self {
            Self::CutShort { cut: CutShort { limit, .. }, .. } => limit.map(|limit| limit.as_secs_f64()),
            _ => None,
        }
    }
}
