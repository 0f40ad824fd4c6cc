//! The window in which a scene is chosen: a path, or a built-in.

use antumbra_scene::builtin;

use super::Action;
use crate::loader::is_setup;

/// The window, shown or not.
#[derive(Debug, Default)]
pub struct OpenWindow {
    /// Whether it is shown.
    pub is_open: bool,
    path: String,
}

impl OpenWindow {
    /// The window; a scene that was chosen closes it.
    pub fn show(&mut self, ctx: &egui::Context) -> Option<Action> {
        let mut chosen = None;
        let mut is_open = self.is_open;
        egui::Window::new("Open a scene").open(&mut is_open).default_width(520.0).collapsible(false).show(ctx, |ui| {
            if cfg!(target_arch = "wasm32") {
                ui.label(
                    "Drop a .glb scene or a .toml setup on the picture: it is read here and sent nowhere. Or choose:",
                );
            } else {
                self.path(ui, &mut chosen);
            }
            ui.separator();
            egui::ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
                egui::Grid::new("built-in scenes").num_columns(2).striped(true).show(ui, |ui| {
                    for scene in builtin::NAMES {
                        if ui.button(scene.name).on_hover_text(scene.source).clicked() {
                            chosen = Some(Action::Open(format!("builtin:{}", scene.name)));
                        }
                        ui.label(scene.summary);
                        ui.end_row();
                    }
                });
            });
        });
        self.is_open = is_open && chosen.is_none();
        chosen
    }

    /// A path to enter.
    fn path(&mut self, ui: &mut egui::Ui, chosen: &mut Option<Action>) {
        ui.horizontal(|ui| {
            let hint = "path of a .glb or .gltf scene, or of a .toml setup";
            let edit = egui::TextEdit::singleline(&mut self.path).hint_text(hint).desired_width(400.0);
            let entered = ui.add(edit).lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let path = self.path.trim();
            if (ui.button("Open").clicked() || entered) && !path.is_empty() {
                *chosen = Some(action_for(path));
            }
        });
        ui.label("Or drop a file on the window.");
    }
}

/// What opening a file means, by its name.
pub fn action_for(path: &str) -> Action {
    if is_setup(path) { Action::OpenSetup(path.into()) } else { Action::Open(path.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setups_are_told_from_scenes() {
        assert_eq!(action_for("a/Evening.TOML"), Action::OpenSetup("a/Evening.TOML".into()));
        assert_eq!(action_for("a/scene.glb"), Action::Open("a/scene.glb".into()));
    }
}
