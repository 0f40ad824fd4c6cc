//! The top bar, and the controls of the view.

use std::path::PathBuf;

use super::lights::TURN_RAD_S;
use super::{Action, Panels, decimals};
use crate::file_dialog::Purpose;
use crate::renderer::MapChoices;
use crate::state::{Show, State};

/// Width reserved for the bar's last two buttons, points.
const LOOKS_WIDTH: f32 = 170.0;

/// Width of a slider with few values, points.
const CHOICE_WIDTH: f32 = 60.0;

/// Shows scene, view and their choices.
pub fn show(
    ui: &mut egui::Ui,
    state: &mut State,
    panels: &mut Panels,
    choices: MapChoices,
    [can_undo, can_redo]: [bool; 2],
) -> Vec<Action> {
    let mut actions = Vec::new();
    ui.horizontal_wrapped(|ui| {
        if ui.button("Open…").on_hover_text("Open a scene or a setup (Ctrl+O)").clicked() {
            panels.open.is_open = true;
        }
        ui.strong(state.scene.as_ref().map_or("no scene", |open| open.spec.as_str()));
        ui.separator();
        for (name, tip, is_possible, action) in [
            ("Undo", "Undo the last change of lights or techniques (Ctrl+Z)", can_undo, Action::Undo),
            ("Redo", "Redo the last undone change (Ctrl+Shift+Z or Ctrl+Y)", can_redo, Action::Redo),
        ] {
            if ui.add_enabled(is_possible, egui::Button::new(name)).on_hover_text(tip).clicked() {
                actions.push(action);
            }
        }
        ui.separator();
        what(ui, state, choices);
        ui.separator();
        ui.toggle_value(&mut state.is_split, "Compare")
            .on_hover_text("Show two techniques with a divider between them. Drag it to move it");
        ui.toggle_value(&mut panels.is_inspecting, "Inspect")
            .on_hover_text("Show the values of the pixel under the pointer (I)");
        ui.separator();
        if ui.button("Frame all").on_hover_text("Show the whole scene (F)").clicked() {
            actions.push(Action::FrameAll);
        }
        if ui.button("Copy command").on_hover_text("Copy a command line that renders this image").clicked() {
            actions.push(Action::CopyCommand);
        }
        // The buttons align right, or follow the others in a narrow window.
        if ui.available_size_before_wrap().x < LOOKS_WIDTH {
            looks(ui, panels);
        } else {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| looks(ui, panels));
        }
    });
    actions
}

/// Shows the selectors of what the picture shows, and of which map, level and layer.
fn what(ui: &mut egui::Ui, state: &mut State, choices: MapChoices) {
    for show in Show::ALL {
        ui.selectable_value(&mut state.show, show, show.name()).on_hover_text(match show {
            Show::Shaded => "The scene with all lights",
            Show::Visibility => "Visibility of the selected light: white is lit, black is umbra",
            Show::Error => "Visibility minus ray-traced visibility: red is too bright, blue is too dark",
            Show::Truth => "Ray-traced visibility, refined while nothing moves",
            Show::LightMap => "Shadow maps of the selected light: bright is near the light",
            Show::Lists => "Lengths of the lists of the selected light: yellow is longest",
        });
    }
    let of_levels = if state.show == Show::Lists {
        "Level of the lists: 1 is the finest; each further level is merged from a finer one"
    } else {
        "Level of the map: 1 is the map itself; the others are derived from it, the finest first"
    };
    let of_layers = "Depth layer of casters: 1 is the nearest to the light; the others are behind it";
    let of_points = "Map of one light sample, of the last batch";
    one_of(ui, "level", choices.levels, &mut state.level, of_levels);
    one_of(ui, "layer", choices.layers, &mut state.layer, of_layers);
    one_of(ui, "map", choices.points, &mut state.layer, of_points);
}

/// Shows a selector for one of `count` items, numbered from 1; nothing if there is no choice.
fn one_of(ui: &mut egui::Ui, name: &str, count: usize, chosen: &mut usize, tip: &str) {
    if count < 2 {
        return;
    }
    let mut shown = (*chosen).min(count - 1) + 1;
    // Two selectors must fit beside the views in a narrow window.
    ui.spacing_mut().slider_width = CHOICE_WIDTH;
    if ui.add(egui::Slider::new(&mut shown, 1..=count).text(name)).on_hover_text(tip).changed() {
        *chosen = shown - 1;
    }
}

/// Shows the buttons for the window's appearance.
fn looks(ui: &mut egui::Ui, panels: &mut Panels) {
    ui.toggle_value(&mut panels.is_side_shown, "Panel").on_hover_text("Show or hide the side panel (P)");
    let is_dark = ui.visuals().dark_mode;
    let other = if is_dark { "Light theme" } else { "Dark theme" };
    if ui.button(other).on_hover_text("Switch the colour theme of the window").clicked() {
        ui.ctx().set_theme(if is_dark { egui::Theme::Light } else { egui::Theme::Dark });
    }
}

/// Shows the controls of camera, exposure and files.
pub fn view(ui: &mut egui::Ui, state: &mut State, panels: &mut Panels) -> Vec<Action> {
    let mut actions = Vec::new();
    let camera = &mut state.setup.camera;
    let mut fov_degrees = camera.fov_y_rad.to_degrees();
    let slider = egui::Slider::new(&mut fov_degrees, 5.0..=120.0)
        .clamping(egui::SliderClamping::Edits)
        .suffix("°")
        .custom_formatter(decimals(1))
        .text("field of view");
    if ui.add(slider).changed() {
        camera.fov_y_rad = fov_degrees.to_radians();
    }
    let mut turns = state.camera_turn_rad_s != 0.0;
    if ui.checkbox(&mut turns, "Rotate around the target").changed() {
        state.camera_turn_rad_s = if turns { TURN_RAD_S } else { 0.0 };
    }
    ui.horizontal_wrapped(|ui| {
        if ui
            .button("Store this view")
            .on_hover_text("Store the camera (B). Return to it by its button or its digit")
            .clicked()
        {
            state.add_bookmark();
        }
        for index in 0..state.bookmarks.len() {
            if ui.button((index + 1).to_string()).clicked() {
                state.go_to_bookmark(index);
            }
        }
    });
    if ui.button("Expose for this view").on_hover_text("Adapt the exposure to the current view").clicked() {
        actions.push(Action::Expose);
    }
    let mut file = |ui: &mut egui::Ui, name, path: &mut String, purpose, action: fn(PathBuf) -> Action| {
        ui.horizontal(|ui| {
            ui.add(egui::TextEdit::singleline(path).desired_width(150.0));
            if ui.button(name).clicked() && !path.trim().is_empty() {
                actions.push(action(PathBuf::from(path.trim())));
            }
            // A browser has a folder for downloads, and opens files in the scene window.
            if !cfg!(target_arch = "wasm32")
                && ui.button("…").on_hover_text("Choose in the system's file dialog").clicked()
            {
                actions.push(Action::Choose(purpose, path.trim().to_owned()));
            }
        });
    };
    file(ui, "Save setup", &mut panels.setup_path, Purpose::SaveSetup, Action::SaveSetup);
    file(ui, "Open setup", &mut panels.setup_path, Purpose::Open, Action::OpenSetup);
    file(ui, "Save image", &mut panels.picture_path, Purpose::SavePicture, Action::SavePicture);
    actions
}
