//! One way in: a scene by its name on a command line, a file or a built-in.

use crate::{Scene, SceneError};

/// What the caller may choose about loading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// The time at which animations are sampled, seconds; times outside a clip clamp to its ends. Default 0.
    pub time_s: f32,
}

/// Loads `builtin:NAME`, `builtin:NAME?key=value`, or the path of a `.glb` or `.gltf` file.
///
/// # Errors
/// One line that says which file, where in it, and what would be right. A scene without a triangle is an error.
pub fn load(spec: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let _ = options;
    Err(SceneError::Empty { origin: spec.to_owned(), left_out: String::new() })
}
