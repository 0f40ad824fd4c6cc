//! Opening of scenes and setups that were loaded, chosen or dropped, and poses of animated scenes.

use std::path::PathBuf;
use std::sync::Arc;

use antumbra_scene::Setup;

use super::App;
use crate::file_dialog::{Chosen, Purpose};
use crate::loader::{Loaded, Opened};
use crate::poser::Poser;
use crate::state::Play;
#[cfg(not(target_arch = "wasm32"))]
use crate::ui;
use crate::ui::Action;

impl App {
    /// Opens a scene or setup that has finished loading, or reports its error.
    pub(super) fn take_loaded(&mut self, ctx: &egui::Context) {
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

    /// Shows an animated scene at the requested time, once its pose is computed.
    pub(super) fn pose(&mut self) {
        let (Some(poser), Some(scene)) = (&mut self.poser, &mut self.scene) else { return };
        match poser.take() {
            None => {}
            Some(Ok(mut posed)) => {
                // A tracer may hold the scene in its previous pose; its images cannot be moved then.
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

    /// Whether an animated scene shows another time than the requested one.
    pub(super) fn is_posing(&self) -> bool {
        self.poser.as_ref().is_some_and(|poser| poser.is_behind(self.state.play.time_s))
    }

    pub(super) fn take_setup(&mut self, path: PathBuf, in_world: Setup) {
        let setup = in_world.relative_to(self.state.anchor);
        self.state.take_setup(setup.clone());
        self.say(format!("opened camera and lights of {}", path.display()));
        self.panels.setup_path = path.display().to_string();
        self.state.setup_file = Some((path, setup));
    }

    /// Opens or saves the file chosen in the system's dialog, or reports that none was chosen.
    pub(super) fn take_chosen(&mut self, ctx: &egui::Context) {
        match self.file_dialog.take() {
            None => {}
            Some((Purpose::Open, Some(chosen))) => self.open_chosen(ctx, chosen),
            Some((Purpose::SaveSetup, Some(chosen))) => self.act(ctx, Action::SaveSetup(chosen.path)),
            Some((Purpose::SavePicture, Some(chosen))) => self.act(ctx, Action::SavePicture(chosen.path)),
            Some((_, None)) => self.say(if cfg!(target_arch = "wasm32") {
                "no file was chosen"
            } else {
                "no file was chosen; if no dialog opened, this desktop has none: enter the path, or drop the file on the window"
            }),
        }
    }

    fn open_chosen(&mut self, _ctx: &egui::Context, chosen: Chosen) {
        #[cfg(not(target_arch = "wasm32"))]
        self.act(_ctx, ui::action_for(&chosen.path.display().to_string()));
        #[cfg(target_arch = "wasm32")]
        self.loader.load_bytes(chosen.path.display().to_string(), chosen.bytes, self.wake.clone());
    }

    /// Opens a dropped file.
    pub(super) fn take_dropped(&mut self, file: egui::DroppedFileHandle, _actions: &mut Vec<Action>) {
        #[cfg(not(target_arch = "wasm32"))]
        _actions.push(ui::action_for(&file.path().display().to_string()));
        #[cfg(target_arch = "wasm32")]
        self.loader.load_dropped(file, self.wake.clone());
    }
}

/// ` (and 2 more)` for a count of 3; empty for a count of 1 or 0.
fn more(count: usize) -> String {
    if count > 1 { format!(" (and {} more)", count - 1) } else { String::new() }
}
