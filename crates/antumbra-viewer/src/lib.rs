//! See soft shadows move: a window on a scene, its lights and every technique.
//!
//! - [`state`] — what is shown and how; a command line or a setup file can say all of it. Knows no window and no GPU.
//! - [`camera`] — how a hand moves the camera.
//! - [`renderer`] — the picture of a state, drawn on whatever device it is given.
//! - [`truth`] — rays on other threads, while nothing moves.
//! - [`loader`] — scenes and setups from files.
//! - [`options`] — what the viewer starts with.
//!
//! These know no window. The window and its panels are around them, and [`run`] opens it.
#![forbid(unsafe_code)]

mod app;
pub mod camera;
pub mod loader;
pub mod options;
pub mod renderer;
pub mod state;
pub mod truth;
mod ui;
mod window;

pub use options::{ViewerError, ViewerOptions};
pub use window::{ADAPTER_VARIABLE, run};
