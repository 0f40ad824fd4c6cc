//! A setup: where to look from and what the lights are, as TOML (FORMATS, "Setup file").

use std::path::Path;

use antumbra_light::Light;

use crate::{Camera, Scene, SceneError};

/// Where to look from and what the lights are.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Where to look from.
    pub camera: Camera,
    /// At least one light.
    pub lights: Vec<Light>,
}

impl Setup {
    /// Reads a setup from TOML; `origin` names the text in messages and is the file beside which textures lie.
    ///
    /// # Errors
    /// One line: file, line, key, and what would be right.
    pub fn from_toml(text: &str, origin: &Path) -> Result<Self, SceneError> {
        let _ = text;
        Err(SceneError::Setup {
            origin: origin.display().to_string(),
            line: 1,
            problem: String::new(),
            remedy: String::new(),
        })
    }

    /// Reads a setup file.
    ///
    /// # Errors
    /// As [`Self::from_toml`], or the file cannot be read.
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| SceneError::ReadSetup { path: path.to_owned(), source })?;
        Self::from_toml(&text, path)
    }

    /// The setup as TOML from which [`Self::from_toml`] makes the same setup.
    pub fn to_toml(&self) -> String {
        String::new()
    }

    /// The setup that a scene implies: its first camera and its lights, or a camera that frames its bounds and one
    /// rectangle key light.
    pub fn for_scene(scene: &Scene) -> Self {
        let camera = scene.cameras.first().copied().expect("stub");
        Self { camera, lights: scene.lights.clone() }
    }
}
