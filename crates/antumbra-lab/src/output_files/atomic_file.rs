//! File that is written under a temporary name and renamed when it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::FileError;
use super::unfinished::REGISTRY;

/// A file in progress. [`finish`](AtomicFile::finish) moves it into place, over an earlier file of that name.
/// If dropped before, it leaves nothing.
#[derive(Debug)]
pub struct AtomicFile {
    /// Path as given by the user, for messages.
    named: PathBuf,
    target: PathBuf,
    unfinished: PathBuf,
    writer: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Begins a file that will be at `path`. Fails immediately if it could not be placed: no such folder,
    /// read-only, a folder or device of that name.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        let target = resolve_target(path)?;
        let (Some(folder), Some(name)) = (target.parent(), target.file_name()) else {
            return Err(FileError::bad_path("write", path, "it does not name a file", "end the path with a file name"));
        };
        let (unfinished, file) = REGISTRY
            .begin(folder, &name.to_string_lossy(), |path| File::create_new(path))
            .map_err(|error| FileError::from_write(path, &error))?;
        Ok(Self { named: path.to_path_buf(), target, unfinished, writer: Some(BufWriter::new(file)) })
    }

    /// Returns the writer of the content.
    pub fn writer(&mut self) -> &mut BufWriter<File> {
        self.writer.as_mut().expect("the writer exists until `finish` takes it")
    }

    /// Moves the complete file into place.
    pub fn finish(mut self) -> Result<(), FileError> {
        let writer = self.writer.take().expect("finish runs once");
        let place = || -> io::Result<()> {
            let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
            // Without this, a power failure could leave the name without the content.
            file.sync_all()?;
            drop(file);
            REGISTRY.finish(&self.unfinished, || fs::rename(&self.unfinished, &self.target))
        };
        place().map_err(|error| FileError::from_write(&self.named, &error))
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        self.writer = None;
        REGISTRY.discard(&self.unfinished);
    }
}

/// Writes `content` to `path`, completely or not at all.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    file.writer().write_all(content).map_err(|error| FileError::from_write(path, &error))?;
    file.finish()
}

/// Checks that a file can be written at `path`, before long work. Leaves no file.
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    AtomicFile::create(path).map(drop)
}

/// Resolves a symbolic link, which a rename would replace, and rejects anything but regular files.
fn resolve_target(path: &Path) -> Result<PathBuf, FileError> {
    let fail = |error| FileError::from_write(path, &error);
    match fs::metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(path.to_path_buf()),
        Err(error) => Err(fail(error)),
        Ok(metadata) if metadata.is_file() => path.canonicalize().map_err(fail),
        Ok(metadata) => {
            let what = if metadata.is_dir() { "it is a folder" } else { "it is not a regular file" };
            Err(FileError::bad_path("write", path, what, "name a file"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, b"first").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.writer().write_all(b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"first", "nothing changes before finish");
        file.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names_in(folder.path()), ["a.txt"]);
    }

    #[test]
    fn an_abandoned_file_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let mut file = AtomicFile::create(&path).unwrap();
        file.writer().write_all(b"half").unwrap();
        drop(file);
        check_writable(&path).unwrap();
        assert!(names_in(folder.path()).is_empty());
    }

    #[test]
    fn what_cannot_be_written_is_said_in_one_line() {
        let folder = tempfile::tempdir().unwrap();
        let text = |path: &Path| write_atomically(path, b"x").unwrap_err().to_string();
        assert!(text(&folder.path().join("no/such/a.png")).contains("does not exist; create it"));
        assert!(text(folder.path()).ends_with("it is a folder; name a file"));
        let file = folder.path().join("file");
        write_atomically(&file, b"x").unwrap();
        assert!(text(&file.join("a.png")).contains("is not a folder"));
        assert!(text(&folder.path().join("n".repeat(300))).contains("does not accept the name"));
        assert!(text(Path::new("")).contains("cannot write"));
        assert_eq!(names_in(folder.path()), ["file"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        write_atomically(&real, b"old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert!(check_writable(Path::new("/dev/null")).unwrap_err().to_string().contains("not a regular file"));
    }
}
