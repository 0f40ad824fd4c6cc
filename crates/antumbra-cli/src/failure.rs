//! Failures of a command: a message in one line, and an exit code.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use antumbra_lab::device::DeviceError;
use antumbra_lab::error::LabError;
use antumbra_lab::output_files::FileError;
use antumbra_reference::ReferenceError;
use antumbra_scene::SceneError;

/// Failure of a command. The variants are the exit codes that the documentation promises.
#[derive(Debug)]
pub enum Failure {
    /// Invalid arguments or input file: exit code 2.
    Input(String),
    /// No usable adapter, or a missing feature: exit code 3.
    Device(String),
    /// The deadline ended the run; results so far are written: exit code 4.
    Incomplete(String),
    /// Any other failure: exit code 1.
    Other(String),
}

impl Failure {
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Input(_) => 2,
            Self::Device(_) => 3,
            Self::Incomplete(_) => 4,
            Self::Other(_) => 1,
        })
    }
}

impl fmt::Display for Failure {
    /// Formats the message as one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Input(message) | Self::Device(message) | Self::Incomplete(message) | Self::Other(message)) = self;
        f.write_str(&message.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

/// Location of the results of a run that ended early.
#[derive(Debug)]
pub enum SavedResults<'a> {
    /// No results were written.
    Nothing,
    /// A file that cannot be resumed.
    NotResumable(&'a Path),
    /// A file or folder that `--resume` continues.
    Resumable(&'a Path),
}

impl fmt::Display for SavedResults<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("nothing was written"),
            Self::NotResumable(path) => write!(f, "results so far are in {}", path.display()),
            Self::Resumable(path) => {
                write!(f, "results so far are in {}; run the same command with --resume to continue", path.display())
            }
        }
    }
}

impl Failure {
    /// Failure of a run that its deadline ended: names what is missing, out of how many, and where the results are.
    pub fn incomplete<T: AsRef<str>>(missing: &[T], of: usize, kept: &SavedResults<'_>) -> Self {
        const NAMED: usize = 8;
        let mut names: Vec<&str> = missing.iter().take(NAMED).map(AsRef::as_ref).collect();
        let more = format!("and {} more", missing.len().saturating_sub(NAMED));
        if missing.len() > NAMED {
            names.push(&more);
        }
        Self::Incomplete(format!(
            "the deadline ended the run before {} of {of}: {}; {kept}",
            missing.len(),
            names.join("; ")
        ))
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
            error @ (LabError::NoRoom { .. } | LabError::CutShort { .. }) => Self::Other(error.to_string()),
            LabError::Metrics(error) => Self::Other(error.to_string()),
        }
    }
}
