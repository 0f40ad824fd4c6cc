//! The window: what comes in goes to the state, the state is drawn, and panels show what is measured of it.

#[cfg(not(target_arch = "wasm32"))]
mod headless;
mod history;
#[cfg(not(target_arch = "wasm32"))]
pub mod random_input;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use antumbra::{Gpu, TechniqueKind};
use antumbra_scene::{Framing, Scene, Setup};
use eframe::egui_wgpu::RenderState;
use glam::UVec2;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use web_time::Instant;

use self::history::History;
use crate::file_dialog::{Chosen, FileDialog, Purpose};
use crate::loader::{Loaded, Loader, Opened, Wanted, read_setup, write_setup, write_whole};
use crate::message::one_line;
use crate::options::ViewerOptions;
use crate::poser::Poser;
use crate::renderer::{Compile, MapChoices, Renderer, Wake};
use crate::state::{Play, Show, State, command_line};
use crate::truth::{Job, LiveTruth};
use crate::ui::{self, Action, Panels, Readings};

/// The scene of a viewer that was given none.
const FIRST_SCENE: &str = "builtin:lantern-wall";
/// A picture of the window waits for so many light points a pixel, where truth is shown.
const SCREENSHOT_POINTS: u32 = 256;
/// And for so many frames in which nothing is left to do.
const SCREENSHOT_STILL_FRAMES: u32 = 8;
/// Width below which a window opens without the panel at the side, which would leave nothing of the image, in points.
const NARROW_WINDOW: f32 = 640.0;
/// How soon to look again for what the GPU has finished.
const SOON: Duration = Duration::from_millis(15);

/// Each goes to the view that was kept as its number.
const BOOKMARK_KEYS: [egui::Key; 9] = [
    egui::Key::Num1,
    egui::Key::Num2,
    egui::Key::Num3,
    egui::Key::Num4,
    egui::Key::Num5,
    egui::Key::Num6,
    egui::Key::Num7,
    egui::Key::Num8,
    egui::Key::Num9,
];

/// Where an outcome goes that outlives the window.
pub type Outcome = Arc<Mutex<Option<Ended>>>;

/// Why a window has closed by itself.
#[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a page is not closed, but loaded anew"))]
pub enum Ended {
    /// There is nothing left to do, or it cannot be done.
    Done(Result<(), String>),
    /// Its graphics device is lost: why, and what another window goes on with.
    Lost(String, Box<Kept>),
}

/// What outlives a window and its device.
#[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a page is loaded anew"))]
pub struct Kept {
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
    /// The renderer's output, and what egui calls it.
    texture: Option<(wgpu::TextureView, egui::TextureId)>,
    size_px: UVec2,
    /// Of the scene opened last, until its picture has a size that it can fill.
    unframed: Option<Framing>,
    /// The pixel whose numbers are shown.
    asked_px: Option<UVec2>,
    scene: Option<Arc<Scene>>,
    /// Of an animated scene.
    poser: Option<Poser>,
    loader: Loader,
    file_dialog: FileDialog,
    truth: LiveTruth,
    /// Of each side: the version of the mask that was read, and its error's inputs.
    masks: [Option<(u64, Vec<f32>)>; 2],
    panels: Panels,
    /// What happened last, and whether it is bad.
    message: (String, bool),
    wake: Wake,
    last_frame: Instant,
    was_unfinished: bool,
    /// Where the picture goes that is on its way back.
    saving: Option<PathBuf>,
    screenshot: Option<Screenshot>,
    outcome: Outcome,
}

struct Screenshot {
    path: PathBuf,
    still_frames: u32,
    image: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
    is_asked: bool,
}

impl App {
    /// The application in a window that has a device.
    pub fn new(ctx: &egui::Context, render_state: RenderState, options: ViewerOptions, outcome: Outcome) -> Self {
        let mut app = Self::bare(ctx, render_state, options.screenshot, outcome);
        app.state.is_split = options.against.is_some();
        app.state.sides[0] = options.side;
        if let Some(against) = options.against {
            app.state.sides[1] = against;
        }
        app.state.show = options.show;
        let wanted = Wanted {
            spec: options.scene.unwrap_or_else(|| FIRST_SCENE.to_owned()),
            setup: options.setup,
            time_s: options.time_s,
            ground: options.ground,
        };
        app.loader.load(wanted, app.wake.clone());
        app
    }

    /// The application with nothing open.
    fn bare(ctx: &egui::Context, render_state: RenderState, screenshot: Option<PathBuf>, outcome: Outcome) -> Self {
        let gpu = Gpu::new(&render_state.device, &render_state.queue);
        let for_wake = ctx.clone();
        let wake: Wake = Arc::new(move || for_wake.request_repaint());
        let info = render_state.adapter.get_info();
        Self {
            adapter: format!("{} ({})", info.name, info.backend),
            renderer: Renderer::new(&gpu, Compile::Aside(wake.clone())),
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

    /// The application in another window, as it was in the one before, whose device was lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn kept(ctx: &egui::Context, render_state: RenderState, kept: Kept, outcome: Outcome) -> Self {
        let Kept { state, history, scene, poser, panels, screenshot } = kept;
        let mut app = Self::bare(ctx, render_state, screenshot, outcome);
        if let (Some(scene), Some(open)) = (&scene, &state.scene) {
            app.renderer.open(scene, open.generation);
        }
        app.say("the graphics device was lost, and made anew");
        Self { state, history, scene, poser, panels, ..app }
    }

    /// Closes the window where its device is lost, and keeps all else. Nothing may be drawn then.
    fn give_up_lost_device(&mut self, ctx: &egui::Context) -> bool {
        let Some(why) = self.renderer.lost() else { return false };
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        if outcome.is_none() {
            self.truth.want(None);
            let kept = Kept {
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

    /// Takes in what has loaded, or why it has not.
    fn take_loaded(&mut self, ctx: &egui::Context) {
        match self.loader.take() {
            None => {}
            Some(Ok(Opened::Setup(path, setup))) => self.take_setup(path, setup),
            Some(Ok(Opened::Scene(loaded))) => self.take_scene(ctx, *loaded),
            Some(Err(why)) => {
                if self.screenshot.is_some() {
                    self.finish(ctx, Err(why));
                } else {
                    self.complain(why);
                }
            }
        }
    }

    fn take_scene(&mut self, ctx: &egui::Context, loaded: Loaded) {
        let Loaded { spec, scene, anchor, assumed, framing, setup, animations, time_s, has_ground, notes } = loaded;
        let (path, setup) = setup.unzip();
        self.state.open(&spec, &scene, Some(setup.unwrap_or(assumed)));
        self.state.anchor = anchor;
        self.unframed = framing;
        self.state.setup_file = path.map(|path| (path, self.state.setup.clone()));
        if let Some((path, _)) = &self.state.setup_file {
            self.panels.setup_path = path.display().to_string();
        }
        if has_ground {
            self.state.note_ground(&scene);
        }
        self.state.play = Play::at(animations.as_ref().map(|animations| animations.ends_s()), time_s);
        self.poser = animations.map(|animations| Poser::new(animations, has_ground, anchor, self.state.play.time_s));
        let generation = self.state.scene.as_ref().map_or(0, |open| open.generation);
        self.renderer.open(&scene, generation);
        ctx.send_viewport_cmd(egui::ViewportCommand::Title(format!("{spec} — antumbra")));
        match notes.first() {
            Some(first) => self.say(format!("{spec}: {first}{}", more(notes.len()))),
            None => self.say(""),
        }
        self.scene = Some(scene);
    }

    /// Shows an animated scene at the time that is wanted, once it is posed.
    fn pose(&mut self) {
        let (Some(poser), Some(scene)) = (&mut self.poser, &mut self.scene) else { return };
        match poser.take() {
            None => {}
            Some(Ok(mut posed)) => {
                // Whoever traces the scene holds it as it was.
                posed.images = match Arc::get_mut(scene) {
                    Some(own) => std::mem::take(&mut own.images),
                    None => scene.images.clone(),
                };
                let posed = Arc::new(posed);
                self.renderer.pose(scene, &posed);
                self.state.follow(scene, &posed);
                *scene = posed;
            }
            Some(Err(why)) => {
                self.state.play.is_playing = false;
                self.message = (why, true);
            }
        }
        poser.want(self.state.play.time_s, &self.wake);
    }

    /// Whether an animated scene is shown at another time than is wanted.
    fn is_posing(&self) -> bool {
        self.poser.as_ref().is_some_and(|poser| poser.is_behind(self.state.play.time_s))
    }

    fn take_setup(&mut self, path: PathBuf, in_world: Setup) {
        let setup = in_world.counted_from(self.state.anchor);
        self.state.take_setup(setup.clone());
        self.say(format!("camera and lights of {}", path.display()));
        self.panels.setup_path = path.display().to_string();
        self.state.setup_file = Some((path, setup));
    }

    fn finish(&mut self, ctx: &egui::Context, outcome: Result<(), String>) {
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(Ended::Done(outcome));
        self.screenshot = None;
        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
    }

    fn act(&mut self, ctx: &egui::Context, action: Action) {
        match action {
            Action::Open(spec) => {
                self.say(format!("loading {spec}"));
                self.loader.load(Wanted::plain(spec), self.wake.clone());
            }
            Action::Choose(purpose, name) => self.file_dialog.open(purpose, &name, self.wake.clone()),
            Action::Undo => {
                self.history.undo(&mut self.state);
            }
            Action::Redo => {
                self.history.redo(&mut self.state);
            }
            Action::OpenSetup(path) => match read_setup(&path) {
                Ok(setup) => self.take_setup(path, setup),
                Err(why) => self.complain(why),
            },
            Action::SaveSetup(path) => match write_setup(&path, &self.state.setup_in_world()) {
                Ok(()) => {
                    self.say(format!("camera and lights are in {}", path.display()));
                    self.state.setup_file = Some((path, self.state.setup.clone()));
                }
                Err(why) => self.complain(why),
            },
            Action::SavePicture(path) => match self.renderer.read_output() {
                Some(()) => self.saving = Some(path),
                None => self.complain("there is no picture yet; open a scene first"),
            },
            Action::CopyCommand => {
                if let Some(line) = command_line(&self.state, self.size_px) {
                    ctx.copy_text(line.clone());
                    let unsaved = !line.contains("setup.toml") || self.is_setup_saved();
                    let hint = if unsaved { "" } else { " — save the setup first" };
                    self.say(format!("copied: {line}{hint}"));
                }
            }
            Action::FrameAll => {
                if let Some(open) = &self.state.scene {
                    let aspect = self.size_px.x as f32 / self.size_px.y.max(1) as f32;
                    self.state.setup.camera.frame(open.bounds, aspect);
                }
            }
            Action::Expose => self.renderer.expose(),
        }
    }

    fn is_setup_saved(&self) -> bool {
        self.state.setup_file.as_ref().is_some_and(|(_, saved)| *saved == self.state.setup)
    }

    /// Writes the picture that was asked for, once it is back.
    fn save_picture(&mut self) {
        let Some(texels) = self.renderer.take_output() else { return };
        let Some(path) = self.saving.take() else { return };
        let UVec2 { x, y } = texels.size_px;
        let written = image::RgbaImage::from_raw(x, y, texels.bytes)
            .ok_or_else(|| "the picture came back in part".to_owned())
            .and_then(|image| write_png(&path, image));
        match written {
            Ok(()) => self.say(format!("the picture is in {}", path.display())),
            Err(why) => self.complain(why),
        }
    }

    /// Opens what was chosen in the system's dialog, or says that nothing was.
    fn take_chosen(&mut self, ctx: &egui::Context) {
        match self.file_dialog.take() {
            None => {}
            Some((Purpose::Open, Some(chosen))) => self.open_chosen(ctx, chosen),
            Some((Purpose::SaveSetup, Some(chosen))) => self.act(ctx, Action::SaveSetup(chosen.path)),
            Some((Purpose::SavePicture, Some(chosen))) => self.act(ctx, Action::SavePicture(chosen.path)),
            Some((_, None)) => self.say(if cfg!(target_arch = "wasm32") {
                "no file was chosen"
            } else {
                "no file was chosen; where no dialog opens this desktop has none: enter the path, or drop the file"
            }),
        }
    }

    fn open_chosen(&mut self, _ctx: &egui::Context, chosen: Chosen) {
        #[cfg(not(target_arch = "wasm32"))]
        self.act(_ctx, ui::action_for(&chosen.path.display().to_string()));
        #[cfg(target_arch = "wasm32")]
        self.loader.load_bytes(chosen.path.display().to_string(), chosen.bytes, self.wake.clone());
    }

    /// Opens what was dropped.
    fn take_dropped(&mut self, file: egui::DroppedFileHandle, _actions: &mut Vec<Action>) {
        #[cfg(not(target_arch = "wasm32"))]
        _actions.push(ui::action_for(&file.path().display().to_string()));
        #[cfg(target_arch = "wasm32")]
        self.loader.load_dropped(file, self.wake.clone());
    }

    /// Another technique for the left side, as from its list.
    #[cfg(target_arch = "wasm32")]
    pub fn choose(&mut self, kind: TechniqueKind) {
        self.state.sides[0].set_kind(kind);
        (self.wake)();
    }

    /// Moves the chosen light, metres in world space.
    #[cfg(target_arch = "wasm32")]
    pub fn move_light(&mut self, by_m: glam::Vec3) {
        crate::state::move_by(&mut self.state.setup.lights[self.state.light], by_m);
        (self.wake)();
    }

    /// The scene, the technique that draws, and the newest message, once nothing is left to do.
    #[cfg(target_arch = "wasm32")]
    pub fn settled(&self) -> Option<String> {
        let open = self.state.scene.as_ref().filter(|_| self.loader.pending().is_none())?;
        let drawn = self.renderer.sides[0].kind().filter(|kind| *kind == self.state.sides[0].kind())?;
        let is_still = !self.was_unfinished && self.texture.is_some();
        let problem = self.renderer.sides[0].problem().unwrap_or_default();
        is_still.then(|| format!("{} {drawn} {}{problem}", open.spec, self.message.0).trim().to_owned())
    }

    fn keys(&mut self, ctx: &egui::Context) -> Vec<Action> {
        if ctx.text_edit_focused() {
            return Vec::new();
        }
        let mut actions = Vec::new();
        ctx.input_mut(|input| {
            if input.consume_key(egui::Modifiers::COMMAND, egui::Key::O) {
                self.panels.open.is_open = true;
            }
            // The one with more keys first: consuming ignores a Shift that is not asked for.
            let (with_shift, command) = (egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Modifiers::COMMAND);
            if input.consume_key(with_shift, egui::Key::Z) || input.consume_key(command, egui::Key::Y) {
                actions.push(Action::Redo);
            }
            if input.consume_key(command, egui::Key::Z) {
                actions.push(Action::Undo);
            }
            if input.consume_key(egui::Modifiers::NONE, egui::Key::F) {
                actions.push(Action::FrameAll);
            }
            if input.consume_key(egui::Modifiers::NONE, egui::Key::Space) && self.state.play.ends_s.is_some() {
                self.state.play.is_playing = !self.state.play.is_playing;
            }
            if input.consume_key(egui::Modifiers::NONE, egui::Key::B) {
                self.state.add_bookmark();
            }
            for (index, key) in BOOKMARK_KEYS.into_iter().enumerate() {
                if input.consume_key(egui::Modifiers::NONE, key) {
                    self.state.go_to_bookmark(index);
                }
            }
            if input.consume_key(egui::Modifiers::NONE, egui::Key::I) {
                self.panels.is_inspecting = !self.panels.is_inspecting;
            }
            if input.consume_key(egui::Modifiers::NONE, egui::Key::P) {
                self.panels.is_side_shown = !self.panels.is_side_shown;
            }
        });
        actions
    }

    /// Draws the state at the size of what is left of the window.
    fn draw(&mut self, ui: &egui::Ui) {
        let points = ui.available_size();
        let pixels = points * ui.ctx().pixels_per_point();
        let largest = self.render_state.device.limits().max_texture_dimension_2d;
        let size_px =
            UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32).clamp(UVec2::ONE, UVec2::splat(largest));
        self.size_px = size_px;
        if let Some(framing) = self.unframed.take() {
            let camera = framing.camera(size_px.x as f32 / size_px.y as f32);
            self.state.setup.camera = camera.counted_from(self.state.anchor);
        }
        self.ask_for_truth();
        let estimate = self.truth.estimate();
        self.renderer.inspect(self.asked_px);
        let drawn = self.renderer.draw(&self.state, size_px, estimate);
        self.take_output();
        if let Some(error) = self.renderer.take_error() {
            self.complain(format!("the graphics device reports: {error}"));
        }
        self.read_masks();
        self.save_picture();
        self.advance_screenshot(ui.ctx(), drawn.is_unfinished || self.is_posing());
        // Panels were laid out before this frame was drawn: once more after the last, so that they tell of it.
        let was_unfinished = std::mem::replace(&mut self.was_unfinished, drawn.is_unfinished);
        if self.state.is_moving() {
            ui.ctx().request_repaint();
        } else if drawn.is_unfinished || was_unfinished || self.screenshot.is_some() {
            ui.ctx().request_repaint_after(SOON);
        }
    }

    /// The picture, and what is said over it.
    fn show_picture(&mut self, ui: &mut egui::Ui) {
        let texture = self.texture.as_ref().map(|(_, id)| *id);
        let map_line = |side: usize| {
            let side = &self.renderer.sides[side];
            match self.state.show {
                Show::LightMap => side.map_line(self.state.light, self.state.level, self.state.layer),
                Show::Lists => side.lists_line(self.state.light, self.state.level),
                _ => None,
            }
        };
        let map_lines = [map_line(0), map_line(1)];
        let pointer = ui::show_picture(ui, &mut self.state, texture, map_lines).filter(|_| self.panels.is_inspecting);
        let pixel = |unit: glam::Vec2| (unit * self.size_px.as_vec2()).as_uvec2().min(self.size_px - 1);
        let asked = pointer.map(|pointer| pixel(pointer.unit));
        if asked != self.asked_px {
            // The next frame reads it.
            ui.ctx().request_repaint();
        }
        self.asked_px = asked;
        if let (Some(pointer), Some(inspected)) = (pointer, self.renderer.inspected()) {
            let place = (inspected.pixel.y * self.size_px.x + inspected.pixel.x) as usize;
            let truth = self.truth.estimate().filter(|estimate| estimate.size_px == self.size_px);
            let truth = truth.and_then(|estimate| estimate.values.get(place).copied());
            ui::inspector(ui.ctx(), &self.state, pointer.place, &inspected, truth);
        }
    }

    /// Gives egui the renderer's output, where that is another texture than before.
    fn take_output(&mut self) {
        let Some(view) = self.renderer.output() else { return };
        if self.texture.as_ref().is_some_and(|(held, _)| held == view) {
            return;
        }
        let mut egui_renderer = self.render_state.renderer.write();
        if let Some((_, old)) = self.texture.take() {
            egui_renderer.free_texture(&old);
        }
        let device = &self.render_state.device;
        let id = egui_renderer.register_native_texture(device, view, wgpu::FilterMode::Linear);
        self.texture = Some((view.clone(), id));
    }

    fn wants_truth(&self) -> bool {
        self.state.show.needs_truth() || self.panels.is_inspecting
    }

    /// Rays are traced while they are shown and nothing moves.
    fn ask_for_truth(&mut self) {
        let scene = self.scene.as_ref().filter(|_| self.wants_truth() && !self.state.is_moving() && !self.is_posing());
        let job = scene.map(|scene| Job {
            scene: scene.clone(),
            camera: self.state.setup.camera,
            size_px: self.size_px,
            light: self.state.setup.lights[self.state.light].clone(),
        });
        self.truth.want(job);
        if let Some(problem) = self.truth.problem.take() {
            self.complain(problem);
        }
    }

    /// Reads the masks that are held against the truth, once for each that is drawn.
    fn read_masks(&mut self) {
        if !self.state.show.needs_truth() {
            self.masks = [None, None];
            return;
        }
        for (side, mask) in self.masks.iter_mut().enumerate() {
            if let Some(read) = self.renderer.take_mask(side, self.state.light) {
                *mask = Some(read);
            }
        }
        let version = self.renderer.version();
        let shown = self.state.shown_sides().len();
        let is_stale = self.masks[..shown].iter().any(|mask| mask.as_ref().is_none_or(|(read, _)| *read != version));
        let is_reading = self.renderer.sides.iter().any(|side| side.mask_reader.is_waiting());
        if is_stale && !is_reading && self.state.scene.is_some() {
            self.renderer.read_masks(&self.state);
        }
    }

    /// Writes the window's picture once nothing is left to do, and ends.
    fn advance_screenshot(&mut self, ctx: &egui::Context, is_unfinished: bool) {
        let points = self.truth.estimate().map_or(0, |estimate| estimate.points);
        let lacks_truth = self.state.show.needs_truth() && points < SCREENSHOT_POINTS;
        let is_busy = is_unfinished || self.scene.is_none() || lacks_truth;
        let Some(screenshot) = &mut self.screenshot else { return };
        screenshot.still_frames = if is_busy { 0 } else { screenshot.still_frames + 1 };
        let taken = screenshot.image.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(taken) = taken {
            let [x, y] = taken.size.map(|side| side as u32);
            let bytes = taken.pixels.iter().flat_map(egui::Color32::to_array).collect();
            let path = screenshot.path.clone();
            let written = image::RgbaImage::from_raw(x, y, bytes)
                .ok_or_else(|| "the window's picture came back in part".to_owned())
                .and_then(|image| write_png(&path, image));
            self.finish(ctx, written);
        } else if !screenshot.is_asked && screenshot.still_frames >= SCREENSHOT_STILL_FRAMES {
            screenshot.is_asked = true;
            let image = screenshot.image.clone();
            ctx.send_viewport_cmd(egui::ViewportCommand::Screenshot(egui::ScreenshotCallback::new(move |taken| {
                *image.lock().unwrap_or_else(PoisonError::into_inner) = Some(taken);
            })));
        }
    }
}

/// ` (and 2 more)`, or nothing.
fn more(count: usize) -> String {
    if count > 1 { format!(" (and {} more)", count - 1) } else { String::new() }
}

/// Writes an opaque PNG, whole or not at all.
fn write_png(path: &Path, image: image::RgbaImage) -> Result<(), String> {
    let opaque = image::DynamicImage::ImageRgba8(image).into_rgb8();
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    opaque.write_with_encoder(encoder).map_err(|error| one_line(&error.to_string()))?;
    write_whole(path, &bytes)
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
    /// One frame.
    fn show(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        if self.give_up_lost_device(&ctx) {
            return;
        }
        let seconds = self.last_frame.elapsed().as_secs_f32().min(0.1);
        self.last_frame = Instant::now();
        self.state.advance(seconds);
        self.take_loaded(&ctx);
        self.take_chosen(&ctx);
        self.pose();
        self.history.note(&self.state, ctx.input(|input| input.time));
        if ctx.cumulative_pass_nr() == 0 && ui.max_rect().width() < NARROW_WINDOW {
            self.panels.is_side_shown = false;
        }
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
        let (message, is_bad) = match self.loader.pending() {
            Some(spec) => (format!("loading {spec}"), false),
            None => self.message.clone(),
        };
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
