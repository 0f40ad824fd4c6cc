//! Start-up options of the viewer, and its errors.

use std::path::PathBuf;

use antumbra_scene::Ground;
use glam::UVec2;

use crate::state::{Show, Side};

/// Start-up options of the viewer.
#[derive(Clone, Debug)]
pub struct ViewerOptions {
    /// Name of the scene; `None` opens a built-in scene.
    pub scene: Option<String>,
    /// Camera and lights.
    pub setup: Option<PathBuf>,
    /// Initial time of an animated scene, seconds.
    pub time_s: f32,
    /// Whether a ground is added.
    pub ground: Ground,
    /// The technique.
    pub side: Side,
    /// Technique of the right side, to compare with; `None` shows one technique.
    pub against: Option<Side>,
    /// View that is shown.
    pub show: Show,
    /// The window's size, points.
    pub size: UVec2,
    /// Part of the adapter's name, driver or backend, ignoring case; `None` selects the fastest.
    pub adapter: Option<String>,
    /// File for a screenshot of the window; it is written once the window is idle, and then the viewer ends.
    pub screenshot: Option<PathBuf>,
}

/// Reason why the viewer cannot run.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// There is no display, or no adapter that can draw to it.
    #[error(
        "the window cannot be opened: {0}; the viewer needs a display and a graphics driver that can draw to it, but `antumbra \
         render` needs no display"
    )]
    Window(String),
    /// The device was lost, and its replacement was lost, too.
    #[error(
        "the graphics device was lost ({0}), again directly after it was recreated; try again, or choose another `--adapter`"
    )]
    Lost(String),
    /// The scene, the setup or a file is invalid.
    #[error("{0}")]
    Input(String),
}
