//! The whole application, fed with a hand's events and without a window: what would be on the screen is laid out and drawn, but
//! shown nowhere.

use std::path::PathBuf;
use std::time::Duration;

use antumbra::Quality;
use antumbra_scene::Ground;
use eframe::egui_wgpu;

use super::*;
use crate::device::device_descriptor;
use crate::state::{ShapeKind, Side};

/// A window that is not there.
struct Window {
    ctx: egui::Context,
    app: App,
    size: egui::Vec2,
    device: wgpu::Device,
    /// What the device has complained about.
    complaints: Arc<Mutex<Vec<String>>>,
    outcome: Outcome,
}

/// A device for a window, or `None` and a word where this machine has none and none is required.
fn render_state() -> Option<RenderState> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) else {
        antumbra_testing::skip_without_adapter();
        return None;
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&device_descriptor(&adapter))).unwrap();
    let target_format = wgpu::TextureFormat::Rgba8Unorm;
    let renderer = egui_wgpu::Renderer::new(&device, target_format, egui_wgpu::RendererOptions::default());
    Some(RenderState {
        adapter,
        available_adapters: Vec::new(),
        instance,
        device,
        queue,
        target_format,
        renderer: Arc::new(egui::mutex::RwLock::new(renderer)),
    })
}

fn options(scene: &str) -> ViewerOptions {
    let mut side = Side::new(TechniqueKind::Hard);
    side.set_quality(Quality::Fast);
    ViewerOptions {
        scene: Some(scene.to_owned()),
        setup: None,
        time_s: 0.0,
        ground: Ground::Auto,
        side,
        against: None,
        show: Show::Shaded,
        size: UVec2::new(640, 400),
        adapter: None,
        screenshot: None,
    }
}

impl Window {
    fn open(options: ViewerOptions) -> Option<Self> {
        Self::of(|ctx, render_state, outcome| App::new(ctx, render_state, options, outcome))
    }

    fn of(make: impl FnOnce(&egui::Context, RenderState, Outcome) -> App) -> Option<Self> {
        let render_state = render_state()?;
        let device = render_state.device.clone();
        let (ctx, outcome) = (egui::Context::default(), Outcome::default());
        let app = make(&ctx, render_state, outcome.clone());
        let complaints = Arc::new(Mutex::new(Vec::new()));
        let told = complaints.clone();
        // After the renderer's own, which it takes the place of.
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| told.lock().unwrap().push(error.to_string())));
        Some(Self { ctx, app, size: egui::vec2(640.0, 400.0), device, complaints, outcome })
    }

    /// One frame with these events.
    fn frame(&mut self, events: Vec<egui::Event>) {
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, self.size)),
            events,
            ..egui::RawInput::default()
        };
        let app = &mut self.app;
        let mut output = self.ctx.run_ui(input, |ui| app.show(ui));
        // Nobody draws it.
        output.textures_delta.clear();
        assert_eq!(*self.complaints.lock().unwrap(), Vec::<String>::new());
    }

    /// Frames until nothing is left to do.
    fn settle(&mut self) {
        let mut still = 0;
        for _ in 0..4000 {
            self.frame(Vec::new());
            let is_busy = self.app.was_unfinished || self.app.is_posing() || self.app.loader.pending().is_some();
            still = if is_busy { 0 } else { still + 1 };
            if still == 3 {
                return;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        panic!("it never stands still: {:?}", self.app.message);
    }

    fn key(&mut self, key: egui::Key) {
        let event = |pressed| egui::Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        self.frame(vec![event(true), event(false)]);
    }

    fn pictured(&mut self) -> Vec<u8> {
        self.settle();
        self.app.renderer.read_output().unwrap();
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        self.app.renderer.take_output().unwrap().bytes
    }
}

/// A figure that walks, where this machine has the folder of test scenes.
fn walker() -> Option<String> {
    let path = scenes_folder()?.join("cesium-man.glb");
    path.exists().then(|| path.display().to_string())
}

fn scenes_folder() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folders = [
        std::env::var_os("ANTUMBRA_SCENES").map(PathBuf::from),
        Some(workspace.join("../shared/scenes")),
        Some(workspace.join("shared/scenes")),
    ];
    let found = folders.into_iter().flatten().find(|folder| folder.is_dir());
    if found.is_none() {
        antumbra_testing::skip("set ANTUMBRA_SCENES to the folder of test scenes");
    }
    found
}

#[test]
fn a_scene_plays_stands_still_and_is_what_it_is_when_opened_then() {
    let Some(walker) = walker() else { return };
    let Some(mut window) = Window::open(options(&walker)) else { return };
    let first = window.pictured();
    let open = window.app.state.scene.clone().unwrap();
    assert!(open.has_ground && window.app.message.0.contains("stands on nothing"), "{:?}", window.app.message);
    window.key(egui::Key::Space);
    assert!(window.app.state.play.is_playing);
    let mut times = Vec::new();
    while window.app.state.play.time_s < 0.5 {
        window.frame(Vec::new());
        times.push(window.app.state.play.time_s);
        assert!(times.len() < 20_000, "time does not go by: {:?}", window.app.state.play);
    }
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]));
    window.key(egui::Key::Space);
    assert!(!window.app.state.play.is_playing && window.app.state.play.time_s > 0.3);
    // Paused, nothing is drawn.
    window.settle();
    let version = window.app.renderer.version();
    for _ in 0..5 {
        window.frame(Vec::new());
    }
    assert_eq!(window.app.renderer.version(), version);
    // The same moment, opened.
    window.app.act(&window.ctx.clone(), Action::Expose);
    let (posed, time_s) = (window.pictured(), window.app.state.play.time_s);
    assert_ne!(posed, first, "nothing moves");
    let setup = window.app.state.setup.clone();
    let Some(mut other) = Window::open(ViewerOptions { time_s, ..options(&walker) }) else { return };
    other.settle();
    other.app.state.setup = setup;
    other.settle();
    other.app.act(&other.ctx.clone(), Action::Expose);
    assert!(other.pictured() == posed, "at {time_s} s");
}

/// Whatever digits a number has: what is shown of it is rounded, and itself it is not.
#[test]
fn looking_changes_nothing() {
    let Some(mut window) = Window::open(options("builtin:overlap")) else { return };
    window.settle();
    let light = &mut window.app.state.setup.lights[0];
    (light.intensity, light.cone) =
        (9.123_456, Some(antumbra_light::Cone { inner_rad: 0.123_456, outer_rad: 0.654_321 }));
    crate::state::Angles { azimuth_rad: 0.123_456, elevation_rad: 1.234_567 }.give_to(light);
    window.app.state.setup.camera.fov_y_rad = 0.765_432;
    window.app.state.sides[0].set_kind(TechniqueKind::Pcss);
    window.app.state.sides[0].set("bias_scale", "1.2345678");
    window.size = egui::vec2(900.0, 1600.0);
    let (setup, side) = (window.app.state.setup.clone(), window.app.state.sides[0].clone());
    assert!(side.settings().contains(&("bias_scale", "1.2345678".to_owned())));
    window.settle();
    assert_eq!((&window.app.state.setup, &window.app.state.sides[0]), (&setup, &side));
}

#[test]
fn numbers_follow_the_pointer() {
    let Some(mut window) = Window::open(options("builtin:overlap")) else { return };
    window.settle();
    window.key(egui::Key::I);
    assert!(window.app.panels.is_inspecting);
    window.frame(vec![egui::Event::PointerMoved(egui::pos2(100.0, 250.0))]);
    window.settle();
    let inspected = window.app.renderer.inspected().expect("there is a number");
    assert!(inspected.surface.is_some_and(|surface| surface.position.is_some()));
    assert!(inspected.visibilities[0].is_some() && inspected.visibilities[1].is_none());
    window.frame(vec![egui::Event::PointerGone]);
    window.frame(Vec::new());
    assert_eq!(window.app.renderer.inspected(), None);
}

#[test]
fn another_window_goes_on_where_a_device_was_lost() {
    let Some(mut window) = Window::open(options("builtin:overlap")) else { return };
    window.settle();
    window.app.state.setup.camera.eye.x += 0.5;
    window.app.panels.is_side_shown = false;
    let before = window.pictured();
    window.device.destroy();
    for _ in 0..3 {
        window.frame(Vec::new());
    }
    let ended = window.outcome.lock().unwrap().take();
    let Some(Ended::Lost(why, kept)) = ended else { panic!("nobody noticed") };
    assert!(!why.is_empty() && !why.contains('\n'), "{why}");
    let of_kept = |ctx: &egui::Context, render_state, outcome| App::kept(ctx, render_state, *kept, outcome);
    let Some(mut other) = Window::of(of_kept) else { return };
    assert!(!other.app.panels.is_side_shown);
    // What was exposed for another view is exposed for this one.
    other.settle();
    let after = other.pictured();
    assert_eq!(after.len(), before.len());
    let off = before.iter().zip(&after).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / before.len() as f64;
    assert!(off < 4.0, "{off} levels");
    assert!(other.app.message.0.contains("made anew"));
}

/// Numbers that look random, the same ones for a seed (Marsaglia, "Xorshift RNGs", 2003).
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

/// What is opened: good ones, broken ones, and nothing.
fn things_to_open() -> Vec<String> {
    let mut things: Vec<String> =
        ["builtin:overlap", "builtin:knot?triangles=500", "builtin:stained-glass", "no-such.glb", "no-such.toml"]
            .map(str::to_owned)
            .to_vec();
    things.extend(walker());
    if let Some(broken) = scenes_folder().map(|folder| folder.join("broken"))
        && let Ok(entries) = std::fs::read_dir(broken)
    {
        let mut files: Vec<String> = entries.flatten().map(|entry| entry.path().display().to_string()).collect();
        files.retain(|file| file.ends_with(".glb") || file.ends_with(".gltf") || file.ends_with(".toml"));
        files.sort();
        things.extend(files);
    }
    things
}

/// A step of a hand that does anything.
fn meddle(window: &mut Window, random: &mut Random, things: &[String]) {
    // Of what differs most; all of them go to both ends of their parameters elsewhere.
    let kinds =
        [TechniqueKind::Hard, TechniqueKind::Pcf, TechniqueKind::Vsm, TechniqueKind::Vssm, TechniqueKind::AliasFree];
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
    let place = egui::pos2(random.below(480) as f32, random.below(200) as f32);
    match random.below(12) {
        0 => {
            let action = ui::action_for(&random.pick(things));
            window.app.act(&window.ctx.clone(), action);
        }
        1 => {
            let side = random.below(2);
            window.app.state.sides[side].set_kind(random.pick(&kinds));
            window.app.state.sides[side].set_quality(Quality::Fast);
        }
        2 => window.size = egui::vec2(1.0 + random.below(480) as f32, 1.0 + random.below(160) as f32),
        3 => window.app.state.show = random.pick(&Show::ALL),
        4 => window.app.state.is_split = !window.app.state.is_split,
        5 => random.pick(&ShapeKind::ALL).give_to(&mut window.app.state.setup.lights[0]),
        6 if window.app.state.setup.lights.len() < 2 => window.app.state.add_light(),
        6 => window.app.state.remove_light(),
        7 | 8 => window.key(random.pick(&keys)),
        9 => {
            let button = |pressed| egui::Event::PointerButton {
                pos: place,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            };
            window.frame(vec![egui::Event::PointerMoved(place), button(true)]);
            window.frame(vec![button(false)]);
        }
        10 => {
            window.frame(vec![egui::Event::PointerMoved(place)]);
            window.app.state.setup.camera.eye.y += 0.1;
        }
        _ => window.settle(),
    }
    window.frame(Vec::new());
}

/// How many buffers, textures and groups of bindings the device holds. What the process has in memory says less: on Mesa
/// 22.3's software device it grows by half a megabyte with each frame of `hard`, whoever draws it, and these do not.
fn objects(window: &Window) -> [usize; 3] {
    window.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let report = window.app.render_state.instance.generate_report().expect("there is one but in browsers");
    let hub = report.hub;
    [hub.buffers, hub.textures, hub.bind_groups].map(|kind| kind.num_kept_from_user)
}

/// The same random input over and over: nothing panics, the device has no complaint, and once all that it asks for was made
/// once, nothing piles up on the device.
#[test]
fn random_input_leaves_it_whole() {
    const STEPS: usize = 60;
    const ROUNDS: usize = 3;
    let things = things_to_open();
    let Some(mut window) = Window::open(options("builtin:overlap")) else { return };
    window.size = egui::vec2(480.0, 160.0);
    window.settle();
    let folder = std::env::temp_dir().join(format!("antumbra-viewer-random-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut after = Vec::new();
    for _ in 0..ROUNDS {
        let mut random = Random(17);
        let mut opened = 0;
        for _ in 0..STEPS {
            // Whatever is clicked, nothing is written elsewhere.
            window.app.panels.setup_path = folder.join("setup.toml").display().to_string();
            window.app.panels.picture_path = folder.join("picture.png").display().to_string();
            meddle(&mut window, &mut random, &things);
            opened += u64::from(window.app.loader.pending().is_some());
        }
        assert!(opened > 0, "nothing was opened");
        // Each round begins where the one before did.
        window.size = egui::vec2(480.0, 160.0);
        window.app.panels = Panels::default();
        window.app.act(&window.ctx.clone(), Action::Open("builtin:overlap".into()));
        window.settle();
        window.app.state =
            State { scene: window.app.state.scene.clone(), ..State::new(TechniqueKind::Hard, TechniqueKind::Pcf) };
        window.settle();
        after.push(objects(&window));
    }
    std::fs::remove_dir_all(&folder).unwrap();
    let picture = window.pictured();
    assert!(picture.chunks_exact(4).any(|texel| texel[..3] != picture[..3]), "nothing is shown any more");
    // Rounds do not end in the same frame to the last buffer: what is on its way back differs.
    let (second, last) = (after[ROUNDS - 2], after[ROUNDS - 1]);
    assert!((0..3).all(|kind| last[kind] <= second[kind] + second[kind] / 8), "{after:?} objects after each round");
}
