//! The window for choosing a scene: a path, or a built-in scene.

use antumbra_scene::builtin;

use super::Action;
use crate::background::Wake;
use crate::file_dialog::Purpose;
use crate::loader::is_setup;
use crate::thumbnails::{SIZE_PX, Thumbnails};

/// Whether thumbnails are shown; a page's single thread would be blocked by tracing.
const HAS_THUMBNAILS: bool = !cfg!(target_arch = "wasm32");

/// The window, open or closed.
#[derive(Debug, Default)]
pub struct OpenWindow {
    /// Whether the window is shown.
    pub is_open: bool,
    path: String,
    /// Thumbnails of the built-in scenes.
    thumbnails: Thumbnails,
}

impl OpenWindow {
    /// Shows the window. Choosing a scene closes it. `wake` is called when there is another thumbnail to show.
    pub fn show(&mut self, ctx: &egui::Context, wake: &Wake) -> Option<Action> {
        let mut chosen = None;
        let mut is_open = self.is_open;
        egui::Window::new("Open a scene").open(&mut is_open).default_width(620.0).collapsible(false).show(ctx, |ui| {
            if cfg!(target_arch = "wasm32") {
                if ui.button("Choose a file…").clicked() {
                    chosen = Some(Action::Choose(Purpose::Open, String::new()));
                }
                ui.label(
                    "Or drop a .glb scene or a .toml setup on the image. It is read in the browser and not uploaded. Or choose \
                     a built-in scene:",
                );
            } else {
                self.path(ui, &mut chosen);
            }
            ui.separator();
            egui::ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
                egui::Grid::new("built-in scenes").num_columns(3).striped(true).show(ui, |ui| {
                    for scene in builtin::NAMES {
                        if HAS_THUMBNAILS && self.thumbnail(ui, scene.name, wake).clicked() {
                            chosen = Some(Action::Open(format!("builtin:{}", scene.name)));
                        }
                        if ui.button(scene.name).on_hover_text(scene.source).clicked() {
                            chosen = Some(Action::Open(format!("builtin:{}", scene.name)));
                        }
                        ui.add(egui::Label::new(scene.summary).wrap());
                        ui.end_row();
                    }
                });
            });
        });
        self.is_open = is_open && chosen.is_none();
        chosen
    }

    /// Shows a scene's thumbnail, or a placeholder while it is traced.
    fn thumbnail(&mut self, ui: &mut egui::Ui, name: &'static str, wake: &Wake) -> egui::Response {
        let size = egui::vec2(SIZE_PX.x as f32, SIZE_PX.y as f32);
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click());
        // Thumbnails outside the visible area are not requested.
        if ui.is_rect_visible(rect) {
            match self.thumbnails.of(ui.ctx(), name, wake) {
                Some(texture) => egui::Image::new(texture).paint_at(ui, rect),
                None => {
                    ui.painter().rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
                }
            }
        }
        response
    }

    /// Shows an input for a path.
    fn path(&mut self, ui: &mut egui::Ui, chosen: &mut Option<Action>) {
        ui.horizontal(|ui| {
            let hint = "path of a .glb or .gltf scene, or of a .toml setup";
            let edit = egui::TextEdit::singleline(&mut self.path).hint_text(hint).desired_width(400.0);
            let entered = ui.add(edit).lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let path = self.path.trim();
            if (ui.button("Open").clicked() || entered) && !path.is_empty() {
                *chosen = Some(action_for(path));
            }
            if ui.button("Choose…").on_hover_text("Choose in the system's file dialog").clicked() {
                *chosen = Some(Action::Choose(Purpose::Open, String::new()));
            }
        });
        ui.label("Or drop a file on the window.");
    }
}

/// Action that opens a file, by the extension of its name.
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
