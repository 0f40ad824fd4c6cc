//! Work that the window need not wait for: on a thread; in a browser, whose pages have one, between two frames.

use std::sync::Arc;

/// Callback from any thread, called when there is something new to show.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Does work aside.
#[cfg(not(target_arch = "wasm32"))]
pub fn aside(work: impl FnOnce() + Send + 'static) {
    std::thread::spawn(work);
}

/// Does work aside: once the browser has drawn what there is.
#[cfg(target_arch = "wasm32")]
pub fn aside(work: impl FnOnce() + 'static) {
    wasm_bindgen_futures::spawn_local(async {
        breath().await;
        work();
    });
}

/// Lets the browser draw, and answer to what has come meanwhile.
#[cfg(target_arch = "wasm32")]
pub async fn breath() {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        // A page that has no window any more waits for nothing.
        if let Some(window) = web_sys::window() {
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, BREATH_MS);
        }
    });
    // It is never refused.
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}

/// Long enough for a frame to be drawn.
#[cfg(target_arch = "wasm32")]
const BREATH_MS: i32 = 20;
