//! Functions and classes that JavaScript sees.

use antumbra::TechniqueKind;
use antumbra_scene::{LoadOptions, export_glb, load};
use antumbra_viewer::masks::{self, Case};
use antumbra_viewer::state::{Show, Side};
use antumbra_viewer::{ViewerOptions, web};
use glam::{UVec2, Vec3};
use wasm_bindgen::prelude::*;

/// What the viewer starts with where the address does not say.
const FIRST_TECHNIQUE: TechniqueKind = TechniqueKind::Smrt;

/// The viewer on a canvas.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Viewer {
    page: web::Page,
}

#[wasm_bindgen]
impl Viewer {
    /// Starts on a canvas with what the page's address asks for; a name that means nothing is an error, in one line.
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
                format!("there is no view `{name}`; there are {}", names.join(", "))
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

    /// Chooses the technique.
    pub fn choose(&self, technique: &str) -> Result<(), String> {
        self.page.choose(side_called(technique)?.kind());
        Ok(())
    }

    /// Moves the chosen light, metres in world space.
    #[wasm_bindgen(js_name = moveLight)]
    pub fn move_light(&self, x: f32, y: f32, z: f32) {
        self.page.move_light(Vec3::new(x, y, z));
    }

    /// Once the picture stands still: scene, technique and message.
    pub fn settled(&self) -> Option<String> {
        self.page.settled()
    }
}

fn side_called(name: &str) -> Result<Side, String> {
    Side::from_name(name).ok_or_else(|| {
        let names: Vec<_> = TechniqueKind::ALL.iter().map(|kind| kind.name()).collect();
        format!("there is no technique `{name}`; there are {}, each alone or as NAME:fast", names.join(", "))
    })
}

/// The names of all techniques.
#[wasm_bindgen(js_name = techniqueNames)]
pub fn technique_names() -> Vec<String> {
    TechniqueKind::ALL.iter().map(|kind| kind.name().to_owned()).collect()
}

/// A built-in scene as the bytes of a `.glb`.
#[wasm_bindgen(js_name = glbOf)]
pub fn glb_of(spec: &str) -> Result<Vec<u8>, String> {
    let scene = load(spec, &LoadOptions::default()).map_err(|error| error.to_string())?;
    export_glb(&scene).map_err(|error| error.to_string())
}

/// Masks of every technique, drawn beside the viewer on a device of their own.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Masks {
    masks: masks::Masks,
    cases: Vec<Case>,
}

#[wasm_bindgen]
impl Masks {
    /// Makes the device.
    pub async fn create() -> Result<Masks, String> {
        Ok(Self { masks: masks::Masks::new().await?, cases: masks::cases() })
    }

    /// How many there are.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> usize {
        self.cases.len()
    }

    /// The name of one.
    pub fn name(&self, index: usize) -> String {
        self.cases[index].name()
    }

    /// The adapter's name.
    #[wasm_bindgen(getter)]
    pub fn adapter(&self) -> String {
        self.masks.adapter().to_owned()
    }

    /// Draws one: visibility by pixel.
    pub async fn draw(&mut self, index: usize) -> Result<Vec<f32>, String> {
        let queue = self.masks.gpu().queue().clone();
        self.masks.draw(&self.cases[index], async || web::work_done(&queue).await).await
    }
}
