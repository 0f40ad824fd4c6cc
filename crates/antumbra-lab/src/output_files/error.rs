//! Errors of files in one line: path, reason, and remedy.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Failure to write or read a file or folder.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {why}; {remedy}", path.display())]
pub struct FileError {
    /// Attempted action: `write`, `read`, `replace`.
    pub action: &'static str,
    /// Path as given by the user.
    pub path: PathBuf,
    /// Reason of the failure.
    pub why: String,
    /// Suggested remedy.
    pub remedy: String,
    /// Whether arguments or an input file are at fault (a read-only folder, no image in the file), not the machine's state (a full disk,
    /// an interruption). The command line then exits with code 2 instead of 1.
    pub is_bad_input: bool,
}

impl FileError {
    /// Creates the error of an unusable output path.
    pub(crate) fn bad_path(action: &'static str, path: &Path, why: impl Into<String>, remedy: &str) -> Self {
        Self { action, path: path.to_path_buf(), why: why.into(), remedy: remedy.into(), is_bad_input: true }
    }

    /// Creates the error of an input file with wrong content.
    pub(crate) fn bad_content(path: &Path, why: impl Into<String>, remedy: &str) -> Self {
        Self::bad_path("read", path, why, remedy)
    }

    /// Converts an I/O error that occurred while `path` was written.
    pub fn from_write(path: &Path, error: &io::Error) -> Self {
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.display().to_string(),
            _ => "the current folder".into(),
        };
        let (why, remedy, is_bad_input) = match error.kind() {
            // Virtual folders such as /proc return this error.
            ErrorKind::NotFound if path.parent().is_some_and(Path::is_dir) => {
                (format!("{folder} is not writable"), "choose a writable folder", true)
            }
            ErrorKind::NotFound => {
                (format!("the folder {folder} does not exist"), "create it, or choose another folder", true)
            }
            ErrorKind::PermissionDenied => {
                (format!("no permission to write in {folder}"), "choose a writable folder", true)
            }
            ErrorKind::ReadOnlyFilesystem => {
                (format!("{folder} is on a read-only file system"), "choose a writable folder", true)
            }
            ErrorKind::NotADirectory => (format!("{folder} is not a folder"), "name a file inside a folder", true),
            ErrorKind::IsADirectory => ("it is a folder".into(), "name a file", true),
            ErrorKind::InvalidFilename => {
                ("the file system does not accept the name".into(), "use a shorter, plainer name", true)
            }
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                ("the disk is full".into(), "free some space, or choose another disk", false)
            }
            ErrorKind::FileTooLarge => {
                ("the file system does not support files of this size".into(), "choose another disk", false)
            }
            ErrorKind::Interrupted => ("interrupted".into(), "try again", false),
            _ => (one_line(&error.to_string()), "check the disk and the folder", false),
        };
        Self { action: "write", path: path.to_path_buf(), why, remedy: remedy.into(), is_bad_input }
    }

    /// Converts an I/O error that occurred while `path` was opened or read.
    pub(crate) fn from_read(path: &Path, error: &io::Error) -> Self {
        let (why, remedy) = match error.kind() {
            ErrorKind::NotFound => ("there is no such file".into(), "check the path"),
            ErrorKind::PermissionDenied => ("no permission to read it".into(), "change its permissions"),
            ErrorKind::IsADirectory => ("it is a folder".into(), "name a file"),
            _ => (one_line(&error.to_string()), "check the file"),
        };
        Self::bad_path("read", path, why, remedy)
    }
}

/// Returns another library's message as one line.
pub(crate) fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_says_which_why_and_what_would_be_right() {
        let of = |kind| FileError::from_write(Path::new("/there/a.png"), &io::Error::from(kind));
        assert_eq!(
            of(ErrorKind::ReadOnlyFilesystem).to_string(),
            "cannot write /there/a.png: /there is on a read-only file system; choose a writable folder"
        );
        assert_eq!(
            of(ErrorKind::StorageFull).to_string(),
            "cannot write /there/a.png: the disk is full; free some space, or choose another disk"
        );
        assert!(of(ErrorKind::PermissionDenied).is_bad_input && !of(ErrorKind::StorageFull).is_bad_input);
        let many = io::Error::other("two\n  lines");
        assert!(!FileError::from_write(Path::new("a.png"), &many).to_string().contains('\n'));
    }
}
