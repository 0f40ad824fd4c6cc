//! Masks of every technique on small scenes, for comparing devices: a browser's with the system's.
//!
//! The cases are the same on every device. Together they create every pipeline that a parameter can request: each technique
//! on opaque, alpha-tested and tinted casters, and with every choice and switch at its other values. All use the lowest
//! quality, because software devices draw them, too.

use antumbra::contract::{ParamSpec, ParamValue};
use antumbra::{Gpu, Quality, TechniqueKind};
use antumbra_scene::{LoadOptions, load};
use glam::UVec2;

use crate::device::device_descriptor;
use crate::message::one_line;
use crate::renderer::{Compile, Renderer};
use crate::state::{Show, Side, State};

/// Size of the masks, pixels; small because software devices are slow.
pub const SIZE_PX: UVec2 = UVec2::new(96, 64);

/// Maximum number of frames to wait for a mask. Each frame waits for the device.
const MAX_FRAMES: u32 = 3000;

/// A mask to draw: a technique, the scene's first light and the scene's own camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// A built-in scene.
    pub scene: &'static str,
    /// The technique and its parameters.
    pub side: Side,
}

impl Case {
    /// The case's name: scene, technique and settings, such as `overlap pcss filter=false`.
    pub fn name(&self) -> String {
        let scene = self.scene.trim_start_matches("builtin:");
        let settings = self.side.settings().into_iter().map(|(key, value)| format!(" {key}={value}"));
        format!("{scene} {}{}", self.side.kind(), settings.collect::<String>())
    }
}

/// Scenes with opaque, alpha-tested and tinted casters, of a few hundred triangles each.
const SCENES: [&str; 3] = ["builtin:overlap", "builtin:fence-alpha", "builtin:stained-glass"];

/// Returns all cases, grouped by scene.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for scene in SCENES {
        cases.extend(TechniqueKind::ALL.iter().map(|kind| Case { scene, side: quick(*kind) }));
    }
    for &kind in TechniqueKind::ALL {
        for (key, text) in turned(kind) {
            let mut side = quick(kind);
            side.set(key, &text);
            if (key, text.as_str()) == ("placement", "manual") {
                // `manual` needs distances from the light, metres; any between the scene's casters will do.
                side.set("split_depths", "2, 3, 4");
            }
            // Some settings are refused beside the defaults of others.
            if side.refusal(key).is_none() {
                cases.push(Case { scene: SCENES[0], side });
            }
        }
    }
    cases
}

/// Returns a technique at the lowest quality.
fn quick(kind: TechniqueKind) -> Side {
    let mut side = Side::new(kind);
    side.set_quality(Quality::Fast);
    side
}

/// Returns the choices and switches of a technique that differ from the lowest quality. Debug views are excluded, because
/// they are not masks.
fn turned(kind: TechniqueKind) -> Vec<(&'static str, String)> {
    let side = quick(kind);
    let other = |spec: &'static ParamSpec| match side.usual(spec) {
        ParamValue::Bool(is_on) => vec![(spec.key, (!is_on).to_string())],
        ParamValue::Choice(usual) if spec.key != "show" && spec.range.is_none() => {
            // Browsers support 1 and 4 samples per texel only.
            let is_everywhere = |choice: &&&str| spec.key != "msaa" || matches!(**choice, "1" | "4");
            let others = spec.choices.iter().filter(|choice| **choice != usual).filter(is_everywhere);
            others.map(|choice| (spec.key, (*choice).to_owned())).collect()
        }
        _ => Vec::new(),
    };
    kind.param_specs().iter().flat_map(other).collect()
}

/// Draws cases on a device of its own.
#[derive(Debug)]
pub struct Masks {
    gpu: Gpu,
    adapter: String,
    open: Option<(&'static str, Renderer, State)>,
}

impl Masks {
    /// Creates a device on the default adapter of the system or the browser.
    ///
    /// # Errors
    /// Fails with one line if there is no adapter or no device.
    pub async fn new() -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default()).await;
        let adapter = adapter.map_err(|error| one_line(&error.to_string()))?;
        let device = adapter.request_device(&device_descriptor(&adapter)).await;
        let (device, queue) = device.map_err(|error| one_line(&error.to_string()))?;
        let info = adapter.get_info();
        let adapter = format!("{} {} ({})", info.name, info.driver_info, info.backend);
        Ok(Self { gpu: Gpu::new(&device, &queue), adapter: one_line(&adapter), open: None })
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Draws the mask of a case: visibility by pixel, averaged over channels, [`SIZE_PX`] values. `rest` is awaited between
    /// frames and must let the device work.
    ///
    /// # Errors
    /// Fails with one line if the scene or the technique is unavailable, or the device reports an error.
    pub async fn draw(&mut self, case: &Case, rest: impl AsyncFn()) -> Result<Vec<f32>, String> {
        self.fit_scene(case)?;
        let Some((_, renderer, state)) = &mut self.open else { return Err("no scene is open".into()) };
        state.sides[0] = case.side.clone();
        let mut asked = None;
        for _ in 0..MAX_FRAMES {
            let drawn = renderer.draw(state, SIZE_PX, None);
            if let Some(why) = renderer.take_error() {
                return Err(why);
            }
            let is_there = renderer.sides[0].kind() == Some(case.side.kind()) && !drawn.is_unfinished;
            if let Some(why) = renderer.sides[0].problem().filter(|_| !drawn.is_unfinished) {
                return Err(why.to_owned());
            }
            // Only the last frame counts: an earlier one may lack feedback about visible receivers, or have overflowed.
            if asked == Some(renderer.version())
                && is_there
                && let Some((version, mask)) = renderer.take_mask(0, 0)
                && version == renderer.version()
            {
                return Ok(mask);
            }
            if is_there && asked != Some(renderer.version()) {
                asked = Some(renderer.version());
                renderer.read_masks(state);
            }
            rest().await;
        }
        Err("the image does not become still".into())
    }

    fn fit_scene(&mut self, case: &Case) -> Result<(), String> {
        if self.open.as_ref().is_some_and(|(scene, ..)| *scene == case.scene) {
            return Ok(());
        }
        let scene = load(case.scene, &LoadOptions::default()).map_err(|error| one_line(&error.to_string()))?;
        let mut state = State::new(case.side.kind(), TechniqueKind::Hard);
        state.open(case.scene, &scene, None);
        state.setup.lights.truncate(1);
        // *Shaded* would use ratio masks.
        state.show = Show::Visibility;
        let mut renderer = Renderer::new(&self.gpu, Compile::AtOnce);
        renderer.open(&scene, state.scene.as_ref().map_or(0, |open| open.generation));
        self.open = Some((case.scene, renderer, state));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_of_every_technique_and_differ() {
        let cases = cases();
        for kind in TechniqueKind::ALL {
            let own: Vec<_> = cases.iter().filter(|case| case.side.kind() == *kind).collect();
            assert!(SCENES.iter().all(|scene| own.iter().any(|case| case.scene == *scene)), "{kind}");
        }
        let mut names: Vec<_> = cases.iter().map(Case::name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), cases.len());
    }
}
