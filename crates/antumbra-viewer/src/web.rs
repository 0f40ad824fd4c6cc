//! The viewer in a web page: on a canvas, with the browser's WebGPU.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra::TechniqueKind;
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use wasm_bindgen::{JsCast, JsValue};

pub use crate::background::yield_to_browser;

use crate::app::{App, Outcome};
use crate::device::device_descriptor;
use crate::options::ViewerOptions;

/// The viewer on a canvas.
#[derive(Clone)]
pub struct Page {
    runner: eframe::WebRunner,
}

impl std::fmt::Debug for Page {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Page")
    }
}

impl Page {
    /// Starts the viewer on `canvas` and follows its size.
    ///
    /// # Errors
    /// Fails with one line if the browser gives no adapter or no device.
    pub async fn start(canvas: web_sys::HtmlCanvasElement, options: ViewerOptions) -> Result<Self, String> {
        let mut setup = WgpuSetupCreateNew::without_display_handle();
        setup.instance_descriptor.backends = wgpu::Backends::BROWSER_WEBGPU;
        setup.power_preference = wgpu::PowerPreference::HighPerformance;
        setup.device_descriptor = Arc::new(device_descriptor);
        let web_options = eframe::WebOptions {
            renderer: eframe::Renderer::Wgpu,
            wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..WgpuConfiguration::default() },
            ..eframe::WebOptions::default()
        };
        let create = Box::new(move |creation: &eframe::CreationContext<'_>| {
            let render_state = creation.wgpu_render_state.clone().ok_or("the canvas is not drawn by wgpu")?;
            let app = App::new(&creation.egui_ctx, render_state, options, Outcome::default());
            Ok(Box::new(app) as Box<dyn eframe::App>)
        });
        let runner = eframe::WebRunner::new();
        runner.start(canvas, web_options, create).await.map_err(|why| message_of(&why))?;
        Ok(Self { runner })
    }

    /// Chooses the technique of the left side.
    pub fn choose(&self, kind: TechniqueKind) {
        if let Some(mut app) = self.runner.app_mut::<App>() {
            app.choose(kind);
        }
    }

    /// Moves the selected light by a vector in world space, metres.
    pub fn move_light(&self, by_m: glam::Vec3) {
        if let Some(mut app) = self.runner.app_mut::<App>() {
            app.move_light(by_m);
        }
    }

    /// The status text: the scene, the technique drawn and the newest message; `None` while work is left.
    pub fn settled(&self) -> Option<String> {
        self.runner.app_mut::<App>().and_then(|app| app.settled())
    }
}

/// Yields to the browser until the device has completed all submitted work. Otherwise frames for a slow software device
/// would pile up by the thousand.
pub async fn work_done(queue: &wgpu::Queue) {
    let is_done = Arc::new(AtomicBool::new(false));
    let done = is_done.clone();
    queue.on_submitted_work_done(move || done.store(true, Ordering::Relaxed));
    yield_to_browser().await;
    while !is_done.load(Ordering::Relaxed) {
        yield_to_browser().await;
    }
}

/// Text of a JavaScript error.
fn message_of(error: &JsValue) -> String {
    let text = error.as_string().or_else(|| error.dyn_ref::<js_sys::Error>().map(|error| error.message().into()));
    text.unwrap_or_else(|| format!("{error:?}"))
}
