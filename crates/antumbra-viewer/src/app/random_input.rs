//! Random input to the whole application: opens and drops valid and broken files, resizes and minimises the window, chooses
//! techniques, qualities, parameters, views and lights, plays animations, clicks and presses keys.
//!
//! Every failure is a panic: the application's own, or one that repeats an error of the device. `examples/random_input.rs`
//! runs it for minutes, and a test in three short rounds.

use std::path::{Path, PathBuf};
use std::time::Duration;

use antumbra::contract::ParamValue;
use antumbra::{Quality, TechniqueKind};

pub use super::headless::HeadlessError;

use super::headless::{Window, options};
use crate::state::{SPEEDS, ShapeKind, Show, Side, State};
use crate::ui::{self, Action, Panels};

/// Scene that is open at first and whenever objects are counted.
const HOME: &str = "builtin:overlap";
/// Window size for [`HOME`], points. It is small because software devices draw it.
const HOME_SIZE: [f32; 2] = [480.0, 160.0];
/// Time limit of a step that only waits.
const MAX_WATCHING: Duration = Duration::from_secs(1);

/// Xorshift generator; a seed determines its numbers (Marsaglia, "Xorshift RNGs", 2003).
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }
}

/// Number of objects that the device holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceObjects {
    /// Buffers.
    pub buffers: usize,
    /// Textures.
    pub textures: usize,
    /// Bind groups.
    pub bind_groups: usize,
    /// Pipelines. They stay cached, so their number is bounded by the number of pipeline keys.
    pub pipelines: usize,
}

/// The application with a generator of random input.
pub struct RandomInput {
    window: Window,
    random: Random,
    things: Vec<String>,
    kinds: Vec<TechniqueKind>,
    /// Temporary folder for saved files; removed on drop.
    folder: PathBuf,
    opened: u64,
}

impl RandomInput {
    /// Creates the application and a generator with a seed other than zero. It opens `things` and chooses among `kinds`.
    ///
    /// # Errors
    /// Fails if this machine gives no device, or the folder for saved files cannot be created.
    pub fn new(seed: u64, things: Vec<String>, kinds: Vec<TechniqueKind>) -> Result<Self, HeadlessError> {
        let folder = std::env::temp_dir().join(format!("antumbra-viewer-random-{}", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(|error| HeadlessError::NoFolder(folder.clone(), error))?;
        let window = Window::open(options(HOME))?;
        let mut input = Self { window, random: Random(seed), things, kinds, folder, opened: 0 };
        input.come_home();
        Ok(input)
    }

    /// Restarts the generator with this seed.
    pub fn begin_anew(&mut self, seed: u64) {
        self.random = Random(seed);
    }

    /// Number of opened scenes and setups.
    pub fn opened(&self) -> u64 {
        self.opened
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> &str {
        &self.window.app.adapter
    }

    #[cfg(test)]
    pub(super) fn window(&mut self) -> &mut Window {
        &mut self.window
    }

    /// Applies one random input and runs the frame after it.
    pub fn step(&mut self) {
        let Self { window, random, things, kinds, .. } = self;
        // All files are written to the temporary folder, whatever is clicked.
        window.app.panels.setup_path = self.folder.join("setup.toml").display().to_string();
        window.app.panels.picture_path = self.folder.join("picture.png").display().to_string();
        match random.below(8) {
            0 => open(window, random, things),
            1 => resize(window, random),
            2 | 3 => choose(window, random, kinds),
            4 => light(window, random),
            5 => play(window, random),
            6 => touch(window, random),
            _ => {
                // A playing animation never becomes idle.
                window.wait(MAX_WATCHING);
            }
        }
        window.frame(Vec::new());
        assert!(!window.has_closed(), "the window closed by itself, as it does when the device is lost");
        self.opened += u64::from(self.window.app.loader.pending().is_some());
    }

    /// Returns to the initial state and counts the device's objects there.
    pub fn come_home(&mut self) -> DeviceObjects {
        let window = &mut self.window;
        window.size = HOME_SIZE.into();
        window.app.panels = Panels::default();
        window.app.act(&window.ctx.clone(), Action::Open(HOME.into()));
        // Nothing plays while this scene loads. A technique's state keeps the textures of an earlier light's parts, up to
        // six faces or seven cascades, until another technique is chosen. Swapping the sides forces that.
        window.app.state = at_home(&window.app.state);
        window.app.state.sides.swap(0, 1);
        window.settle();
        window.app.state = at_home(&window.app.state);
        window.settle();
        objects(window)
    }
}

impl Drop for RandomInput {
    fn drop(&mut self) {
        // The folder is temporary, so leftovers are harmless.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The initial state of a window that shows the open scene.
fn at_home(state: &State) -> State {
    let mut home = State::new(TechniqueKind::Hard, TechniqueKind::Pcf);
    // Without the split the right side would keep its last image.
    home.is_split = true;
    home.sides.iter_mut().for_each(|side| side.set_quality(Quality::Fast));
    home.setup = state.setup.clone();
    home.scene = state.scene.clone();
    home
}

/// Opens one file from the list, or drops one or two on the window.
fn open(window: &mut Window, random: &mut Random, things: &[String]) {
    let thing = random.pick(things);
    match random.below(3) {
        0 => window.app.act(&window.ctx.clone(), ui::action_for(&thing)),
        1 => window.drop_files(&[&thing]),
        _ => window.drop_files(&[&thing, &random.pick(things)]),
    }
}

/// Resizes the window, down to one point, or to zero as a minimised window.
fn resize(window: &mut Window, random: &mut Random) {
    window.size = match random.below(4) {
        0 => egui::Vec2::ZERO,
        _ => egui::vec2(1.0 + random.below(480) as f32, 1.0 + random.below(160) as f32),
    };
}

/// Chooses another technique, quality, parameter or view.
fn choose(window: &mut Window, random: &mut Random, kinds: &[TechniqueKind]) {
    let state = &mut window.app.state;
    let side = &mut state.sides[random.below(2)];
    match random.below(6) {
        0 | 1 => {
            side.set_kind(random.pick(kinds));
            side.set_quality(Quality::Fast);
        }
        // Higher qualities take software devices seconds per frame.
        2 => side.set_quality(random.pick(&[Quality::Fast, Quality::Balanced])),
        3 => turn_parameter(side, random),
        4 => {
            state.show = random.pick(&Show::ALL);
            (state.level, state.layer) = (random.below(4), random.below(4));
        }
        _ => {
            state.is_split = !state.is_split;
            state.divider = random.below(5) as f32 / 4.0;
        }
    }
}

/// Sets a parameter to its low end, its default, its other choice or an invalid value. Another test covers high ends, which
/// are slow on software devices.
fn turn_parameter(side: &mut Side, random: &mut Random) {
    let specs = side.kind().param_specs();
    if specs.is_empty() {
        return;
    }
    let spec = &specs[random.below(specs.len())];
    let value = match (spec.default, spec.range, random.below(4)) {
        (_, _, 0) => "a removed entry".to_owned(),
        (_, _, 1) => side.usual(spec).to_string(),
        (ParamValue::Bool(_), ..) => (random.below(2) == 0).to_string(),
        (_, Some((low, _)), _) if spec.choices.is_empty() || random.below(2) == 0 => low.to_string(),
        (_, Some(_), _) | (ParamValue::Choice(_), ..) => random.pick(spec.choices).to_owned(),
        (_, None, _) => String::new(),
    };
    side.set(spec.key, &value);
}

/// Adds, removes, selects or changes a light.
fn light(window: &mut Window, random: &mut Random) {
    let state = &mut window.app.state;
    match random.below(5) {
        0 if state.setup.lights.len() < 2 => state.add_light(),
        0 => state.remove_light(),
        1 => state.light = random.below(state.setup.lights.len()),
        2 => state.setup.lights[state.light].center.x += random.below(5) as f32 - 2.0,
        3 => state.light_turn_rad_s = random.below(3) as f32 - 1.0,
        _ => random.pick(&ShapeKind::ALL).give_to(&mut state.setup.lights[state.light]),
    }
}

/// Changes the animation's time, speed or state.
fn play(window: &mut Window, random: &mut Random) {
    let state = &mut window.app.state;
    match random.below(4) {
        0 => state.play.is_playing = state.play.ends_s.is_some() && !state.play.is_playing,
        1 => state.play.speed = random.pick(&[*SPEEDS.start(), 1.0, *SPEEDS.end()]),
        2 => {
            if let Some([first, last]) = state.play.ends_s {
                state.play.time_s = first + (last - first) * random.below(5) as f32 / 4.0;
            }
        }
        _ => state.camera_turn_rad_s = random.below(3) as f32 - 1.0,
    }
}

/// Presses a key, clicks, or moves the pointer and the camera.
fn touch(window: &mut Window, random: &mut Random) {
    let keys = [
        egui::Key::F,
        egui::Key::B,
        egui::Key::Num1,
        egui::Key::P,
        egui::Key::I,
        egui::Key::Space,
        egui::Key::Tab,
        egui::Key::Enter,
        egui::Key::W,
    ];
    let place = egui::pos2(random.below(480) as f32, random.below(160) as f32);
    let button = |pressed| egui::Event::PointerButton {
        pos: place,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    match random.below(4) {
        0 | 1 => window.key(random.pick(&keys)),
        2 => {
            window.frame(vec![egui::Event::PointerMoved(place), button(true)]);
            window.frame(vec![button(false)]);
        }
        _ => {
            window.frame(vec![egui::Event::PointerMoved(place)]);
            window.app.state.setup.camera.eye.y += 0.1;
        }
    }
}

/// Counts the device's objects. Process memory is a weaker measure: on Mesa 22.3's software device it grows by half a
/// megabyte per frame of `hard`, with any program, while these counts do not.
fn objects(window: &Window) -> DeviceObjects {
    // A lost device is reported by the next frame.
    let _ = window.device.poll(wgpu::PollType::wait_indefinitely());
    let report = window.app.render_state.instance.generate_report().expect("every system except browsers has a clock");
    let hub = report.hub;
    DeviceObjects {
        buffers: hub.buffers.num_kept_from_user,
        textures: hub.textures.num_kept_from_user,
        bind_groups: hub.bind_groups.num_kept_from_user,
        pipelines: hub.render_pipelines.num_kept_from_user + hub.compute_pipelines.num_kept_from_user,
    }
}

/// Names to open: built-in scenes, missing files, and the files of a folder.
///
/// # Errors
/// Fails if the folder cannot be read.
pub fn things_to_open(folder: Option<&Path>) -> std::io::Result<Vec<String>> {
    let always = [HOME, "builtin:knot?triangles=500", "builtin:stained-glass", "no-such.glb", "no-such.toml"];
    let mut things: Vec<String> = always.map(str::to_owned).to_vec();
    let Some(folder) = folder else { return Ok(things) };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let is_wanted = |extension: &std::ffi::OsStr| ["glb", "gltf", "toml"].iter().any(|one| extension == *one);
        if path.extension().is_some_and(is_wanted) {
            files.push(path.display().to_string());
        }
    }
    files.sort();
    things.extend(files);
    Ok(things)
}
