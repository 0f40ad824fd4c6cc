//! Loading a scene by its name on a command line: a file or a built-in scene.

use std::path::Path;

use crate::builtin::BuiltinError;
use crate::gltf::{self, Animations, Limits, Loaded, Pose};
use crate::{Scene, SceneError, builtin};

/// Loading options.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// The time at which animations are sampled, seconds; times outside a clip clamp to its ends. Default 0.
    pub time_s: f32,
}

/// Loads `builtin:NAME`, `builtin:NAME?key=value`, or the path of a `.glb` or `.gltf` file.
///
/// Files are untrusted: only files in the same folder and below are read with one, and its size and fixed budgets bound
/// allocations. [`Scene::warnings`] lists what was left out or repaired.
///
/// # Errors
/// One line with file, place and remedy. A scene without triangles is an error.
pub fn load(spec: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    load_animated(spec, options).map(|(scene, _)| scene)
}

/// [`load`], with the animations that give the scene at other times; `None` if nothing is animated.
///
/// # Errors
/// As [`load`].
pub fn load_animated(spec: &str, options: &LoadOptions) -> Result<(Scene, Option<Animations>), SceneError> {
    let loaded = match builtin::spec_of(spec) {
        Some(name) => {
            let mut scene = builtin::build(name).map_err(|error| not_a_file(error, name))?;
            if options.time_s != 0.0 {
                let line =
                    format!("--time {}: built-in scenes are not animated, so the time is ignored", options.time_s);
                scene.warnings.push(line);
            }
            Loaded { scene, animations: None }
        }
        None => gltf::load_file(Path::new(spec), Pose::At(options.time_s), Limits::GENEROUS)
            .map_err(|error| not_a_built_in(error, spec))?,
    };
    not_empty(loaded, spec)
}

/// Loads a `.glb` or `.gltf` file from memory, with limits for bytes of unknown origin: about a million vertices and
/// 4096 texels per side. References to other files are refused.
///
/// # Errors
/// As [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    not_empty(gltf::load_bytes(bytes, name, Pose::At(options.time_s), Limits::TIGHT)?, name).map(|(scene, _)| scene)
}

/// Loads a `.glb` or `.gltf` file from memory that a user chose, as a page in a browser does. Limits: about eight million
/// vertices and 8192 texels per side. References to other files are refused. Returns the same as [`load_animated`].
///
/// # Errors
/// As [`load`].
pub fn load_chosen(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<(Scene, Option<Animations>), SceneError> {
    not_empty(gltf::load_bytes(bytes, name, Pose::At(options.time_s), Limits::SMALL)?, name)
}

/// Turns the error into [`SceneError::NotBuiltin`] if `name` is the path of a file.
fn not_a_file(error: BuiltinError, name: &str) -> SceneError {
    if Path::new(name).is_file() {
        return SceneError::NotBuiltin { path: name.into() };
    }
    error.into()
}

/// Turns the error into [`SceneError::NoSuchFile`] if no file has this name but a built-in scene does.
fn not_a_built_in(error: SceneError, spec: &str) -> SceneError {
    let name = spec.split('?').next().unwrap_or(spec);
    match error {
        SceneError::Read { source, .. }
            if source.kind() == std::io::ErrorKind::NotFound && builtin::named(name).is_some() =>
        {
            SceneError::NoSuchFile { spec: spec.to_owned() }
        }
        error => error,
    }
}

fn not_empty(loaded: Loaded, origin: &str) -> Result<(Scene, Option<Animations>), SceneError> {
    let Loaded { scene, animations } = loaded;
    if scene.triangle_count() > 0 {
        return Ok((scene, animations));
    }
    let left_out = scene.warnings.first().map_or_else(String::new, |w| format!(" ({w})"));
    Err(SceneError::Empty { origin: origin.to_owned(), left_out })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_of(spec: &str) -> String {
        load(spec, &LoadOptions::default()).unwrap_err().to_string()
    }

    #[test]
    fn files_and_built_ins_are_told_apart() {
        assert_eq!(error_of("overlap"), "overlap: there is no such file; the built-in scene is `builtin:overlap`");
        assert!(error_of("knot?triangles=2000").ends_with("`builtin:knot?triangles=2000`"));
        assert!(error_of("no-such.glb").contains("cannot be read"));
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("overlap.glb");
        std::fs::write(&file, "x").unwrap();
        let file = file.display();
        let error = error_of(&format!("builtin:{file}"));
        assert_eq!(
            error,
            format!(
                "builtin:{file}: this is a file, not a built-in scene; give its path without `builtin:`, as `{file}`"
            )
        );
        assert!(error_of("builtin:overlapp").contains("nearest: overlap"));
    }

    #[test]
    fn built_ins_are_found_in_any_case() {
        let of = |spec: &str| load(spec, &LoadOptions::default()).unwrap();
        assert_eq!(of("Builtin:OverLap").triangle_count(), of("builtin:overlap").triangle_count());
        let [knot, same] = ["builtin:knot?triangles=2000", "BUILTIN:Knot?Triangles=2000"].map(of);
        assert_eq!(knot.triangle_count(), same.triangle_count());
        assert!(load("builtin:knot?triangles=2000&TRIANGLES=2000", &LoadOptions::default()).is_err(), "once");
        assert_eq!(builtin::declared_name("BUILTIN:Knot?Triangles=2000"), "builtin:knot?Triangles=2000");
        assert_eq!(builtin::declared_name("Overlap.glb"), "Overlap.glb");
        assert_eq!(builtin::declared_name("Builtin:None"), "builtin:None");
        assert_eq!(builtin::spec_of("ein-längerer-name.glb"), None);
    }

    #[test]
    fn a_time_without_motion_is_said() {
        let still = load("builtin:overlap", &LoadOptions { time_s: 2.0 }).unwrap();
        assert_eq!(still.warnings, ["--time 2: built-in scenes are not animated, so the time is ignored"]);
        assert!(load("builtin:overlap", &LoadOptions::default()).unwrap().warnings.is_empty());
    }
}
