//! The file dialog of the desktop or the browser, for opening and saving.
//!
//! The dialog does not block the window, and only one is open at a time. [`FileDialog::take`] returns the chosen file.

#[cfg(not(target_arch = "wasm32"))]
use std::path::Path;
use std::path::PathBuf;
#[cfg(not(target_arch = "wasm32"))]
use std::pin::Pin;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::background::Wake;

/// A file chosen in the dialog.
#[derive(Debug)]
pub struct Chosen {
    /// The file's path; in a browser only its name.
    pub path: PathBuf,
    /// The file's content, because a browser gives no path to read.
    #[cfg(target_arch = "wasm32")]
    pub bytes: Vec<u8>,
}

/// Purpose of the dialog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// Open a scene or a setup.
    #[default]
    Open,
    /// Save camera and lights.
    #[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a browser saves files as downloads"))]
    SaveSetup,
    /// Save the image.
    #[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a browser saves files as downloads"))]
    SavePicture,
}

/// The dialog, open or closed.
#[derive(Debug, Default)]
pub struct FileDialog {
    answer: Option<Receiver<Option<Chosen>>>,
    /// Purpose with which the dialog was opened last.
    purpose: Purpose,
    /// Whether the system has no dialog.
    is_absent: bool,
}

impl FileDialog {
    /// A dialog that behaves as on a system without one, for tests, where nobody could close it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn absent() -> Self {
        Self { is_absent: true, ..Self::default() }
    }

    /// Opens the dialog unless it is open; `name` is the file to save. Calls `wake` when the dialog closes. Call this on
    /// the thread that draws: macOS requires it.
    pub fn open(&mut self, purpose: Purpose, name: &str, wake: Wake) {
        if self.answer.is_some() {
            return;
        }
        let (sender, answer) = channel();
        (self.answer, self.purpose) = (Some(answer), purpose);
        if self.is_absent {
            return;
        }
        let dialog = asked(purpose, name);
        let answer = async move {
            let chosen = match dialog.await {
                Some(file) => read(file).await,
                None => None,
            };
            // The receiver is gone if the window has closed.
            let _ = sender.send(chosen);
            wake();
        };
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(move || pollster::block_on(answer));
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(answer);
    }

    /// Returns the purpose and the chosen file once the dialog has closed. The inner `None` means that nothing was chosen
    /// or that the system has no dialog.
    pub fn take(&mut self) -> Option<(Purpose, Option<Chosen>)> {
        let answer = match self.answer.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
            Ok(answer) => answer,
        };
        self.answer = None;
        Some((self.purpose, answer))
    }
}

/// Opens the system's dialog for a purpose.
#[cfg(not(target_arch = "wasm32"))]
fn asked(purpose: Purpose, name: &str) -> Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> {
    let dialog = rfd::AsyncFileDialog::new();
    // The dialog starts in the folder of the entered path.
    let path = Path::new(name);
    let dialog = match path.parent().filter(|folder| folder.is_dir()) {
        Some(folder) => dialog.set_directory(folder),
        None => dialog,
    };
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    match purpose {
        Purpose::Open => Box::pin(dialog.add_filter("scenes and setups", &["glb", "gltf", "toml"]).pick_file()),
        Purpose::SaveSetup => Box::pin(dialog.add_filter("setups", &["toml"]).set_file_name(file).save_file()),
        Purpose::SavePicture => Box::pin(dialog.add_filter("pictures", &["png"]).set_file_name(file).save_file()),
    }
}

#[cfg(target_arch = "wasm32")]
fn asked(_purpose: Purpose, _name: &str) -> impl Future<Output = Option<rfd::FileHandle>> + use<> {
    rfd::AsyncFileDialog::new().add_filter("scenes and setups", &["glb", "gltf", "toml"]).pick_file()
}

#[cfg(not(target_arch = "wasm32"))]
async fn read(file: rfd::FileHandle) -> Option<Chosen> {
    Some(Chosen { path: file.path().to_owned() })
}

#[cfg(target_arch = "wasm32")]
async fn read(file: rfd::FileHandle) -> Option<Chosen> {
    Some(Chosen { path: file.file_name().into(), bytes: file.read().await })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn an_answer_is_taken_once() {
        let (sender, answer) = channel();
        let mut dialog = FileDialog { answer: Some(answer), is_absent: true, purpose: Purpose::Open };
        assert!(dialog.take().is_none(), "it is still open");
        // A second dialog does not open.
        dialog.open(Purpose::SaveSetup, "setup.toml", Arc::new(|| ()));
        sender.send(Some(Chosen { path: "scene.glb".into() })).unwrap();
        let (purpose, chosen) = dialog.take().unwrap();
        assert_eq!((purpose, chosen.unwrap().path), (Purpose::Open, PathBuf::from("scene.glb")));
        assert!(dialog.take().is_none());
        // Without a dialog nothing is chosen.
        dialog.open(Purpose::SavePicture, "picture.png", Arc::new(|| ()));
        assert!(dialog.take().is_some_and(|(purpose, chosen)| purpose == Purpose::SavePicture && chosen.is_none()));
    }
}
