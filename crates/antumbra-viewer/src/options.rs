//! What the viewer starts with, and why it may not start.

use std::path::PathBuf;

use antumbra_scene::Ground;
use glam::UVec2;

use crate::state::{Show, Side};

/// What the viewer starts with.
#[derive(Clone, Debug)]
pub struct ViewerOptions {
    /// A scene by its name; without one the first built-in that shows something of everything.
    pub scene: Option<String>,
    /// Camera and lights.
    pub setup: Option<PathBuf>,
    /// The time at which an animated scene is shown at first, seconds.
    pub time_s: f32,
    /// Whether the scene is put on a ground.
    pub ground: Ground,
    /// The technique.
    pub side: Side,
    /// Another, to compare with.
    pub against: Option<Side>,
    /// Which image is shown.
    pub show: Show,
    /// The window's size, points.
    pub size: UVec2,
    /// Part of the adapter's name, driver or backend, in any case; `None` takes the fastest.
    pub adapter: Option<String>,
    /// Writes a picture of the window here once it stands still, and ends.
    pub screenshot: Option<PathBuf>,
}

/// Why there is no viewer.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// There is no display, or no adapter that can draw to it.
    #[error(
        "the window cannot be opened: {0}; the viewer needs a display and a graphics driver that can draw to it; `antumbra render` needs no display"
    )]
    Window(String),
    /// The device was lost, and so was the next one.
    #[error(
        "the graphics device is lost ({0}), and was as soon as it was made anew; try again, or another `--adapter`"
    )]
    Lost(String),
    /// The scene, the setup or a file is wrong.
    #[error("{0}")]
    Input(String),
}
