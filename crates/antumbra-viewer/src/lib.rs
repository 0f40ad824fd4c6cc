//! Interactive viewer of soft shadows: a window that shows a scene, its lights and every technique.
//!
//! - [`state`] — scene, lights, techniques and view; a command line or a setup file can express all of it. Needs no window and no GPU.
//! - [`camera`] — camera motions.
//! - [`renderer`] — draws the image of a state on any device.
//! - [`truth`] — ground truth traced in the background while nothing moves.
//! - [`masks`] — masks of every technique on small scenes, for comparing devices.
//! - `random_input` — the whole application under random input, without a window.
//! - [`loader`] — scenes and setups from files.
//! - [`options`] — start-up options.
//!
//! These modules need no window. The window and its panels use them: [`run`] opens it on a desktop, `web::Page` in a browser.
#![forbid(unsafe_code)]

mod app;
mod background;
pub mod camera;
mod device;
#[cfg(target_arch = "wasm32")]
mod download;
mod file_dialog;
pub mod loader;
pub mod masks;
mod message;
pub mod options;
mod poser;
pub mod renderer;
pub mod state;
mod thumbnails;
pub mod truth;
mod ui;
#[cfg(target_arch = "wasm32")]
pub mod web;
#[cfg(not(target_arch = "wasm32"))]
mod window;

#[cfg(not(target_arch = "wasm32"))]
pub use app::random_input;
pub use options::{ViewerError, ViewerOptions};
#[cfg(not(target_arch = "wasm32"))]
pub use window::{ADAPTER_VARIABLE, run};
