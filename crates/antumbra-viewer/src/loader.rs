//! Background loading of scenes and setups by name, from files, and from files dropped on a page. The window stays responsive.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use antumbra_scene::{Animations, Framing, Ground, LoadOptions, Scene, Setup, load_animated};
use glam::Vec3;

use crate::background::{Wake, run_in_background};
use crate::message::one_line;

/// A loaded scene with its setup.
#[derive(Debug)]
pub struct Loaded {
    /// The name by which it was requested.
    pub spec: String,
    /// The scene, relative to the anchor.
    pub scene: Arc<Scene>,
    /// World position near the camera that serves as origin, because floats are coarse far from the world's origin.
    pub anchor: Vec3,
    /// Camera and lights that the scene implied before it was put on a ground, relative to the anchor.
    pub assumed: Setup,
    /// Framing for a camera that shows the whole scene, in world space; `None` if the scene or a setup file has a camera.
    pub framing: Option<Framing>,
    /// The requested setup file, relative to the anchor.
    pub setup: Option<(PathBuf, Setup)>,
    /// Animations for posing the scene at other times; `None` if nothing is animated.
    pub animations: Option<Arc<Animations>>,
    /// Time of the scene's pose, seconds.
    pub time_s: f32,
    /// Whether a ground was added below the scene.
    pub has_ground: bool,
    /// Warnings about omissions and assumptions, one per line.
    pub notes: Vec<String>,
}

/// A request for a scene.
#[derive(Clone, Debug, Default)]
pub struct SceneRequest {
    /// The scene's name.
    pub spec: String,
    /// A setup file.
    pub setup: Option<PathBuf>,
    /// Time of the scene's pose, seconds.
    pub time_s: f32,
    /// Whether a ground is added.
    pub ground: Ground,
}

impl SceneRequest {
    /// Request for a scene with default options.
    pub fn plain(spec: impl Into<String>) -> Self {
        Self { spec: spec.into(), ..Self::default() }
    }
}

/// An opened file.
#[derive(Debug)]
pub enum Opened {
    /// A scene.
    Scene(Box<Loaded>),
    /// Camera and lights, with the path of their file.
    Setup(PathBuf, Setup),
}

type Outcome = Result<Opened, String>;

/// Background loader of one file at a time; the newest request replaces the one before.
#[derive(Debug, Default)]
pub struct Loader {
    pending: Option<(String, Receiver<Outcome>)>,
}

impl Loader {
    /// Loads a scene.
    pub fn load(&mut self, wanted: SceneRequest, wake: Wake) {
        let sender = self.expect(&wanted.spec);
        run_in_background(move || {
            // The receiver is gone if another scene was requested meanwhile.
            let _ = sender.send(load_now(wanted).map(|loaded| Opened::Scene(Box::new(loaded))));
            wake();
        });
    }

    /// Loads a file dropped on the page: a `.glb`, or a setup's `.toml`. The file stays on this machine.
    #[cfg(target_arch = "wasm32")]
    pub fn load_dropped(&mut self, file: egui::DroppedFileHandle, wake: Wake) {
        let name = file.path().display().to_string();
        let sender = self.expect(&name);
        wasm_bindgen_futures::spawn_local(async move {
            let bytes = file.bytes_async().await;
            let opened = bytes.map_err(|why| format!("{name}: cannot be read: {}", one_line(&why)));
            let _ = sender.send(opened.and_then(|bytes| open_bytes(name, &bytes)));
            wake();
        });
    }

    /// Loads a file chosen on the page, as [`load_dropped`](Self::load_dropped) does.
    #[cfg(target_arch = "wasm32")]
    pub fn load_bytes(&mut self, name: String, bytes: Vec<u8>, wake: Wake) {
        let sender = self.expect(&name);
        run_in_background(move || {
            // The receiver is gone if another scene was requested meanwhile.
            let _ = sender.send(open_bytes(name, &bytes));
            wake();
        });
    }

    fn expect(&mut self, name: &str) -> Sender<Outcome> {
        let (sender, result) = channel();
        self.pending = Some((name.to_owned(), result));
        sender
    }

    /// Name of the file that is being loaded.
    pub fn pending(&self) -> Option<&str> {
        self.pending.as_ref().map(|(spec, _)| spec.as_str())
    }

    /// Returns the outcome once loading has finished: the opened file, or an error in one line.
    pub fn take(&mut self) -> Option<Outcome> {
        let outcome = self.pending.as_ref()?.1.try_recv().ok()?;
        self.pending = None;
        Some(outcome)
    }
}

fn load_now(wanted: SceneRequest) -> Result<Loaded, String> {
    // The setup comes first: reading it is fast, so its errors appear early.
    let setup = match &wanted.setup {
        Some(path) => Some((path.clone(), read_setup(path)?)),
        None => None,
    };
    let options = LoadOptions { time_s: wanted.time_s };
    let loaded = load_animated(&wanted.spec, &options).map_err(|error| one_line(&error.to_string()))?;
    Ok(finished(wanted, setup, loaded))
}

/// Adds a ground if one is wanted, as the laboratory does, and moves the scene to its anchor.
fn finished(
    wanted: SceneRequest,
    setup: Option<(PathBuf, Setup)>,
    (mut scene, animations): (Scene, Option<Animations>),
) -> Loaded {
    let mut notes = scene.warnings.clone();
    notes.extend(scene.unit_warning());
    // The assumed setup is that of the scene without the ground.
    let assumed = Setup::assumed(&scene);
    let has_ground = wanted.ground.is_for(&scene, setup.is_none() && assumed.framing.is_some());
    if has_ground && wanted.ground == Ground::Auto {
        notes.push(Ground::told(&scene));
    }
    if has_ground {
        scene.add_ground();
    }
    let anchor = setup.as_ref().map_or(&assumed.setup, |(_, setup)| setup).camera.anchor();
    scene.count_from(anchor);
    Loaded {
        spec: antumbra_scene::builtin::declared_name(&wanted.spec),
        scene: Arc::new(scene),
        anchor,
        assumed: assumed.setup.relative_to(anchor),
        framing: assumed.framing.filter(|_| setup.is_none()),
        setup: setup.map(|(path, setup)| (path, setup.relative_to(anchor))),
        animations: animations.map(Arc::new),
        time_s: wanted.time_s,
        has_ground,
        notes,
    }
}

/// Parses a file's bytes by the extension of its name.
#[cfg(any(test, target_arch = "wasm32"))]
fn open_bytes(name: String, bytes: &[u8]) -> Outcome {
    let why = |error: antumbra_scene::SceneError| one_line(&error.to_string());
    if is_setup(&name) {
        let text =
            std::str::from_utf8(bytes).map_err(|_| format!("{name}: is not UTF-8 text; a setup is a TOML file"))?;
        let setup = Setup::from_toml(text, Path::new(&name)).map_err(why)?;
        return Ok(Opened::Setup(name.into(), setup));
    }
    let loaded = antumbra_scene::load_chosen(bytes, &name, &LoadOptions::default()).map_err(why)?;
    Ok(Opened::Scene(Box::new(finished(SceneRequest::plain(name), None, loaded))))
}

/// Whether a file name is that of a setup.
pub fn is_setup(name: &str) -> bool {
    name.to_lowercase().ends_with(".toml")
}

/// Reads a setup file.
///
/// # Errors
/// Fails with one line.
pub fn read_setup(path: &Path) -> Result<Setup, String> {
    Setup::from_file(path).map_err(|error| one_line(&error.to_string()))
}

/// Writes a setup file atomically.
///
/// # Errors
/// Fails with one line.
pub fn write_setup(path: &Path, setup: &Setup) -> Result<(), String> {
    write_whole(path, setup.to_toml().as_bytes())
}

/// Writes a file atomically: under a temporary name that is then renamed.
///
/// # Errors
/// Fails with one line.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    written.map_err(|error| {
        // If this fails, too, there is nothing to remove.
        let _ = std::fs::remove_file(&part);
        format!("{}: cannot be written: {error}; choose a writable folder", path.display())
    })
}

/// Gives a file to the browser as a download.
///
/// # Errors
/// Fails with one line.
#[cfg(target_arch = "wasm32")]
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    crate::download::download(path, bytes)
        .ok_or_else(|| format!("{}: the browser refused the download", path.display()))
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use antumbra_scene::load;

    use super::*;
    use crate::state::State;

    #[test]
    fn a_setup_comes_back_as_it_was() {
        let Loaded { spec, scene, .. } = load_now(SceneRequest::plain("builtin:knot")).unwrap();
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.open(&spec, &scene, None);
        state.add_light();
        let path = std::env::temp_dir().join(format!("antumbra-viewer-{}.toml", std::process::id()));
        write_setup(&path, &state.setup).unwrap();
        let read = read_setup(&path);
        std::fs::remove_file(&path).unwrap();
        assert_eq!(read.unwrap(), state.setup);
        assert!(
            write_setup(Path::new("/no/such/folder/setup.toml"), &state.setup)
                .unwrap_err()
                .contains("cannot be written")
        );
    }

    #[test]
    fn bytes_are_what_their_name_says() {
        let scene = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let glb = antumbra_scene::export_glb(&scene).unwrap();
        let Ok(Opened::Scene(opened)) = open_bytes("dropped.glb".into(), &glb) else { panic!("no scene") };
        assert_eq!(opened.scene.triangle_count(), scene.triangle_count());
        let toml = Setup::for_scene(&scene).to_toml();
        let opened = open_bytes("Evening.TOML".into(), toml.as_bytes());
        assert!(matches!(opened, Ok(Opened::Setup(_, setup)) if setup == Setup::for_scene(&scene)));
        for (name, bytes) in [("dropped.glb", &glb[..20]), ("evening.toml", b"camera = 1"), ("evening.toml", b"\xff")] {
            let why = open_bytes(name.into(), bytes).unwrap_err();
            assert!(why.starts_with(name) && !why.contains('\n'), "{why}");
        }
    }

    #[test]
    fn opened_far_scenes_are_relative_to_their_camera() {
        const AWAY: Vec3 = Vec3::new(10_000.0, 0.0, -7_300.0);
        let near = load("builtin:overlap", &LoadOptions::default()).unwrap();
        let mut far = near.clone();
        far.count_from(-AWAY);
        let glb = antumbra_scene::export_glb(&far).unwrap();
        let Ok(Opened::Scene(opened)) = open_bytes("far.glb".into(), &glb) else { panic!("no scene") };
        assert!(opened.anchor.distance(AWAY) < 100.0, "{}", opened.anchor);
        let back = opened.scene.bounds().center() + (opened.anchor - AWAY);
        assert!(back.abs_diff_eq(near.bounds().center(), 0.01), "{back}");
        let mut state = State::new(TechniqueKind::Pcss, TechniqueKind::Hard);
        state.open("far.glb", &opened.scene, Some(opened.assumed));
        state.anchor = opened.anchor;
        assert!(state.setup.camera.eye.length() < 100.0);
        let in_world = Setup::assumed(&far).setup;
        assert!(state.setup_in_world().camera.eye.abs_diff_eq(in_world.camera.eye, 0.01));
        assert!(state.setup_in_world().lights[0].center.abs_diff_eq(in_world.lights[0].center, 0.01));
    }

    #[test]
    fn what_does_not_load_says_why_in_one_line() {
        for spec in ["builtin:nothing", "no-such-file.glb"] {
            let why = load_now(SceneRequest::plain(spec)).unwrap_err();
            assert!(!why.contains('\n') && why.len() > spec.len(), "{why}");
        }
    }
}
