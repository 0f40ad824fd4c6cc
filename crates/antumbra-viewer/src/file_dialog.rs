//! The system's dialog that chooses a file: the desktop's, or the browser's.
//!
//! It is open beside the window, which goes on, and one at a time. What is chosen comes by [`FileDialog::take`].

use std::path::PathBuf;
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

/// The dialog, open or not.
#[derive(Debug, Default)]
pub struct FileDialog {
    answer: Option<Receiver<Option<Chosen>>>,
    /// As on a system that has none.
    is_absent: bool,
}

impl FileDialog {
    /// The dialog of a system that has none: nobody is there to close it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn absent() -> Self {
        Self { answer: None, is_absent: true }
    }

    /// Opens it, where it is not open; `wake` is called when something is chosen or nothing is. On the thread that draws,
    /// where macOS wants dialogs to be made.
    pub fn open(&mut self, wake: Wake) {
        if self.answer.is_some() {
            return;
        }
        let (sender, answer) = channel();
        self.answer = Some(answer);
        if self.is_absent {
            return;
        }
        let dialog = rfd::AsyncFileDialog::new().add_filter("scenes and setups", &["glb", "gltf", "toml"]).pick_file();
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

    /// Once it has closed, what was chosen in it; `None` within where nothing was, or where the system has no dialog.
    pub fn take(&mut self) -> Option<Option<Chosen>> {
        let answer = match self.answer.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
            Ok(answer) => answer,
        };
        self.answer = None;
        Some(answer)
    }
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
        let mut dialog = FileDialog { answer: Some(answer), is_absent: true };
        assert!(dialog.take().is_none(), "it is still open");
        // Opening it again opens no other.
        dialog.open(Arc::new(|| ()));
        sender.send(Some(Chosen { path: "scene.glb".into() })).unwrap();
        assert_eq!(dialog.take().flatten().unwrap().path, PathBuf::from("scene.glb"));
        assert!(dialog.take().is_none());
        // Where there is none, nothing is chosen.
        dialog.open(Arc::new(|| ()));
        assert!(dialog.take().is_some_and(|chosen| chosen.is_none()));
    }
}
