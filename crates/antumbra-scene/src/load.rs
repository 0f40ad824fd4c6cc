//! One way in: a scene by its name on a command line, a file or a built-in.

use std::path::Path;

use crate::builtin::BuiltinError;
use crate::gltf::{self, Animations, Limits, Loaded, Pose};
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
    load_animated(spec, options).map(|(scene, _)| scene)
}

/// [`load`], and what it takes to have the scene at other times: `None` where nothing of it is animated.
///
/// # Errors
/// As [`load`].
pub fn load_animated(spec: &str, options: &LoadOptions) -> Result<(Scene, Option<Animations>), SceneError> {
    let loaded = match builtin::spec_of(spec) {
        Some(name) => {
            let mut scene = builtin::build(name).map_err(|error| not_a_file(error, name))?;
            if options.time_s != 0.0 {
                let line =
                    format!("--time {}: built-in scenes stand still, and the time changes nothing", options.time_s);
                scene.warnings.push(line);
            }
            Loaded { scene, animations: None }
        }
        None => gltf::load_file(Path::new(spec), Pose::At(options.time_s), Limits::GENEROUS)
            .map_err(|error| not_a_built_in(error, spec))?,
    };
    not_empty(loaded, spec)
}

/// Loads a `.glb` or `.gltf` file from memory, under limits fit for bytes of unknown origin: about a million vertices
/// and 4096 texels a side. Files beside it are refused.
///
/// # Errors
/// As [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    not_empty(gltf::load_bytes(bytes, name, Pose::At(options.time_s), Limits::TIGHT)?, name).map(|(scene, _)| scene)
}

/// Loads a `.glb` or `.gltf` file that a user chose and that has been read already, as a page in a browser does: about
/// eight million vertices and 8192 texels a side. Files beside it are refused. Gives what [`load_animated`] does.
///
/// # Errors
/// As [`load`].
pub fn load_chosen(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<(Scene, Option<Animations>), SceneError> {
    not_empty(gltf::load_bytes(bytes, name, Pose::At(options.time_s), Limits::SMALL)?, name)
}

/// A file that is there was meant where `builtin:` stands before its path.
fn not_a_file(error: BuiltinError, name: &str) -> SceneError {
    if Path::new(name).is_file() {
        return SceneError::NotBuiltin { path: name.into() };
    }
    error.into()
}

/// A built-in was meant where its bare name is given and no file is called so.
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
            format!("builtin:{file}: this is a file, and no built-in scene; give its path alone, `{file}`")
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
        assert_eq!(still.warnings, ["--time 2: built-in scenes stand still, and the time changes nothing"]);
        assert!(load("builtin:overlap", &LoadOptions::default()).unwrap().warnings.is_empty());
    }
}
