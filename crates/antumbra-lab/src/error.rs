//! Errors between a scene and its report.

use antumbra_reference::ReferenceError;
use antumbra_scene::SceneError;

use crate::cut_short::CutShort;
use crate::device::DeviceError;
use crate::metrics::MetricsError;
use crate::output_files::FileError;

/// Why there is no picture, no comparison, no time.
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
    /// A technique found no room for its lists however much it made.
    #[error("{technique}: {overflow}, however often the frame was drawn again; lower the map's or the image's size")]
    NoRoom {
        /// Which technique.
        technique: antumbra::TechniqueKind,
        /// Of what there was too much.
        overflow: antumbra::Overflow,
    },
    /// A limit of time came before a frame that counts.
    #[error("{technique}: {cut}")]
    CutShort {
        /// Which technique.
        technique: antumbra::TechniqueKind,
        /// By which limit, after how much.
        cut: CutShort,
    },
    /// What was asked for does not exist: which, and what there is.
    #[error("{0}")]
    Request(String),
}

impl LabError {
    /// Whether the run's deadline came before there was a result.
    pub fn is_deadline(&self) -> bool {
        matches!(
            self,
            Self::CutShort { cut: CutShort { limit: None, .. }, .. } | Self::Reference(ReferenceError::Cancelled)
        )
    }

    /// The reason of a measurement that gave nothing, where the others go on: the device lacks something, there is no room, or the
    /// technique exceeds its limit.
    pub fn why_skipped(&self) -> Option<String> {
        match self {
            Self::Technique(antumbra::Error::Unsupported { .. }) | Self::NoRoom { .. } | Self::CutShort { .. } => {
                Some(self.to_string())
            }
            _ => None,
        }
    }

    /// The limit that cut a measurement short, seconds; `None` for other errors.
    pub fn limit_s(&self) -> Option<f64> {
        match self {
            Self::CutShort { cut: CutShort { limit, .. }, .. } => limit.map(|limit| limit.as_secs_f64()),
            _ => None,
        }
    }
}
