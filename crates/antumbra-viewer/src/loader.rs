//! Scenes and setups by name, from files and from files dropped on a page, aside, so that the window goes on while a large
//! one loads.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use antumbra_scene::{Animations, Framing, Ground, LoadOptions, Scene, Setup, load_animated};
use glam::Vec3;

use crate::aside::{Wake, aside};
use crate::message::one_line;

/// A scene that was loaded.
#[derive(Debug)]
pub struct Loaded {
    /// As it was named.
    pub spec: String,
    /// The scene, counted from the anchor.
    pub scene: Arc<Scene>,
    /// The world position near its camera that it is counted from: far from the world's origin floats are coarse.
    pub anchor: Vec3,
    /// Camera and lights for it, counted from the anchor; those that it implied before it was put on a ground.
    pub assumed: Setup,
    /// What makes a camera that the scene fills a picture of, counted from the world's origin; `None` where it brought its own, or
    /// a setup did.
    pub framing: Option<Framing>,
    /// The setup file given with it, counted from the anchor.
    pub setup: Option<(PathBuf, Setup)>,
    /// What it takes to have it at other times; `None` where nothing of it is animated.
    pub animations: Option<Arc<Animations>>,
    /// The time that it is shown at, seconds.
    pub time_s: f32,
    /// It stands on a ground that was put there.
    pub has_ground: bool,
    /// What was left out or assumed, in lines.
    pub notes: Vec<String>,
}

/// A scene as it is asked for.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// By its name.
    pub spec: String,
    /// A setup file.
    pub setup: Option<PathBuf>,
    /// The time at which it is shown, seconds.
    pub time_s: f32,
    /// Whether it is put on a ground.
    pub ground: Ground,
}

impl Wanted {
    /// As it comes.
    pub fn plain(spec: impl Into<String>) -> Self {
        Self { spec: spec.into(), ..Self::default() }
    }
}

/// What was opened.
#[derive(Debug)]
pub enum Opened {
    /// A scene.
    Scene(Box<Loaded>),
    /// Camera and lights, by the name of their file.
    Setup(PathBuf, Setup),
}

type Outcome = Result<Opened, String>;

/// Loads one thing at a time; the newest request counts.
#[derive(Debug, Default)]
pub struct Loader {
    pending: Option<(String, Receiver<Outcome>)>,
}

impl Loader {
    /// Loads a scene.
    pub fn load(&mut self, wanted: Wanted, wake: Wake) {
        let sender = self.expect(&wanted.spec);
        aside(move || {
            // Nobody waits any longer where another scene was asked for meanwhile.
            let _ = sender.send(load_now(wanted).map(|loaded| Opened::Scene(Box::new(loaded))));
            wake();
        });
    }

    /// Loads what was dropped on the page: a `.glb`, or a setup's `.toml`. It stays on this machine.
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

    /// Loads what was chosen on the page, as what is dropped there.
    #[cfg(target_arch = "wasm32")]
    pub fn load_bytes(&mut self, name: String, bytes: Vec<u8>, wake: Wake) {
        let sender = self.expect(&name);
        aside(move || {
            // Nobody waits any longer where another scene was asked for meanwhile.
            let _ = sender.send(open_bytes(name, &bytes));
            wake();
        });
    }

    fn expect(&mut self, name: &str) -> Sender<Outcome> {
        let (sender, result) = channel();
        self.pending = Some((name.to_owned(), result));
        sender
    }

    /// What is being loaded.
    pub fn pending(&self) -> Option<&str> {
        self.pending.as_ref().map(|(spec, _)| spec.as_str())
    }

    /// The outcome, once it is there: what was opened, or one line.
    pub fn take(&mut self) -> Option<Outcome> {
        let outcome = self.pending.as_ref()?.1.try_recv().ok()?;
        self.pending = None;
        Some(outcome)
    }
}

fn load_now(wanted: Wanted) -> Result<Loaded, String> {
    // The setup first: it is quickly read, and a large scene is not.
    let setup = match &wanted.setup {
        Some(path) => Some((path.clone(), read_setup(path)?)),
        None => None,
    };
    let options = LoadOptions { time_s: wanted.time_s };
    let loaded = load_animated(&wanted.spec, &options).map_err(|error| one_line(&error.to_string()))?;
    Ok(finished(wanted, setup, loaded))
}

/// Puts a scene on a ground where that is wanted, as the laboratory does.
fn finished(
    wanted: Wanted,
    setup: Option<(PathBuf, Setup)>,
    (mut scene, animations): (Scene, Option<Animations>),
) -> Loaded {
    let mut notes = scene.warnings.clone();
    notes.extend(scene.unit_warning());
    // Of what stands there, not of what it stands on.
    let assumed = Setup::assumed(&scene);
    let has_ground = wanted.ground.is_for(&scene, setup.is_none() && assumed.framing.is_some());
    if has_ground && wanted.ground == Ground::Auto {
        notes.push(Ground::told(&scene));
    }
    if has_ground {
        scene.stand_on_ground();
    }
    let anchor = setup.as_ref().map_or(&assumed.setup, |(_, setup)| setup).camera.anchor();
    scene.count_from(anchor);
    Loaded {
        spec: antumbra_scene::builtin::declared_name(&wanted.spec),
        scene: Arc::new(scene),
        anchor,
        assumed: assumed.setup.counted_from(anchor),
        framing: assumed.framing.filter(|_| setup.is_none()),
        setup: setup.map(|(path, setup)| (path, setup.counted_from(anchor))),
        animations: animations.map(Arc::new),
        time_s: wanted.time_s,
        has_ground,
        notes,
    }
}

/// What the bytes of a file are, by its name.
#[cfg(any(test, target_arch = "wasm32"))]
fn open_bytes(name: String, bytes: &[u8]) -> Outcome {
    let why = |error: antumbra_scene::SceneError| one_line(&error.to_string());
    if is_setup(&name) {
        let text = std::str::from_utf8(bytes).map_err(|_| format!("{name}: is no text; a setup is a file in TOML"))?;
        let setup = Setup::from_toml(text, Path::new(&name)).map_err(why)?;
        return Ok(Opened::Setup(name.into(), setup));
    }
    let loaded = antumbra_scene::load_chosen(bytes, &name, &LoadOptions::default()).map_err(why)?;
    Ok(Opened::Scene(Box::new(finished(Wanted::plain(name), None, loaded))))
}

/// Whether a file of this name is a setup.
pub fn is_setup(name: &str) -> bool {
    name.to_lowercase().ends_with(".toml")
}

/// Reads a setup file.
///
/// # Errors
/// One line.
pub fn read_setup(path: &Path) -> Result<Setup, String> {
    Setup::from_file(path).map_err(|error| one_line(&error.to_string()))
}

/// Writes a setup file, whole or not at all.
///
/// # Errors
/// One line.
pub fn write_setup(path: &Path, setup: &Setup) -> Result<(), String> {
    write_whole(path, setup.to_toml().as_bytes())
}

/// Writes a file under another name, then gives it its own.
///
/// # Errors
/// One line.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    written.map_err(|error| {
        // Where even this fails there is nothing to remove.
        let _ = std::fs::remove_file(&part);
        format!("{}: cannot be written: {error}; choose a folder that can be written to", path.display())
    })
}

/// Gives a file to the browser to keep.
///
/// # Errors
/// One line.
#[cfg(target_arch = "wasm32")]
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    crate::download::download(path, bytes).ok_or_else(|| format!("{}: the browser takes no download", path.display()))
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;
    use antumbra_scene::load;

    use super::*;
    use crate::state::State;

    #[test]
    fn a_setup_comes_back_as_it_was() {
        let Loaded { spec, scene, .. } = load_now(Wanted::plain("builtin:knot")).unwrap();
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
    fn what_is_far_from_the_origin_is_counted_from_its_camera() {
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
            let why = load_now(Wanted::plain(spec)).unwrap_err();
            assert!(!why.contains('\n') && why.len() > spec.len(), "{why}");
        }
    }
}
