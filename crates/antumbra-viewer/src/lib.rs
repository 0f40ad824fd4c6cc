//! See soft shadows move: a window on a scene, its lights and every technique.
//!
//! - [`state`] — what is shown and how; a command line or a setup file can say all of it. Knows no window and no GPU.
//! - [`camera`] — how a hand moves the camera.
//! - [`renderer`] — the picture of a state, drawn on whatever device it is given.
//! - [`truth`] — rays on other threads, while nothing moves.
//! - [`masks`] — what every technique draws of small scenes, to hold one device against another.
//! - `random_input` — the whole application under a hand that does anything, without a window.
//! - [`loader`] — scenes and setups from files.
//! - [`options`] — what the viewer starts with.
//!
//! These know no window. The window and its panels are around them: [`run`] opens it on a desktop, `web::Page` in a browser.
#![forbid(unsafe_code)]

mod app;
mod aside;
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
