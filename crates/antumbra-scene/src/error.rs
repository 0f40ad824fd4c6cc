//! What can be wrong with a scene or a setup file, as one line: where, what, and what would be right.

use std::path::PathBuf;

use antumbra_light::LightError;

use crate::builtin::BuiltinError;

/// Why a scene or a setup could not be had. Each displays as one line.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file cannot be read at all.
    #[error("{}: cannot be read: {source}; give the path of a .glb or .gltf scene, or `builtin:NAME`", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A built-in's name without `builtin:`, where no file is called so.
    #[error("{spec}: there is no such file; the built-in scene is `builtin:{spec}`")]
    NoSuchFile {
        /// What was given.
        spec: String,
    },
    /// A file's path behind `builtin:`.
    #[error("builtin:{0}: this is a file, and no built-in scene; give its path alone, `{0}`", path.display())]
    NotBuiltin {
        /// The file.
        path: PathBuf,
    },
    /// A scene file contradicts the glTF 2.0 specification, or exceeds a limit of this loader.
    #[error("{origin}: {place}: {problem}; {remedy}")]
    Invalid {
        /// Which file.
        origin: String,
        /// Where in it, as a path such as `accessors[3].count`.
        place: String,
        /// What is wrong.
        problem: String,
        /// What would be right.
        remedy: String,
    },
    /// A scene without a triangle: there is nothing to cast or to receive a shadow.
    #[error(
        "{origin}: the scene holds no triangle{left_out}; it needs at least one mesh of triangles in a node of its scene"
    )]
    Empty {
        /// Which file or built-in.
        origin: String,
        /// Why, in parentheses, where the loader left something out; else empty.
        left_out: String,
    },
    /// `builtin:NAME` names no built-in scene, or gives it a parameter that it does not take.
    #[error(transparent)]
    Builtin(#[from] BuiltinError),
    /// A setup file cannot be read at all.
    #[error("{}: cannot be read: {source}; give the path of a setup file in TOML", path.display())]
    ReadSetup {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A setup file has a key, a type or a value that is not right.
    #[error("{origin}:{line}: {problem}; {remedy}")]
    Setup {
        /// Which file.
        origin: String,
        /// Line of the file, from 1.
        line: usize,
        /// What is wrong, with the key.
        problem: String,
        /// What would be right.
        remedy: String,
    },
    /// A light of a setup has a number that means nothing.
    #[error("{origin}:{line}: {source}")]
    Light {
        /// Which file.
        origin: String,
        /// Line of the file on which the light begins, from 1.
        line: usize,
        /// What is wrong and what would be right.
        source: LightError,
    },
    /// A scene cannot be written as glTF.
    #[error("cannot export scene `{scene}`: {problem}")]
    Export {
        /// The scene's name.
        scene: String,
        /// What is wrong and what would be right.
        problem: String,
    },
}
