//! Background work: on a thread; in a browser, whose pages have a single thread, between two frames.

use std::sync::Arc;

/// Callback from any thread, called when there is something new to show.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Runs work on a thread of its own.
#[cfg(not(target_arch = "wasm32"))]
pub fn run_in_background(work: impl FnOnce() + Send + 'static) {
    std::thread::spawn(work);
}

/// Runs work after the browser has drawn the current frame.
#[cfg(target_arch = "wasm32")]
pub fn run_in_background(work: impl FnOnce() + 'static) {
    wasm_bindgen_futures::spawn_local(async {
        yield_to_browser().await;
        work();
    });
}

/// Yields to the browser, which draws and handles events.
#[cfg(target_arch = "wasm32")]
pub async fn yield_to_browser() {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        // A page without a window need not wait.
        if let Some(window) = web_sys::window() {
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, YIELD_MS);
        }
    });
    // The promise is never rejected.
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}

/// Duration of [`yield_to_browser`], milliseconds: long enough for a frame to be drawn.
#[cfg(target_arch = "wasm32")]
const YIELD_MS: i32 = 20;
