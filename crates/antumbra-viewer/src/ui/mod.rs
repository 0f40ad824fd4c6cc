//! What the window is made of. Each part reads and changes the state; what takes more than that is an [`Action`].

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

/// What the window asks for beyond a change of the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Open a scene by its name.
    Open(String),
    /// Choose in the system's dialog what to open, or where to save under this name.
    Choose(Purpose, String),
    /// Take camera and lights from a file.
    OpenSetup(PathBuf),
    /// Save camera and lights to a file.
    SaveSetup(PathBuf),
    /// Save the picture, without the window around it.
    SavePicture(PathBuf),
    /// Put the command line on the clipboard.
    CopyCommand,
    /// See all of the scene.
    FrameAll,
    /// Expose the lights to what is seen now.
    Expose,
    /// Take back the newest edit.
    Undo,
    /// Do again what was taken back last.
    Redo,
}

/// What panels keep between frames that is no part of the state.
#[derive(Debug)]
pub struct Panels {
    /// The window that opens scenes.
    pub open: OpenWindow,
    /// Where setups are saved to.
    pub setup_path: String,
    /// Where pictures are saved to.
    pub picture_path: String,
    /// Whether the panel at the side is shown.
    pub is_side_shown: bool,
    /// Whether the values under the pointer are shown.
    pub is_inspecting: bool,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            open: OpenWindow::default(),
            setup_path: "setup.toml".into(),
            picture_path: "picture.png".into(),
            is_side_shown: true,
            is_inspecting: false,
        }
    }
}

/// Beside a name and a number with its unit, in a panel as wide as it opens: else the panel would grow with its contents,
/// and the picture shrink.
const SLIDER_WIDTH: f32 = 84.0;

/// Writes a slider's number with so many digits behind the point at most. A slider with `max_decimals` of its own rounds the
/// number itself, as soon as it is shown.
fn decimals(most: usize) -> impl Fn(f64, std::ops::RangeInclusive<usize>) -> String {
    move |value, _| {
        let text = format!("{value:.most$}");
        if most == 0 { text } else { text.trim_end_matches('0').trim_end_matches('.').to_owned() }
    }
}

/// The bar at the top: what is open, what is shown, and how, where lists have so many levels; and whether there is something to undo and to
/// redo. Returns what was asked for.
pub fn top(
    ui: &mut egui::Ui,
    state: &mut State,
    panels: &mut Panels,
    choices: MapChoices,
    can_undo_and_redo: [bool; 2],
) -> Vec<Action> {
    toolbar::show(ui, state, panels, choices, can_undo_and_redo)
}

/// The panel at the side: techniques, lights, view, times.
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
