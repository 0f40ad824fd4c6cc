//! The whole application without a window, fed with input events: the screen's content is laid out and drawn but not
//! presented. For tests, and for [random input](super::random_input).

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use antumbra::{Quality, TechniqueKind};
use antumbra_scene::Ground;
use eframe::egui_wgpu;
use eframe::egui_wgpu::RenderState;
use glam::UVec2;
use web_time::Instant;

use super::{App, Outcome};
use crate::device::device_descriptor;
use crate::file_dialog::FileDialog;
use crate::message::one_line;
use crate::options::ViewerOptions;
use crate::state::{Show, Side};

/// Time limit for the application to become idle. Software devices compile some techniques for a minute.
const MAX_WAIT: Duration = Duration::from_secs(300);

/// A window without a screen.
pub struct Window {
    pub ctx: egui::Context,
    pub app: App,
    pub size: egui::Vec2,
    /// Physical pixels per point of `size`.
    pub pixels_per_point: f32,
    pub device: wgpu::Device,
    /// Uncaptured errors of the device.
    pub validation_errors: Arc<Mutex<Vec<String>>>,
    pub outcome: Outcome,
}

/// A file dropped on the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Reason why the application cannot run without a window.
#[derive(Debug, thiserror::Error)]
pub enum HeadlessError {
    /// This machine has no adapter.
    #[error("no graphics adapter was found; install a graphics driver, or a software one such as Mesa's")]
    NoAdapter,
    /// The adapter gives no device.
    #[error("the adapter cannot create a device: {0}")]
    NoDevice(String),
    /// The folder for saved files cannot be created.
    #[error("{0}: cannot be created: {1}")]
    NoFolder(PathBuf, std::io::Error),
}

/// Creates the render state of a window on the system's default adapter.
fn render_state() -> Result<RenderState, HeadlessError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.map_err(|_| HeadlessError::NoAdapter)?;
    let device = pollster::block_on(adapter.request_device(&device_descriptor(&adapter)));
    let (device, queue) = device.map_err(|error| HeadlessError::NoDevice(one_line(&error.to_string())))?;
    let target_format = wgpu::TextureFormat::Rgba8Unorm;
    let renderer = egui_wgpu::Renderer::new(&device, target_format, egui_wgpu::RendererOptions::default());
    Ok(RenderState {
        adapter,
        available_adapters: Vec::new(),
        instance,
        device,
        queue,
        target_format,
        renderer: Arc::new(egui::mutex::RwLock::new(renderer)),
    })
}

/// Options that show a scene under `hard` at `fast` quality, which software devices draw quickly.
pub fn options(scene: &str) -> ViewerOptions {
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
    pub fn open(options: ViewerOptions) -> Result<Self, HeadlessError> {
        Self::of(|ctx, render_state, outcome| App::new(ctx, render_state, options, outcome))
    }

    pub fn of(make: impl FnOnce(&egui::Context, RenderState, Outcome) -> App) -> Result<Self, HeadlessError> {
        let render_state = render_state()?;
        let device = render_state.device.clone();
        let (ctx, outcome) = (egui::Context::default(), Outcome::default());
        let mut app = make(&ctx, render_state, outcome.clone());
        app.file_dialog = FileDialog::absent();
        let validation_errors = Arc::new(Mutex::new(Vec::new()));
        let told = validation_errors.clone();
        // This replaces the renderer's own handler.
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            told.lock().unwrap_or_else(PoisonError::into_inner).push(error.to_string());
        }));
        Ok(Self { ctx, app, size: egui::vec2(640.0, 400.0), pixels_per_point: 1.0, device, validation_errors, outcome })
    }

    /// Runs one frame with these events.
    pub fn frame(&mut self, events: Vec<egui::Event>) {
        self.frame_of(egui::RawInput { events, ..egui::RawInput::default() });
    }

    /// Runs one frame in which these files are dropped.
    pub fn drop_files(&mut self, paths: &[&str]) {
        let dropped = |path: &&str| Arc::new(Dropped(path.into())) as egui::DroppedFileHandle;
        let dropped_files = paths.iter().map(dropped).collect();
        self.frame_of(egui::RawInput { dropped_files, ..egui::RawInput::default() });
    }

    fn frame_of(&mut self, mut input: egui::RawInput) {
        input.viewports.entry(input.viewport_id).or_default().native_pixels_per_point = Some(self.pixels_per_point);
        let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, self.size));
        let app = &mut self.app;
        let mut output = self.ctx.run_ui(egui::RawInput { screen_rect, ..input }, |ui| app.show(ui));
        // The output is discarded. A real window waits for the screen, so it never runs far ahead of its device; without a wait here a
        // slow device would receive frames faster than it draws them. A lost device is reported by the next frame.
        output.textures_delta.clear();
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
        assert_eq!(*self.validation_errors.lock().unwrap_or_else(PoisonError::into_inner), Vec::<String>::new());
    }

    /// Runs frames until the application is idle. Returns whether that happened within `most`.
    pub fn wait(&mut self, most: Duration) -> bool {
        let (began, mut still) = (Instant::now(), 0);
        while began.elapsed() < most {
            self.frame(Vec::new());
            let is_busy = self.app.was_unfinished || self.app.is_posing() || self.app.loader.pending().is_some();
            still = if is_busy { 0 } else { still + 1 };
            if still == 3 {
                return true;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        false
    }

    /// Runs frames until the application is idle; panics after `MAX_WAIT`.
    pub fn settle(&mut self) {
        let is_still = self.wait(MAX_WAIT);
        let compiling = self.app.renderer.sides.each_ref().map(|side| side.compiling());
        assert!(is_still, "the application does not become idle: {:?}, compiling {compiling:?}", self.app.message);
    }

    /// Whether the window has closed by itself.
    pub fn has_closed(&self) -> bool {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    pub fn key(&mut self, key: egui::Key) {
        let event = |pressed| egui::Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        self.frame(vec![event(true), event(false)]);
    }
}
