//! Scenes and setups from files, on a thread, so that the window goes on while a large one loads.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;

use antumbra_scene::{LoadOptions, Scene, Setup, load};

use crate::renderer::Wake;

/// A scene that was loaded.
#[derive(Debug)]
pub struct Loaded {
    /// As it was named.
    pub spec: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The setup file given with it.
    pub setup: Option<(PathBuf, Setup)>,
}

/// Loads one scene at a time; the newest request counts.
#[derive(Debug, Default)]
pub struct Loader {
    pending: Option<(String, Receiver<Result<Loaded, String>>)>,
}

impl Loader {
    /// Loads a scene by its name, and a setup file.
    pub fn load(&mut self, spec: String, setup: Option<PathBuf>, wake: Wake) {
        let (sender, result) = channel();
        self.pending = Some((spec.clone(), result));
        thread::spawn(move || {
            // Nobody waits any longer where another scene was asked for meanwhile.
            let _ = sender.send(load_now(spec, setup));
            wake();
        });
    }

    /// What is being loaded.
    pub fn pending(&self) -> Option<&str> {
        self.pending.as_ref().map(|(spec, _)| spec.as_str())
    }

    /// The outcome, once it is there: a scene, or one line.
    pub fn take(&mut self) -> Option<Result<Loaded, String>> {
        let outcome = self.pending.as_ref()?.1.try_recv().ok()?;
        self.pending = None;
        Some(outcome)
    }
}

fn load_now(spec: String, setup: Option<PathBuf>) -> Result<Loaded, String> {
    // The setup first: it is quickly read, and a large scene is not.
    let setup = match setup {
        Some(path) => Some((path.clone(), read_setup(&path)?)),
        None => None,
    };
    let scene = load(&spec, &LoadOptions::default()).map_err(|error| one_line(&error.to_string()))?;
    Ok(Loaded { spec, scene: Arc::new(scene), setup })
}

/// Reads a setup file.
///
/// # Errors
/// One line.
pub fn read_setup(path: &Path) -> Result<Setup, String> {
    Setup::from_file(path).map_err(|error| one_line(&error.to_string()))
}

/// Writes a setup file, whole or not at all.
///
/// # Errors
/// One line.
pub fn write_setup(path: &Path, setup: &Setup) -> Result<(), String> {
    write_whole(path, setup.to_toml().as_bytes())
}

/// Writes a file under another name, then gives it its own.
///
/// # Errors
/// One line.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    written.map_err(|error| {
        // Where even this fails there is nothing to remove.
        let _ = std::fs::remove_file(&part);
        format!("{}: cannot be written: {error}; choose a folder that can be written to", path.display())
    })
}

/// A message without line breaks.
pub fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;

    use super::*;
    use crate::state::State;

    #[test]
    fn a_setup_comes_back_as_it_was() {
        let Loaded { spec, scene, .. } = load_now("builtin:knot".into(), None).unwrap();
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.open(&spec, &scene, None);
        state.add_light();
        let path = std::env::temp_dir().join(format!("antumbra-viewer-{}.toml", std::process::id()));
        write_setup(&path, &state.setup).unwrap();
        let read = read_setup(&path);
        std::fs::remove_file(&path).unwrap();
        assert_eq!(read.unwrap(), state.setup);
        assert!(
            write_setup(Path::new("/no/such/folder/setup.toml"), &state.setup)
                .unwrap_err()
                .contains("cannot be written")
        );
    }

    #[test]
    fn what_does_not_load_says_why_in_one_line() {
        for spec in ["builtin:nothing", "no-such-file.glb"] {
            let why = load_now(spec.into(), None).unwrap_err();
            assert!(!why.contains('\n') && why.len() > spec.len(), "{why}");
        }
    }
}
