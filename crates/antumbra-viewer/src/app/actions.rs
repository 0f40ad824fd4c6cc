//! Actions that keys, panels and dialogs request.

use super::App;
use crate::loader::{SceneRequest, read_setup, write_setup};
use crate::state::command_line;
use crate::ui::Action;

/// Keys of the bookmarked views, in order.
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

impl App {
    pub(super) fn act(&mut self, ctx: &egui::Context, action: Action) {
        match action {
            Action::Open(spec) => {
                self.say(format!("loading {spec}"));
                self.loader.load(SceneRequest::plain(spec), self.wake.clone());
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
                    self.say(format!("saved camera and lights to {}", path.display()));
                    self.state.setup_file = Some((path, self.state.setup.clone()));
                }
                Err(why) => self.complain(why),
            },
            Action::SavePicture(path) => match self.renderer.read_output() {
                Some(()) => self.saving = Some(path),
                None => self.complain("there is no image yet; open a scene first"),
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

    pub(super) fn keys(&mut self, ctx: &egui::Context) -> Vec<Action> {
        if ctx.text_edit_focused() {
            return Vec::new();
        }
        let mut actions = Vec::new();
        ctx.input_mut(|input| {
            if input.consume_key(egui::Modifiers::COMMAND, egui::Key::O) {
                self.panels.open.is_open = true;
            }
            // The combination with more modifiers comes first, because `consume_key` ignores an extra Shift.
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
}
