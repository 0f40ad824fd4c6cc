//! Errors of scenes and setup files, each one line: place, problem, remedy.

use std::path::PathBuf;

use antumbra_light::LightError;

use crate::builtin::BuiltinError;

/// Error of loading or exporting a scene, or of reading a setup file. Each displays as one line.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file cannot be read at all.
    #[error("{}: cannot be read: {source}; give the path of a .glb or .gltf scene, or `builtin:NAME`", path.display())]
    Read {
        /// Name or path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The name of a built-in scene without `builtin:`, where no file has that name.
    #[error("{spec}: there is no such file; the built-in scene is `builtin:{spec}`")]
    NoSuchFile {
        /// Name as given.
        spec: String,
    },
    /// A file's path after `builtin:`.
    #[error("builtin:{0}: this is a file, not a built-in scene; give its path without `builtin:`, as `{0}`", path.display())]
    NotBuiltin {
        /// The file.
        path: PathBuf,
    },
    /// A scene file contradicts the glTF 2.0 specification, or exceeds a limit of this loader.
    #[error("{origin}: {place}: {problem}; {remedy}")]
    Invalid {
        /// Name or path of the file.
        origin: String,
        /// Place in the file, as a path such as `accessors[3].count`.
        place: String,
        /// Problem found.
        problem: String,
        /// Suggested correction.
        remedy: String,
    },
    /// A scene without a triangle: there is nothing to cast or to receive a shadow.
    #[error(
        "{origin}: the scene has no triangle{left_out}; it needs at least one mesh of triangles in a node of its scene"
    )]
    Empty {
        /// Name of the file or built-in scene.
        origin: String,
        /// First loader warning, in parentheses; empty if there is none.
        left_out: String,
    },
    /// `builtin:NAME` names no built-in scene, or gives it a parameter that it does not take.
    #[error(transparent)]
    Builtin(#[from] BuiltinError),
    /// A setup file cannot be read at all.
    #[error("{}: cannot be read: {source}; give the path of a setup file in TOML", path.display())]
    ReadSetup {
        /// Name or path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A setup file has an invalid key, type or value.
    #[error("{origin}:{line}: {problem}; {remedy}")]
    Setup {
        /// Name or path of the file.
        origin: String,
        /// Line of the file, from 1.
        line: usize,
        /// Problem found, with the key.
        problem: String,
        /// Suggested correction.
        remedy: String,
    },
    /// A light of a setup has an invalid value.
    #[error("{origin}:{line}: {source}")]
    Light {
        /// Name or path of the file.
        origin: String,
        /// Line of the file on which the light begins, from 1.
        line: usize,
        /// Problem and remedy.
        source: LightError,
    },
    /// A scene cannot be written as glTF.
    #[error("cannot export scene `{scene}`: {problem}")]
    Export {
        /// The scene's name.
        scene: String,
        /// Problem and remedy.
        problem: String,
    },
}
