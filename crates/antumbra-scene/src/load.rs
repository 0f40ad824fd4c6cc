//! One way in: a scene by its name on a command line, a file or a built-in.

use std::path::Path;

use crate::gltf::{self, Limits, Pose};
use crate::{Scene, SceneError, builtin};

/// What the caller may choose about loading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// The time at which animations are sampled, seconds; times outside a clip clamp to its ends. Default 0.
    pub time_s: f32,
}

/// Loads `builtin:NAME`, `builtin:NAME?key=value`, or the path of a `.glb` or `.gltf` file.
///
/// A file is not trusted: only files in its own folder and below are read with it, and its size bounds what is
/// allocated for it. What had to be left out or repaired is in [`Scene::warnings`].
///
/// # Errors
/// One line that says which file, where in it, and what would be right. A scene without a triangle is an error.
pub fn load(spec: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let scene = match spec.strip_prefix("builtin:") {
        Some(name) => builtin::build(name)?,
        None => gltf::load_file(Path::new(spec), Pose::At(options.time_s), Limits::GENEROUS)?,
    };
    not_empty(scene, spec)
}

/// Loads a `.glb` or `.gltf` file from memory, under limits fit for bytes of unknown origin: about a million vertices
/// and 4096 texels a side. Files beside it are refused.
///
/// # Errors
/// As [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    not_empty(gltf::load_bytes(bytes, name, Pose::At(options.time_s), Limits::TIGHT)?, name)
}

/// Loads a `.glb` or `.gltf` file that a user chose and that has been read already, as a page in a browser does: about
/// eight million vertices and 8192 texels a side. Files beside it are refused.
///
/// # Errors
/// As [`load`].
pub fn load_chosen(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    not_empty(gltf::load_bytes(bytes, name, Pose::At(options.time_s), Limits::SMALL)?, name)
}

fn not_empty(scene: Scene, origin: &str) -> Result<Scene, SceneError> {
    if scene.triangle_count() > 0 {
        return Ok(scene);
    }
    let left_out = scene.warnings.first().map_or_else(String::new, |w| format!(" ({w})"));
    Err(SceneError::Empty { origin: origin.to_owned(), left_out })
}
