//! Functions and classes exported to JavaScript.

use antumbra::TechniqueKind;
use antumbra_scene::{LoadOptions, export_glb, load};
use antumbra_viewer::masks::{self, Case};
use antumbra_viewer::state::{Show, Side};
use antumbra_viewer::{ViewerOptions, web};
use glam::{UVec2, Vec3};
use wasm_bindgen::prelude::*;

/// Default technique of the viewer.
const FIRST_TECHNIQUE: TechniqueKind = TechniqueKind::Smrt;

/// The viewer on a canvas.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Viewer {
    page: web::Page,
}

#[wasm_bindgen]
impl Viewer {
    /// Starts the viewer on a canvas with the values of the page's address. An unknown name is an error in one line.
    pub async fn start(
        canvas: web_sys::HtmlCanvasElement,
        scene: Option<String>,
        technique: Option<String>,
        against: Option<String>,
        show: Option<String>,
    ) -> Result<Viewer, String> {
        let side = |name: Option<String>| name.map(|name| side_called(&name)).transpose();
        let show = match show {
            Some(name) => Show::from_name(&name).ok_or_else(|| {
                let names: Vec<_> = Show::ALL.iter().map(|show| show.name()).collect();
                format!("there is no view `{name}`; available: {}", names.join(", "))
            })?,
            None => Show::default(),
        };
        let options = ViewerOptions {
            time_s: 0.0,
            ground: antumbra_scene::Ground::Auto,
            scene: scene.map(|name| if name.contains(':') { name } else { format!("builtin:{name}") }),
            setup: None,
            side: side(technique)?.unwrap_or_else(|| Side::new(FIRST_TECHNIQUE)),
            against: side(against)?,
            show,
            size: UVec2::ZERO,
            adapter: None,
            screenshot: None,
        };
        Ok(Self { page: web::Page::start(canvas, options).await? })
    }

    /// Chooses the technique of the left side.
    pub fn choose(&self, technique: &str) -> Result<(), String> {
        self.page.choose(side_called(technique)?.kind());
        Ok(())
    }

    /// Moves the selected light by a vector in world space, metres.
    #[wasm_bindgen(js_name = moveLight)]
    pub fn move_light(&self, x: f32, y: f32, z: f32) {
        self.page.move_light(Vec3::new(x, y, z));
    }

    /// Scene, technique and message; `None` until the image is complete.
    pub fn settled(&self) -> Option<String> {
        self.page.settled()
    }
}

fn side_called(name: &str) -> Result<Side, String> {
    Side::from_name(name).ok_or_else(|| {
        let names: Vec<_> = TechniqueKind::ALL.iter().map(|kind| kind.name()).collect();
        format!(
            "there is no technique `{name}`; available: {}, each optionally with a quality, such as NAME:fast",
            names.join(", ")
        )
    })
}

/// Names of all techniques.
#[wasm_bindgen(js_name = techniqueNames)]
pub fn technique_names() -> Vec<String> {
    TechniqueKind::ALL.iter().map(|kind| kind.name().to_owned()).collect()
}

/// Returns a built-in scene as the bytes of a `.glb` file.
#[wasm_bindgen(js_name = glbOf)]
pub fn glb_of(spec: &str) -> Result<Vec<u8>, String> {
    let scene = load(spec, &LoadOptions::default()).map_err(|error| error.to_string())?;
    export_glb(&scene).map_err(|error| error.to_string())
}

/// Masks of every technique, drawn on a device of their own.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Masks {
    masks: masks::Masks,
    cases: Vec<Case>,
}

#[wasm_bindgen]
impl Masks {
    /// Creates the device.
    pub async fn create() -> Result<Masks, String> {
        Ok(Self { masks: masks::Masks::new().await?, cases: masks::cases() })
    }

    /// Number of cases.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> usize {
        self.cases.len()
    }

    /// Name of a case.
    pub fn name(&self, index: usize) -> String {
        self.cases[index].name()
    }

    /// Name of the adapter.
    #[wasm_bindgen(getter)]
    pub fn adapter(&self) -> String {
        self.masks.adapter().to_owned()
    }

    /// Draws the mask of a case: visibility by pixel.
    pub async fn draw(&mut self, index: usize) -> Result<Vec<f32>, String> {
        let queue = self.masks.gpu().queue().clone();
        self.masks.draw(&self.cases[index], async || web::work_done(&queue).await).await
    }
}
