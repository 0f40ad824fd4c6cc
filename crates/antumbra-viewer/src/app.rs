//! The application: input changes the state, the renderer draws the state, and panels show the measurements.

mod actions;
#[cfg(not(target_arch = "wasm32"))]
mod headless;
mod history;
mod opening;
mod picture;
#[cfg(not(target_arch = "wasm32"))]
pub mod random_input;
mod screenshot;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use antumbra::{Gpu, TechniqueKind};
use antumbra_scene::{Framing, Scene};
use eframe::egui_wgpu::RenderState;
use glam::UVec2;
use web_time::Instant;

use self::history::History;
use self::screenshot::Screenshot;
use crate::file_dialog::FileDialog;
use crate::loader::{Loader, SceneRequest};
use crate::message::one_line;
use crate::options::ViewerOptions;
use crate::poser::Poser;
use crate::renderer::{Compile, MapChoices, Renderer, Wake};
use crate::state::State;
use crate::truth::LiveTruth;
use crate::ui::{self, Panels, Readings};

/// Scene that opens if none is named.
const FIRST_SCENE: &str = "builtin:lantern-wall";
/// Window width below which the side panel starts hidden, because it would leave no room for the image, points.
const NARROW_WINDOW: f32 = 640.0;

/// Shared slot for an outcome that outlives the window.
pub type Outcome = Arc<Mutex<Option<Ended>>>;

/// Reason why a window has closed by itself.
#[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a browser page is reloaded, not closed"))]
pub enum Ended {
    /// The task is complete, or it failed.
    Done(Result<(), String>),
    /// The graphics device is lost: the reason, and the state for the next window.
    Lost(String, Box<PersistentState>),
}

/// State that outlives a window and its device.
#[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a browser page is reloaded"))]
pub struct PersistentState {
    state: State,
    history: History,
    scene: Option<Arc<Scene>>,
    poser: Option<Poser>,
    panels: Panels,
    screenshot: Option<PathBuf>,
}

/// The application.
pub struct App {
    render_state: RenderState,
    adapter: String,
    state: State,
    history: History,
    renderer: Renderer,
    /// The renderer's output and its identifier in egui.
    texture: Option<(wgpu::TextureView, egui::TextureId)>,
    size_px: UVec2,
    /// Framing of the newly opened scene, until the image's size is known.
    unframed: Option<Framing>,
    /// Pixel under the pointer, whose values are shown.
    asked_px: Option<UVec2>,
    scene: Option<Arc<Scene>>,
    /// Poser of the scene, if it is animated.
    poser: Option<Poser>,
    loader: Loader,
    file_dialog: FileDialog,
    truth: LiveTruth,
    /// For each side: the version of the mask that was read, and its visibility by pixel.
    masks: [Option<(u64, Vec<f32>)>; 2],
    panels: Panels,
    /// The last message, and whether it reports a failure.
    message: (String, bool),
    wake: Wake,
    last_frame: Instant,
    was_unfinished: bool,
    /// File for the image that is being read back.
    saving: Option<PathBuf>,
    screenshot: Option<Screenshot>,
    outcome: Outcome,
}

impl App {
    /// Creates the application for a window that has a device.
    pub fn new(ctx: &egui::Context, render_state: RenderState, options: ViewerOptions, outcome: Outcome) -> Self {
        let mut app = Self::bare(ctx, render_state, options.screenshot, outcome);
        app.state.is_split = options.against.is_some();
        app.state.sides[0] = options.side;
        if let Some(against) = options.against {
            app.state.sides[1] = against;
        }
        app.state.show = options.show;
        let wanted = SceneRequest {
            spec: options.scene.unwrap_or_else(|| FIRST_SCENE.to_owned()),
            setup: options.setup,
            time_s: options.time_s,
            ground: options.ground,
        };
        app.loader.load(wanted, app.wake.clone());
        app
    }

    /// Creates the application with no scene open.
    fn bare(ctx: &egui::Context, render_state: RenderState, screenshot: Option<PathBuf>, outcome: Outcome) -> Self {
        let gpu = Gpu::new(&render_state.device, &render_state.queue);
        let for_wake = ctx.clone();
        let wake: Wake = Arc::new(move || for_wake.request_repaint());
        let info = render_state.adapter.get_info();
        Self {
            adapter: format!("{} ({})", info.name, info.backend),
            renderer: Renderer::new(&gpu, Compile::Background(wake.clone())),
            render_state,
            state: State::new(TechniqueKind::Smrt, TechniqueKind::Hard),
            history: History::default(),
            texture: None,
            size_px: UVec2::ZERO,
            unframed: None,
            asked_px: None,
            scene: None,
            poser: None,
            loader: Loader::default(),
            file_dialog: FileDialog::default(),
            truth: LiveTruth::new(wake.clone()),
            masks: [None, None],
            panels: Panels::default(),
            message: (String::new(), false),
            wake,
            last_frame: Instant::now(),
            was_unfinished: false,
            saving: None,
            screenshot: screenshot.map(|path| Screenshot {
                path,
                still_frames: 0,
                image: Arc::default(),
                is_asked: false,
            }),
            outcome,
        }
    }

    /// Continues in a new window the application of one whose device was lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn kept(ctx: &egui::Context, render_state: RenderState, kept: PersistentState, outcome: Outcome) -> Self {
        let PersistentState { state, history, scene, poser, panels, screenshot } = kept;
        let mut app = Self::bare(ctx, render_state, screenshot, outcome);
        if let (Some(scene), Some(open)) = (&scene, &state.scene) {
            app.renderer.open(scene, open.generation);
        }
        app.say("the graphics device was lost and has been recreated");
        Self { state, history, scene, poser, panels, ..app }
    }

    /// Closes the window and keeps its state if the device is lost. Returns true then: the caller must not draw.
    fn give_up_lost_device(&mut self, ctx: &egui::Context) -> bool {
        let Some(why) = self.renderer.lost() else { return false };
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        if outcome.is_none() {
            self.truth.want(None);
            let kept = PersistentState {
                state: self.state.clone(),
                history: std::mem::take(&mut self.history),
                scene: self.scene.take(),
                poser: self.poser.take(),
                panels: std::mem::take(&mut self.panels),
                screenshot: self.screenshot.take().map(|screenshot| screenshot.path),
            };
            *outcome = Some(Ended::Lost(one_line(&why), Box::new(kept)));
        }
        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        true
    }

    fn say(&mut self, message: impl Into<String>) {
        self.message = (message.into(), false);
    }

    fn complain(&mut self, message: impl Into<String>) {
        self.message = (message.into(), true);
    }

    fn finish(&mut self, ctx: &egui::Context, outcome: Result<(), String>) {
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(Ended::Done(outcome));
        self.screenshot = None;
        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
    }

    /// Chooses the technique of the left side, as its list does.
    #[cfg(target_arch = "wasm32")]
    pub fn choose(&mut self, kind: TechniqueKind) {
        self.state.sides[0].set_kind(kind);
        (self.wake)();
    }

    /// Moves the selected light by a vector in world space, metres.
    #[cfg(target_arch = "wasm32")]
    pub fn move_light(&mut self, by_m: glam::Vec3) {
        crate::state::move_by(&mut self.state.setup.lights[self.state.light], by_m);
        (self.wake)();
    }

    /// The scene, the technique drawn and the newest message; `None` while work is left.
    #[cfg(target_arch = "wasm32")]
    pub fn settled(&self) -> Option<String> {
        let open = self.state.scene.as_ref().filter(|_| self.loader.pending().is_none())?;
        let drawn = self.renderer.sides[0].kind().filter(|kind| *kind == self.state.sides[0].kind())?;
        let is_still = !self.was_unfinished && self.texture.is_some();
        let problem = self.renderer.sides[0].problem().unwrap_or_default();
        is_still.then(|| format!("{} {drawn} {}{problem}", open.spec, self.message.0).trim().to_owned())
    }
}

impl eframe::App for App {
    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }
}

impl App {
    /// Advances time, and takes what was loaded or chosen since the last frame.
    fn advance(&mut self, ctx: &egui::Context) {
        let seconds = self.last_frame.elapsed().as_secs_f32().min(0.1);
        self.last_frame = Instant::now();
        self.state.advance(seconds);
        self.take_loaded(ctx);
        self.take_chosen(ctx);
        self.pose();
        self.history.note(&self.state, ctx.input(|input| input.time));
    }

    /// Line of the status bar, and whether it reports a failure.
    fn status(&self) -> (String, bool) {
        match self.loader.pending() {
            Some(spec) => (format!("loading {spec}"), false),
            None => self.message.clone(),
        }
    }

    /// Handles input and draws one frame.
    fn show(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        if self.give_up_lost_device(&ctx) {
            return;
        }
        if ctx.cumulative_pass_nr() == 0 && ui.max_rect().width() < NARROW_WINDOW {
            self.panels.is_side_shown = false;
        }
        self.advance(&ctx);
        let mut actions = self.keys(&ctx);
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in dropped {
            self.take_dropped(file, &mut actions);
        }

        let of_side = |side: usize| self.renderer.sides[side].map_choices(self.state.show, self.state.light);
        let sides = 0..self.state.shown_sides().len();
        let choices = sides.map(of_side).reduce(MapChoices::or_more).unwrap_or_default();
        egui::Panel::top("top").resizable(false).show(ui, |ui| {
            let can = self.history.can_undo_and_redo(&self.state);
            actions.extend(ui::top(ui, &mut self.state, &mut self.panels, choices, can));
        });
        let rmse = |side: usize, estimate: Option<&crate::truth::Estimate>| {
            let (version, mask) = self.masks[side].as_ref()?;
            (*version == self.renderer.version()).then_some(())?;
            estimate?.rmse(mask)
        };
        let estimate = self.truth.estimate();
        let (truth_points, rmses) = (estimate.map(|estimate| estimate.points), [0, 1].map(|side| rmse(side, estimate)));
        let sides = [0, 1].map(|side| self.renderer.sides[side].readings(rmses[side]));
        let readings = Readings {
            sides,
            truth_points,
            scene_memory_bytes: self.renderer.scene_memory_bytes(),
            size_px: self.size_px,
            adapter: &self.adapter,
            features: self.render_state.device.features(),
        };
        let (message, is_bad) = self.status();
        egui::Panel::bottom("status").resizable(false).show(ui, |ui| {
            ui::status_bar(ui, &self.state, &readings, &message, is_bad);
        });
        if self.state.play.ends_s.is_some() {
            egui::Panel::bottom("time").resizable(false).show(ui, |ui| ui::timeline(ui, &mut self.state));
        }
        if self.panels.is_side_shown {
            egui::Panel::right("side").default_size(360.0).size_range(300.0..=560.0).show(ui, |ui| {
                actions.extend(ui::side(ui, &mut self.state, &mut self.panels, &readings));
            });
        }
        egui::CentralPanel::no_frame().show(ui, |ui| {
            self.draw(ui);
            self.show_picture(ui);
        });
        actions.extend(self.panels.open.show(&ctx, &self.wake));
        for action in actions {
            self.act(&ctx, action);
        }
    }
}

#[cfg(test)]
mod tests;
