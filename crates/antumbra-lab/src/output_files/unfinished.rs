//! List of unfinished files and folders, for removal on interruption.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Removes every unfinished file and folder of this process, and rejects any further ones.
///
/// For a Ctrl-C handler that exits the process next: other threads may still be working, and their output must
/// neither reappear nor appear incomplete.
pub fn remove_unfinished() {
    REGISTRY.close();
}

/// Suffix of names of unfinished files.
pub(super) const UNFINISHED: &str = ".unfinished";

pub(super) static REGISTRY: Registry = Registry::new();

/// Temporary files and folders in progress. Its lock is held whenever one of them is created, renamed or removed, so after closing, each
/// target is either unchanged or complete.
pub(super) struct Registry(Mutex<Entries>);

struct Entries {
    is_closed: bool,
    paths: BTreeSet<PathBuf>,
}

impl Registry {
    pub(super) const fn new() -> Self {
        Self(Mutex::new(Entries { is_closed: false, paths: BTreeSet::new() }))
    }

    /// Creates an entry under a new hidden name in `folder`. `create` must not overwrite existing files.
    pub(super) fn begin<T>(
        &self,
        folder: &Path,
        target_name: &str,
        create: impl Fn(&Path) -> io::Result<T>,
    ) -> io::Result<(PathBuf, T)> {
        let mut entries = self.open()?;
        loop {
            static COUNTER: AtomicU64 = AtomicU64::new(0);
            let count = COUNTER.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!(".{target_name}.{}-{count}{UNFINISHED}", std::process::id()));
            match create(&path) {
                // An earlier process with the same id was killed and left this file.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                created => {
                    let created = created?;
                    entries.paths.insert(path.clone());
                    return Ok((path, created));
                }
            }
        }
    }

    /// Moves a finished entry into place with `place`. If that fails, the entry stays for its owner to discard.
    pub(super) fn finish(&self, path: &Path, place: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        let mut entries = self.open()?;
        place()?;
        entries.paths.remove(path);
        Ok(())
    }

    /// Removes an entry and its file or folder.
    pub(super) fn discard(&self, path: &Path) {
        let mut entries = self.lock();
        if entries.paths.remove(path) {
            remove(path);
        }
    }

    fn close(&self) {
        let mut entries = self.lock();
        entries.is_closed = true;
        for path in std::mem::take(&mut entries.paths) {
            remove(&path);
        }
    }

    fn open(&self) -> io::Result<MutexGuard<'_, Entries>> {
        let entries = self.lock();
        if entries.is_closed { Err(io::ErrorKind::Interrupted.into()) } else { Ok(entries) }
    }

    /// A panic elsewhere leaves the set usable, because every change to it is one step.
    fn lock(&self) -> MutexGuard<'_, Entries> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Best effort: errors cannot be reported any more.
fn remove(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_removes_files_and_folders_and_refuses_more() {
        let folder = tempfile::tempdir().unwrap();
        let registry = Registry::new();
        let (file, _) = registry.begin(folder.path(), "a.png", |path| fs::File::create_new(path)).unwrap();
        let (dir, ()) = registry.begin(folder.path(), "report", |path| fs::create_dir(path)).unwrap();
        fs::write(dir.join("index.html"), "half").unwrap();
        assert!(file.exists() && dir.exists());

        registry.close();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let refused = registry.begin(folder.path(), "b.png", |path| fs::File::create_new(path));
        assert_eq!(refused.unwrap_err().kind(), io::ErrorKind::Interrupted);
        let refused = registry.finish(&file, || panic!("must not be placed"));
        assert_eq!(refused.unwrap_err().kind(), io::ErrorKind::Interrupted);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn an_earlier_leftover_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let registry = Registry::new();
        let attempts = std::cell::Cell::new(0);
        let (path, ()) = registry
            .begin(folder.path(), "a", |path| {
                attempts.set(attempts.get() + 1);
                if attempts.get() == 1 { Err(io::ErrorKind::AlreadyExists.into()) } else { fs::create_dir(path) }
            })
            .unwrap();
        assert_eq!(attempts.get(), 2);
        registry.discard(&path);
        assert!(!path.exists());
    }
}
