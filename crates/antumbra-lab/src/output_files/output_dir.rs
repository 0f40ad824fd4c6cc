//! Folder of results that appears completely, and replaces an earlier one only if that has no other files than ours.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::unfinished::{REGISTRY, UNFINISHED};
use super::{FileError, check_named, write_atomically};

/// Name of the hidden list of files that we wrote, in every output folder. Other files are the user's.
const MANIFEST_NAME: &str = ".antumbra-output.json";
const MANIFEST_FORMAT: &str = "antumbra-output";

#[derive(Serialize, Deserialize)]
struct Manifest {
    format: String,
    version: u32,
    /// Paths relative to the folder, with `/` as separator.
    files: BTreeSet<String>,
}

/// A folder in progress. Write into [`path`](OutputDir::path), then [`finish`](OutputDir::finish). If
/// dropped before that, it leaves nothing.
#[derive(Debug)]
pub struct OutputDir {
    /// Path as given by the user, for messages.
    named: PathBuf,
    target: PathBuf,
    unfinished: PathBuf,
    /// Whether the folder is at its target already, and grows there.
    is_placed: bool,
}

impl OutputDir {
    /// Begins a folder that will be at `path`. Its parent folders are created when it is finished.
    ///
    /// Fails immediately if it could not be placed: a file has that name, or the folder is not empty and not
    /// ours, or the user added files to ours.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        let fail = |error: io::Error| FileError::from_write(path, &error);
        check_named(path)?;
        let target = match path.canonicalize() {
            Ok(target) => target,
            Err(_) if path.as_os_str().is_empty() => PathBuf::new(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => std::path::absolute(path).map_err(fail)?,
            Err(error) => return Err(fail(error)),
        };
        let Some(name) = target.file_name() else {
            return Err(FileError::bad_path("write", path, "it does not name a folder", "name a folder to create"));
        };
        if std::env::current_dir().is_ok_and(|current| current.starts_with(&target)) {
            return Err(FileError::bad_path("write", path, "it is the current folder", "name a folder inside it"));
        }
        check_replaceable(path, &target)?;

        let above = target.ancestors().skip(1).find(|folder| folder.exists()).unwrap_or(Path::new("/"));
        let (unfinished, ()) =
            REGISTRY.begin(above, &name.to_string_lossy(), |path| fs::create_dir(path)).map_err(fail)?;
        Ok(Self { named: path.to_path_buf(), target, unfinished, is_placed: false })
    }

    /// Continues a folder that an earlier run left unfinished, or begins one if there is none. Removes files that the
    /// earlier run was writing when it was killed.
    ///
    /// # Errors
    /// As [`create`](OutputDir::create).
    pub fn resume(path: &Path) -> Result<Self, FileError> {
        let new = Self::create(path)?;
        if !new.target.join(MANIFEST_NAME).is_file() {
            return Ok(new);
        }
        for file in files_below(&new.target).map_err(|error| FileError::from_write(path, &error))? {
            if is_unfinished(&file) {
                fs::remove_file(new.target.join(file)).map_err(|error| FileError::from_write(path, &error))?;
            }
        }
        let (named, target) = (new.named.clone(), new.target.clone());
        Ok(Self { unfinished: target.clone(), named, target, is_placed: true })
    }

    /// Moves the folder into place before it is complete, so that results are kept if the run is interrupted. `expected` are relative
    /// paths of its future files, by which a later run recognises them.
    ///
    /// # Errors
    /// If the folder cannot be moved.
    pub fn place_now(&mut self, expected: impl IntoIterator<Item = String>) -> Result<(), FileError> {
        let fail = |error: io::Error| FileError::from_write(&self.named, &error);
        let there = files_below(self.path()).map_err(fail)?;
        self.write_manifest(there.into_iter().chain(expected).collect())?;
        if !self.is_placed {
            self.move_into_place()?;
            self.is_placed = true;
        }
        Ok(())
    }

    /// Returns the folder to fill: a temporary one until it is placed.
    pub fn path(&self) -> &Path {
        if self.is_placed { &self.target } else { &self.unfinished }
    }

    /// Moves the folder into place, replacing an earlier one of ours. Returns its final path.
    pub fn finish(self) -> Result<PathBuf, FileError> {
        let files = files_below(self.path()).map_err(|error| FileError::from_write(&self.named, &error))?;
        self.write_manifest(files)?;
        if !self.is_placed {
            self.move_into_place()?;
        }
        Ok(self.target.clone())
    }

    fn write_manifest(&self, files: BTreeSet<String>) -> Result<(), FileError> {
        let manifest = Manifest { format: MANIFEST_FORMAT.into(), version: 1, files };
        let manifest =
            serde_json::to_vec_pretty(&manifest).map_err(|error| FileError::from_write(&self.named, &error.into()))?;
        write_atomically(&self.path().join(MANIFEST_NAME), &manifest)
    }

    fn move_into_place(&self) -> Result<(), FileError> {
        // Checked again, because the user may have added files meanwhile.
        check_replaceable(&self.named, &self.target)?;
        REGISTRY.finish(&self.unfinished, || self.place()).map_err(|error| FileError::from_write(&self.named, &error))
    }

    /// Moves with two renames; if the second fails, the first is undone.
    fn place(&self) -> io::Result<()> {
        if let Some(above) = self.target.parent() {
            fs::create_dir_all(above)?;
        }
        if !self.target.exists() {
            return fs::rename(&self.unfinished, &self.target);
        }
        let replaced = self.unfinished.with_extension("replaced");
        fs::rename(&self.target, &replaced)?;
        if let Err(error) = fs::rename(&self.unfinished, &self.target) {
            fs::rename(&replaced, &self.target)?;
            return Err(error);
        }
        fs::remove_dir_all(&replaced)
    }
}

impl Drop for OutputDir {
    fn drop(&mut self) {
        if !self.is_placed {
            REGISTRY.discard(&self.unfinished);
        }
    }
}

/// Checks that a finished folder may replace `target`.
fn check_replaceable(named: &Path, target: &Path) -> Result<(), FileError> {
    let refuse = |why: String| {
        let remedy = "name a new or empty folder, or move its content away";
        Err(FileError::bad_path("replace", named, why, remedy))
    };
    let fail = |error: io::Error| FileError::from_write(named, &error);
    if !target.exists() {
        return Ok(());
    }
    if !target.is_dir() {
        return Err(FileError::bad_path("replace", named, "it is a file", "name a folder to create"));
    }
    let files = files_below(target).map_err(fail)?;
    let manifest = fs::read(target.join(MANIFEST_NAME))
        .ok()
        .and_then(|bytes| serde_json::from_slice::<Manifest>(&bytes).ok())
        .filter(|manifest| manifest.format == MANIFEST_FORMAT);
    match manifest {
        None if files.is_empty() => Ok(()),
        None => refuse("it is not empty, and was not written by this command".into()),
        Some(manifest) => {
            match files.difference(&manifest.files).find(|&file| file != MANIFEST_NAME && !is_unfinished(file)) {
                None => Ok(()),
                Some(foreign) => refuse(format!("it contains {foreign}, which this command did not write")),
            }
        }
    }
}

/// Returns whether a file is one of ours that a killed run left unfinished.
fn is_unfinished(file: &str) -> bool {
    let name = file.rsplit('/').next().unwrap_or(file);
    name.starts_with('.') && name.ends_with(UNFINISHED)
}

/// Returns all files below `folder` and its empty subfolders (names ending in `/`), as relative paths.
fn files_below(folder: &Path) -> io::Result<BTreeSet<String>> {
    let mut files = BTreeSet::new();
    let mut pending = vec![String::new()];
    while let Some(prefix) = pending.pop() {
        let mut is_empty = true;
        for entry in fs::read_dir(folder.join(&prefix))? {
            let entry = entry?;
            is_empty = false;
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            if entry.file_type()?.is_dir() {
                pending.push(name + "/");
            } else {
                files.insert(name);
            }
        }
        if is_empty && !prefix.is_empty() {
            files.insert(prefix);
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn make(path: &Path, name: &str) -> Result<PathBuf, FileError> {
        let out = OutputDir::create(path)?;
        fs::create_dir(out.path().join("images")).unwrap();
        fs::write(out.path().join("images").join(name), "x").unwrap();
        out.finish()
    }

    #[test]
    fn a_folder_appears_whole_and_replaces_its_forerunner() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("deep/er/report");
        let out = OutputDir::create(&target).unwrap();
        assert!(!root.path().join("deep").exists());
        drop(out);
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);

        make(&target, "one.png").unwrap();
        make(&target, "two.png").unwrap();
        assert!(!target.join("images/one.png").exists() && target.join("images/two.png").exists());
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
        assert_eq!(fs::read_dir(target.parent().unwrap()).unwrap().count(), 1);
    }

    /// A folder that grows in place is ours from its first file on, and may be resumed after a killed run.
    #[test]
    fn a_folder_grows_in_place_and_is_resumed() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("report");
        make(&target, "old.png").unwrap();
        let mut out = OutputDir::create(&target).unwrap();
        fs::write(out.path().join("first.json"), "1").unwrap();
        assert!(target.join("images/old.png").exists(), "nothing changes before it is placed");
        out.place_now(["second.json".to_owned()]).unwrap();
        assert!(out.path() == target && target.join("first.json").exists() && !target.join("images").exists());
        fs::write(out.path().join("second.json"), "2").unwrap();
        drop(out);
        fs::write(target.join(".second.json.1-0.unfinished"), "half").unwrap();
        let mut out = OutputDir::resume(&target).unwrap();
        assert_eq!(names(&target), [MANIFEST_NAME, "first.json", "second.json"]);
        out.place_now(["third.json".to_owned()]).unwrap();
        fs::write(out.path().join("third.json"), "3").unwrap();
        out.finish().unwrap();
        assert_eq!(names(root.path()), ["report"]);
        make(&target, "new.png").unwrap();
        assert!(!target.join("first.json").exists(), "the folder contained only files of this command");
        fs::write(target.join("images/mine.txt"), "mine").unwrap();
        assert!(OutputDir::resume(&target).unwrap_err().to_string().contains("which this command did not write"));
        let fresh = OutputDir::resume(&root.path().join("fresh")).unwrap();
        assert!(fresh.path() != root.path().join("fresh"));
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_is_not_ours_stays() {
        let root = tempfile::tempdir().unwrap();
        let foreign = root.path().join("foreign");
        fs::create_dir(&foreign).unwrap();
        make(&foreign, "into-an-empty-folder.png").unwrap();
        fs::write(foreign.join("images/notes.txt"), "mine").unwrap();
        let error = make(&foreign, "a.png").unwrap_err().to_string();
        assert!(
            error.contains("it contains images/notes.txt, which this command did not write; name a new"),
            "{error}"
        );

        let home = root.path().join("home");
        fs::create_dir_all(home.join("pictures")).unwrap();
        assert!(make(&home, "a.png").unwrap_err().to_string().contains("was not written by this command"));
        let file = root.path().join("file");
        fs::write(&file, "x").unwrap();
        assert!(make(&file, "a.png").unwrap_err().to_string().contains("it is a file"));
        assert!(make(&file.join("below"), "a.png").unwrap_err().is_bad_input);
        assert!(make(Path::new(""), "a.png").unwrap_err().to_string().contains("does not name a folder"));
        assert!(make(Path::new("/"), "a.png").unwrap_err().to_string().contains("does not name a folder"));
        assert!(make(Path::new("."), "a.png").unwrap_err().to_string().contains("current folder"));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 3, "no temporary folder stays");
    }
}
