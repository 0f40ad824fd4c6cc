//! What the page calls: the viewer on a canvas, and, for the page's test, masks of every technique.
//!
//! `cargo xtask web` builds it for browsers. Elsewhere it only says so.

#[cfg(target_arch = "wasm32")]
mod exports;

#[cfg(target_arch = "wasm32")]
fn main() {}

#[cfg(not(target_arch = "wasm32"))]
fn main() {
    println!(
        "This program runs on a page: `cargo xtask web --serve` builds and serves it; `antumbra view` opens a window."
    );
}
