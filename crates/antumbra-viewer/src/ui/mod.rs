//! Panels of the window. Each reads and changes the state; all else is requested as an [`Action`].

mod beam;
mod inspector;
mod lights;
mod open;
mod picture;
mod readings;
mod technique;
mod timeline;
mod toolbar;

use std::path::PathBuf;

pub use inspector::show as inspector;
pub use open::OpenWindow;
#[cfg(not(target_arch = "wasm32"))]
pub use open::action_for;
pub use picture::show as show_picture;
pub use readings::{Readings, status_bar};
pub use timeline::show as timeline;

use crate::file_dialog::Purpose;
use crate::renderer::MapChoices;
use crate::state::State;

/// A request from the window beyond a change of the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Open a scene by its name.
    Open(String),
    /// Choose a file to open, or to save under this name, in the system's dialog.
    Choose(Purpose, String),
    /// Load camera and lights from a file.
    OpenSetup(PathBuf),
    /// Save camera and lights to a file.
    SaveSetup(PathBuf),
    /// Save the image without the window.
    SavePicture(PathBuf),
    /// Copy the command line to the clipboard.
    CopyCommand,
    /// Frame the whole scene.
    FrameAll,
    /// Recompute the exposure from the visible surfaces.
    Expose,
    /// Undo the newest edit.
    Undo,
    /// Redo the edit that was undone last.
    Redo,
}

/// State of the panels that persists between frames and is not part of the viewer's state.
#[derive(Debug)]
pub struct Panels {
    /// The window that opens scenes.
    pub open: OpenWindow,
    /// Path for saving setups.
    pub setup_path: String,
    /// Path for saving images.
    pub picture_path: String,
    /// Whether the side panel is shown.
    pub is_side_shown: bool,
    /// Whether the values under the pointer are shown.
    pub is_inspecting: bool,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            open: OpenWindow::default(),
            setup_path: "setup.toml".into(),
            picture_path: "image.png".into(),
            is_side_shown: true,
            is_inspecting: false,
        }
    }
}

/// Width of a slider, points. With name, number and unit it fits the panel's initial width; otherwise the panel would grow
/// and the image shrink.
const SLIDER_WIDTH: f32 = 84.0;

/// Formats a slider's number with at most `most` decimals. A slider's own `max_decimals` would round the value itself when it is shown.
fn decimals(most: usize) -> impl Fn(f64, std::ops::RangeInclusive<usize>) -> String {
    move |value, _| {
        let text = format!("{value:.most$}");
        if most == 0 { text } else { text.trim_end_matches('0').trim_end_matches('.').to_owned() }
    }
}

/// Shows the top bar: scene, view, choices of levels and layers, undo and redo. Returns the requested actions.
pub fn top(
    ui: &mut egui::Ui,
    state: &mut State,
    panels: &mut Panels,
    choices: MapChoices,
    can_undo_and_redo: [bool; 2],
) -> Vec<Action> {
    toolbar::show(ui, state, panels, choices, can_undo_and_redo)
}

/// Shows the side panel: techniques, lights, view, times.
pub fn side(ui: &mut egui::Ui, state: &mut State, panels: &mut Panels, readings: &Readings<'_>) -> Vec<Action> {
    let mut actions = Vec::new();
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let sides = if state.is_split { 2 } else { 1 };
        for index in 0..sides {
            let title = match (state.is_split, index) {
                (false, _) => "Technique",
                (true, 0) => "Left",
                (true, _) => "Right",
            };
            egui::CollapsingHeader::new(title).id_salt(("side", index)).default_open(true).show(ui, |ui| {
                technique::show(ui, &mut state.sides[index], &readings.sides[index], readings.features);
            });
        }
        egui::CollapsingHeader::new("Lights").default_open(true).show(ui, |ui| lights::show(ui, state));
        egui::CollapsingHeader::new("View").default_open(false).show(ui, |ui| {
            actions.extend(toolbar::view(ui, state, panels));
        });
        egui::CollapsingHeader::new("Times").default_open(true).show(ui, |ui| readings::show(ui, state, readings));
    });
    actions
}
