//! The system's dialog that chooses a file to open or a place to save to: the desktop's, or the browser's.
//!
//! It is open beside the window, which goes on, and one at a time. What is chosen comes by [`FileDialog::take`].

#[cfg(not(target_arch = "wasm32"))]
use std::path::Path;
use std::path::PathBuf;
#[cfg(not(target_arch = "wasm32"))]
use std::pin::Pin;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::aside::Wake;

/// What was chosen.
#[derive(Debug)]
pub struct Chosen {
    /// Its path; in a browser its name alone.
    pub path: PathBuf,
    /// What is in it: a browser gives no path to read it by.
    #[cfg(target_arch = "wasm32")]
    pub bytes: Vec<u8>,
}

/// What a file is chosen for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// A scene or a setup is opened.
    #[default]
    Open,
    /// Camera and lights are saved.
    #[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a browser has a place for downloads"))]
    SaveSetup,
    /// The picture is saved.
    #[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a browser has a place for downloads"))]
    SavePicture,
}

/// The dialog, open or not.
#[derive(Debug, Default)]
pub struct FileDialog {
    answer: Option<Receiver<Option<Chosen>>>,
    /// What for it was opened last.
    purpose: Purpose,
    /// As on a system that has none.
    is_absent: bool,
}

impl FileDialog {
    /// The dialog of a system that has none: nobody is there to close it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn absent() -> Self {
        Self { is_absent: true, ..Self::default() }
    }

    /// Opens it, where it is not open; `name` is that of the file to save. `wake` is called when something is chosen or nothing is. On
    /// the thread that draws, where macOS wants dialogs to be made.
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
            // Nobody waits any longer where the window has closed.
            let _ = sender.send(chosen);
            wake();
        };
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(move || pollster::block_on(answer));
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(answer);
    }

    /// Once it has closed, what was chosen in it and what for; `None` within where nothing was, or where the system has no dialog.
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

/// The dialog for a purpose.
#[cfg(not(target_arch = "wasm32"))]
fn asked(purpose: Purpose, name: &str) -> Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> {
    let dialog = rfd::AsyncFileDialog::new();
    // A path that was entered: its folder is where the dialog begins.
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
        // Opening it again opens no other.
        dialog.open(Purpose::SaveSetup, "setup.toml", Arc::new(|| ()));
        sender.send(Some(Chosen { path: "scene.glb".into() })).unwrap();
        let (purpose, chosen) = dialog.take().unwrap();
        assert_eq!((purpose, chosen.unwrap().path), (Purpose::Open, PathBuf::from("scene.glb")));
        assert!(dialog.take().is_none());
        // Where there is none, nothing is chosen.
        dialog.open(Purpose::SavePicture, "picture.png", Arc::new(|| ()));
        assert!(dialog.take().is_some_and(|(purpose, chosen)| purpose == Purpose::SavePicture && chosen.is_none()));
    }
}
