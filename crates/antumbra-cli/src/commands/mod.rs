//! The commands, one file each, and their shared helpers.

mod advise;
mod bench;
mod compare;
mod completions;
mod doctor;
mod man;
mod reference;
mod render;
mod reproduce;
mod scenes;
mod sweep;
mod techniques;
mod view;

pub use advise::advise;
pub use bench::bench;
pub use compare::compare;
pub use completions::completions;
pub use doctor::doctor;
pub use man::man;
pub use reference::reference;
pub use render::render;
pub use reproduce::reproduce;
pub use scenes::scenes;
pub use sweep::sweep;
pub use techniques::techniques;
pub use view::view;

use std::path::{Path, PathBuf};

use antumbra::{Gpu, Quality, TechniqueKind};
use antumbra_lab::device::{DeviceOptions, LabDevice};
use antumbra_lab::error::LabError;
use antumbra_lab::image_io::write_visibility_exr;
use antumbra_lab::output_files::{check_named, write_atomically};
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Progress;
use antumbra_lab::technique_run::TechniqueChoice;
use antumbra_light::Light;
use antumbra_scene::{Camera, LoadOptions, Scene, Setup, ShadowDistance, load};

use glam::{UVec2, Vec3};
use serde_json::Value;

use crate::args::{AdapterArgs, Ground, SceneArgs, ViewArgs};
use crate::failure::Failure;
use crate::suggest::did_you_mean;
use crate::values::{Setting, Technique};

/// Returns the device options of the command line.
fn device_options(args: &AdapterArgs) -> DeviceOptions {
    DeviceOptions { adapter: args.adapter.clone(), wanted_features: Gpu::WANTED_FEATURES }
}

fn open_device(args: &AdapterArgs) -> Result<LabDevice, Failure> {
    Ok(LabDevice::new(&device_options(args))?)
}

/// A scene with camera and lights, relative to `anchor`, so that rounding ten kilometres from the world's origin is the
/// same as at the origin.
struct LoadedScene {
    scene: Scene,
    setup: Setup,
    /// Anchor in world space.
    anchor: Vec3,
    /// Whether a ground was added below the scene.
    has_ground: bool,
}

/// Loads the scene and its setup. Reports the loader's omissions and assumptions as notes. `aspect` is the width over
/// height of the images that an assumed camera must frame.
fn load_scene(spec: &str, args: &SceneArgs, aspect: f32, progress: &dyn Progress) -> Result<LoadedScene, Failure> {
    // The setup comes first: reading it is fast, so its errors appear early.
    let setup = args.setup.as_deref().map(Setup::from_file).transpose()?;
    progress.begin(&format!("loading {spec}"), 0);
    let mut scene = load(spec, &LoadOptions { time_s: args.time })?;
    progress.end();
    for warning in &scene.warnings {
        progress.note(warning);
    }
    scene.unit_warning().iter().for_each(|warning| progress.note(warning));
    let mut is_framed = false;
    let setup = setup.unwrap_or_else(|| {
        let assumed = Setup::assumed_for(&scene, aspect);
        assumed.line.iter().for_each(|line| progress.note(line));
        is_framed = assumed.framing.is_some();
        assumed.setup
    });
    let has_ground = args.ground.when().is_for(&scene, is_framed);
    // The ground comes after the camera, which frames the scene without it.
    if has_ground {
        scene.add_ground();
    }
    if has_ground && args.ground == Ground::Auto {
        progress.note(&antumbra_scene::Ground::told(&scene));
    }
    let anchor = setup.camera.anchor();
    scene.count_from(anchor);
    Ok(LoadedScene { scene, setup: setup.relative_to(anchor), anchor, has_ground })
}

/// Width over height of the narrowest image; 16 : 9 for an empty list.
fn narrowest(sizes_px: &[UVec2]) -> f32 {
    let aspects = sizes_px.iter().map(|size_px| size_px.x as f32 / size_px.y as f32);
    aspects.min_by(f32::total_cmp).unwrap_or(16.0 / 9.0)
}

/// Sets a camera's shadow distance if one is given.
fn end_shadows(camera: &mut Camera, distance_m: Option<f32>) {
    if let Some(end_m) = distance_m {
        camera.shadow_distance = Some(ShadowDistance::new(end_m));
    }
}

/// Refuses a folder that is not empty and lacks `own`, the file that marks an earlier run. `of` names the missing content in the message.
fn check_folder(dir: &Path, own: &str, of: &str) -> Result<(), Failure> {
    check_named(dir)?;
    if dir.exists() && !dir.is_dir() {
        return Err(not_written(dir, "it is a file"));
    }
    let mut entries = std::fs::read_dir(dir).into_iter().flatten();
    if entries.next().is_some() && !dir.join(own).is_file() {
        return Err(not_written(dir, &format!("it is not empty and contains {of}")));
    }
    Ok(())
}

/// Creates a folder that passed [`check_folder`], unless it exists.
fn make_folder(dir: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(dir).map_err(|error| not_written(dir, &error.to_string()))
}

fn not_written(dir: &Path, why: &str) -> Failure {
    Failure::Input(format!("cannot write {}: {why}; name another folder", dir.display()))
}

/// Returns the arguments that define the view, as they were given.
fn scene_arguments(spec: &str, view: &ViewArgs) -> String {
    let mut words = vec![spec.to_owned()];
    if let Some(setup) = &view.scene.setup {
        words.extend(["--setup".to_owned(), setup.display().to_string()]);
    }
    if view.scene.time != 0.0 {
        words.extend(["--time".to_owned(), view.scene.time.to_string()]);
    }
    match view.scene.ground {
        Ground::Auto => {}
        Ground::Yes => words.push("--ground".to_owned()),
        Ground::No => words.push("--ground=no".to_owned()),
    }
    words.extend(["--size".to_owned(), format!("{}x{}", view.size.x, view.size.y)]);
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// Returns the current command line, quoted for a shell.
fn command_line() -> String {
    // A path need not be Unicode, so it is converted with losses.
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("antumbra".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// Quotes a word for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Returns the index of the light called `name`; 0 without a name.
fn light_index(lights: &[Light], name: Option<&str>) -> Result<usize, Failure> {
    let Some(name) = name else { return Ok(0) };
    // An exact match comes first, because names may differ in case alone.
    let is_alike = |light: &Light| light.name.to_lowercase() == name.to_lowercase();
    let found = lights.iter().position(|light| light.name == name).or_else(|| lights.iter().position(is_alike));
    found.ok_or_else(|| {
        let known = || lights.iter().map(|light| light.name.as_str());
        let list = known().collect::<Vec<_>>().join(", ");
        Failure::Input(format!("--light: there is no light `{name}`{}; available: {list}", did_you_mean(name, known())))
    })
}

/// Writes the visibility of the chosen light to `path`. Without a choice writes all lights: the first to `path`, the others
/// beside it (`v.exr`, `v.fill.exr`).
fn write_visibilities(
    path: &Path,
    lights: &[Light],
    visibilities: &[&Visibility],
    chosen: Option<usize>,
    progress: &dyn Progress,
) -> Result<(), Failure> {
    if let Some(chosen) = chosen {
        return Ok(write_visibility_exr(path, visibilities[chosen])?);
    }
    let mut taken = vec![path.to_path_buf()];
    write_visibility_exr(path, visibilities[0])?;
    for (light, visibility) in lights.iter().zip(visibilities).skip(1) {
        let path = beside(path, &light.name, &taken);
        write_visibility_exr(&path, visibility)?;
        progress.note(&format!("wrote the visibility of light `{}` to {}", light.name, path.display()));
        taken.push(path);
    }
    Ok(())
}

/// Returns the path of a file beside another, with `name` inserted; numbered if that path is taken.
fn beside(path: &Path, name: &str, taken: &[PathBuf]) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '-' };
    let name: String = name.chars().map(plain).collect();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
    let named = |number: String| path.with_file_name(format!("{stem}.{name}{number}{ending}"));
    let numbered = (2..).map(|n| named(format!("-{n}")));
    std::iter::once(named(String::new()))
        .chain(numbered)
        .find(|path| !taken.contains(path))
        .expect("there is always another number")
}

/// Assigns the settings to the techniques to which they apply. Each must apply to at least one.
fn choices(techniques: &[Technique], settings: &[Setting]) -> Result<Vec<TechniqueChoice>, Failure> {
    let of = |named: &Technique| TechniqueChoice {
        settings: named.settings.clone(),
        ..TechniqueChoice::of_quality(named.kind, named.quality).with_extras(named.extras)
    };
    let mut choices: Vec<_> = techniques.iter().map(of).collect();
    for setting in settings {
        let Setting { technique, key, value } = setting;
        let mut used = false;
        for choice in &mut choices {
            let is_meant = technique.is_none_or(|(kind, quality)| {
                kind == choice.kind && quality.is_none_or(|quality| quality == choice.quality)
            });
            if is_meant && has_parameter(choice.kind, key) {
                choice.settings.push(read_setting(choice.kind, key, value)?);
                used = true;
            }
        }
        if !used {
            return Err(Failure::Input(why_unused(techniques, setting)));
        }
    }
    Ok(choices)
}

/// Explains why a setting applies to no chosen technique.
fn why_unused(techniques: &[Technique], setting: &Setting) -> String {
    let key = &setting.key;
    let is = |technique: &Technique, (kind, quality): (TechniqueKind, Option<Quality>)| {
        technique.kind == kind && quality.is_none_or(|quality| quality == technique.quality)
    };
    if let Some((kind, quality)) = setting.technique.filter(|meant| !techniques.iter().any(|one| is(one, *meant))) {
        let name = |kind, quality| TechniqueChoice::of_quality(kind, quality).name();
        let chosen: Vec<_> = techniques.iter().map(|one| name(one.kind, one.quality)).collect();
        let meant = name(kind, quality.unwrap_or_default());
        return format!("--set {meant}.{key}: {meant} is not among the chosen techniques ({})", chosen.join(", "));
    }
    let mut meant: Vec<_> = (techniques.iter())
        .filter(|one| setting.technique.is_none_or(|meant| is(one, meant)))
        .map(|one| one.kind)
        .collect();
    meant.dedup();
    let mut keys: Vec<&str> = meant.iter().flat_map(|kind| kind.param_specs()).map(|spec| spec.key).collect();
    keys.sort_unstable();
    keys.dedup();
    let names: Vec<_> = meant.iter().map(|kind| kind.name()).collect();
    let hint = did_you_mean(key, keys.iter().copied());
    let verb = if names.len() == 1 { "has" } else { "have" };
    format!("--set: {} {verb} no parameter `{key}`{hint}; available: {}", names.join(", "), keys.join(", "))
}

/// Whether a technique has a parameter of that name, ignoring case.
fn has_parameter(kind: TechniqueKind, key: &str) -> bool {
    kind.param_specs().iter().any(|spec| spec.key.eq_ignore_ascii_case(key))
}

/// Validates a parameter's value, and returns key and value as declared.
fn read_setting(kind: TechniqueKind, key: &str, value: &str) -> Result<(String, String), Failure> {
    let (spec, value) = kind.read(key, value).map_err(|error| Failure::Input(format!("--set: {error}")))?;
    Ok((spec.key.to_owned(), value.to_string()))
}

/// Commit from which this program was built.
const COMMIT: &str = env!("ANTUMBRA_COMMIT");

/// Writes indented JSON atomically.
fn write_json(path: &Path, value: &Value) -> Result<(), Failure> {
    Ok(put_json(path, value)?)
}

/// Writes indented JSON atomically; fails with the laboratory's error type.
fn put_json(path: &Path, value: &Value) -> Result<(), LabError> {
    Ok(write_atomically(path, format!("{value:#}\n").as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_in_any_case() {
        let (extras, settings) = (antumbra_lab::technique_run::Extras::default(), Vec::new());
        let pcss = Technique { kind: TechniqueKind::Pcss, quality: Quality::Balanced, extras, settings };
        let given = [("MAP_SIZE", "512"), ("Means", "RANGES"), ("rotate", "False")];
        let given = given.map(|(key, value)| Setting { technique: None, key: key.into(), value: value.into() });
        let read = choices(&[pcss], &given).unwrap().remove(0).settings;
        let wanted = [("map_size", "512"), ("means", "ranges"), ("rotate", "false")];
        assert_eq!(read, wanted.map(|(key, value)| (key.to_owned(), value.to_owned())));
    }

    #[test]
    fn lights_are_found_in_any_case() {
        let lamp = Light::new(antumbra_light::LightShape::Sphere { radius_m: 0.1 }, Vec3::Y, Vec3::ZERO);
        let lights = ["key", "Fill", "fill"].map(|name| Light { name: name.into(), ..lamp.clone() });
        let of = |name| light_index(&lights, Some(name)).unwrap();
        assert_eq!((of("KEY"), of("fill"), of("Fill"), of("FILL")), (0, 2, 1, 1));
        assert!(light_index(&lights, Some("rim")).is_err());
    }

    #[test]
    fn lights_of_one_name_get_files_of_their_own() {
        let first = PathBuf::from("dir/v.exr");
        let second = beside(&first, "spot 1/2", std::slice::from_ref(&first));
        assert_eq!(second, Path::new("dir/v.spot-1-2.exr"));
        assert_eq!(beside(&first, "spot 1/2", &[first.clone(), second]), Path::new("dir/v.spot-1-2-2.exr"));
    }
}
