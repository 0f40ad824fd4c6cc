//! The module behind the web page: the viewer on a canvas, and masks of every technique for the page's test.
//!
//! `cargo xtask web` builds it for browsers. On other targets the program only prints a hint.

#[cfg(target_arch = "wasm32")]
mod exports;

#[cfg(target_arch = "wasm32")]
fn main() {}

#[cfg(not(target_arch = "wasm32"))]
fn main() {
    println!(
        "This program runs in a browser: `cargo xtask web --serve` builds and serves the page; `antumbra view` opens a window."
    );
}
