//! How a command fails: one line, and the exit code that goes with it.

use std::fmt;
use std::process::ExitCode;

use antumbra_lab::device::DeviceError;
use antumbra_lab::error::LabError;
use antumbra_lab::output_files::FileError;
use antumbra_reference::ReferenceError;
use antumbra_scene::SceneError;

/// Why a command failed. The variants are the exit codes of the command line's contract.
#[derive(Debug)]
pub enum Failure {
    /// The arguments or an input file are wrong: 2.
    Input(String),
    /// No usable adapter, or a feature is missing: 3.
    Device(String),
    /// Anything else: 1.
    Other(String),
}

impl Failure {
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Input(_) => 2,
            Self::Device(_) => 3,
            Self::Other(_) => 1,
        })
    }
}

impl fmt::Display for Failure {
    /// One line, whatever the message was made of.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Input(message) | Self::Device(message) | Self::Other(message)) = self;
        f.write_str(&message.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

impl From<antumbra::Error> for Failure {
    fn from(error: antumbra::Error) -> Self {
        match error {
            antumbra::Error::Unsupported { .. } => Self::Device(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}

impl From<DeviceError> for Failure {
    fn from(error: DeviceError) -> Self {
        match error {
            DeviceError::NoSuchAdapter { .. } | DeviceError::NoAdapter | DeviceError::Unusable { .. } => {
                Self::Device(error.to_string())
            }
            DeviceError::Failed { .. } | DeviceError::Lost { .. } => Self::Other(error.to_string()),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<ReferenceError> for Failure {
    fn from(error: ReferenceError) -> Self {
        match error {
            ReferenceError::Cancelled => Self::Other(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        if error.is_bad_input { Self::Input(error.to_string()) } else { Self::Other(error.to_string()) }
    }
}

impl From<LabError> for Failure {
    fn from(error: LabError) -> Self {
        match error {
            LabError::Scene(error) => error.into(),
            LabError::Device(error) => error.into(),
            LabError::Technique(error) => error.into(),
            LabError::Reference(error) => error.into(),
            LabError::File(error) => error.into(),
            LabError::Request(message) => Self::Input(message),
            error @ LabError::NoRoom { .. } => Self::Other(error.to_string()),
            LabError::Metrics(error) => Self::Other(error.to_string()),
        }
    }
}
