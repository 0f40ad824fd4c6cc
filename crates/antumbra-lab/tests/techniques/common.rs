//! Shared helpers of this binary: the one device, and scenes with their ground truth.
//!
//! Without an adapter every test is skipped, or fails if one is required.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use antumbra::{Gpu, TechniqueKind};
use antumbra_lab::device::{DeviceError, DeviceOptions, LabDevice};
use antumbra_lab::metrics::{Metrics, compare_visibility};
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Silent;
use antumbra_lab::readback::read_buffer;
use antumbra_lab::technique_run::{TechniqueChoice, create};
use antumbra_lab::truth::{LightTruth, trace};
use antumbra_lab::view::View;
use antumbra_light::{Light, LightShape};
use antumbra_reference::VisibilityOptions;
use antumbra_scene::{Camera, LoadOptions, Scene, Setup, load};
use glam::{UVec2, Vec2, Vec3};

pub(crate) const SIZE: UVec2 = UVec2::new(256, 144);

pub(crate) fn lab() -> Option<&'static LabDevice> {
    static LAB: OnceLock<Option<LabDevice>> = OnceLock::new();
    let lab = LAB.get_or_init(|| {
        match LabDevice::new(&DeviceOptions { adapter: None, wanted_features: Gpu::WANTED_FEATURES }) {
            Ok(lab) => Some(lab),
            Err(DeviceError::NoAdapter) => None,
            Err(error) => panic!("{error}"),
        }
    });
    if lab.is_none() {
        antumbra_testing::skip_without_adapter();
    }
    lab.as_ref()
}

/// Maximum displacement of rasterised surfaces by vertex snapping, texels, as measured by the library.
pub(crate) fn snapped_texels(lab: &LabDevice) -> f32 {
    read_buffer(lab, lab.snapped_texels(), 1).expect("a device that works")[0]
}

/// A scene with its ground truth.
pub(crate) struct Judged {
    pub(crate) spec: String,
    pub(crate) scene: Scene,
    pub(crate) setup: Setup,
    pub(crate) truth: LightTruth,
    size_px: UVec2,
}

impl Judged {
    pub(crate) fn new(spec: &str, change: impl FnOnce(&mut Light)) -> Self {
        Self::of_size(SIZE, spec, change)
    }

    /// Uses a coarser ground truth of `samples` light samples, for tests that judge by something else.
    pub(crate) fn with_truth_of(spec: &str, samples: u32, change: impl FnOnce(&mut Light)) -> Self {
        Self::traced(SIZE, spec, &VisibilityOptions { samples, ..VisibilityOptions::default() }, change)
    }

    pub(crate) fn of_size(size_px: UVec2, spec: &str, change: impl FnOnce(&mut Light)) -> Self {
        Self::traced(size_px, spec, &VisibilityOptions::default(), change)
    }

    /// Uses another camera.
    pub(crate) fn seen_closely(spec: &str, change: impl FnOnce(&mut Camera)) -> Self {
        Self::set_up(SIZE, spec, &VisibilityOptions::default(), |setup| change(&mut setup.camera))
    }

    /// Uses another camera and a coarse ground truth.
    pub(crate) fn seen_from(spec: &str, change: impl FnOnce(&mut Camera)) -> Self {
        let options = VisibilityOptions { samples: 1, ..VisibilityOptions::default() };
        Self::set_up(SIZE, spec, &options, |setup| change(&mut setup.camera))
    }

    fn traced(size_px: UVec2, spec: &str, options: &VisibilityOptions, change: impl FnOnce(&mut Light)) -> Self {
        Self::set_up(size_px, spec, options, |setup| change(&mut setup.lights[0]))
    }

    /// Uses a modified setup and a ground truth of `samples` light samples.
    pub(crate) fn arranged(size_px: UVec2, spec: &str, samples: u32, change: impl FnOnce(&mut Setup)) -> Self {
        Self::set_up(size_px, spec, &VisibilityOptions { samples, ..VisibilityOptions::default() }, change)
    }

    pub(crate) fn set_up(
        size_px: UVec2,
        spec: &str,
        options: &VisibilityOptions,
        change: impl FnOnce(&mut Setup),
    ) -> Self {
        let scene = load(spec, &LoadOptions::default()).expect("a built-in scene");
        let mut setup = Setup::for_scene(&scene);
        change(&mut setup);
        let truth =
            trace(&scene, &setup, size_px, options, &Silent).expect("built-in scenes can be traced").swap_remove(0);
        Self { spec: spec.into(), scene, setup, truth, size_px }
    }

    /// Draws the mask of a technique.
    pub(crate) fn run(&self, lab: &LabDevice, kind: TechniqueKind, settings: &[(&str, &str)]) -> Visibility {
        let settings = settings.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        let mut technique = create(&lab.gpu(), &TechniqueChoice::with_settings(kind, settings)).expect("good settings");
        let view = View::new(lab, &self.scene, &self.setup, self.size_px).expect("built-in scenes can be seen");
        view.draw(&mut technique, 0, 1).expect("built-in scenes can be run").visibility
    }

    pub(crate) fn metrics(&self, visibility: &Visibility) -> Metrics {
        compare_visibility(&self.truth.visibility, visibility, &self.truth.judged).expect("images of one size")
    }
}

/// Path of a scene that is not part of the repository, in the folder that `ANTUMBRA_SCENES` names, or else beside the
/// checkout. `None` and a message if it is missing.
pub(crate) fn scene_file(name: &str) -> Option<String> {
    file_in(&antumbra_testing::scenes_folder()?, name)
}

fn file_in(folder: &Path, name: &str) -> Option<String> {
    let path = folder.join(name);
    if !path.is_file() {
        antumbra_testing::skip(format_args!("there is no {name}"));
        return None;
    }
    Some(path.display().to_string())
}

/// Path of a small scene that once failed, in the folder of cases, with the setup of the same name or else the shared
/// `card.toml`. `None` and a message if it is missing.
pub(crate) fn case_file(name: &str) -> Option<(String, Setup)> {
    let scene = file_in(&antumbra_testing::cases_folder()?, &format!("{name}.glb"))?;
    let own = PathBuf::from(&scene).with_extension("toml");
    let setup = if own.is_file() { own } else { own.with_file_name("card.toml") };
    Some((scene, Setup::from_file(&setup).expect("a good setup")))
}

/// A case with its ground truth.
pub(crate) fn case(name: &str, size_px: UVec2) -> Option<Judged> {
    let (scene, setup) = case_file(name)?;
    Some(Judged::set_up(size_px, &scene, &VisibilityOptions::default(), |own| *own = setup))
}

/// Setup for a file without camera or lights, independent of the default view: a three-quarter view of the scene's bounding
/// sphere, and a square light above it.
pub(crate) fn seen_from_outside(scene: &Scene) -> Setup {
    let bounds = scene.bounds();
    let (center, radius) = (bounds.center(), 0.5 * bounds.diagonal());
    let fov_y_rad = 45f32.to_radians();
    let distance = 1.05 * radius / (0.5 * fov_y_rad).sin();
    let camera = Camera {
        eye: center + distance * Vec3::new(0.55, 0.45, 1.0).normalize(),
        target: center,
        up: Vec3::Y,
        fov_y_rad,
        near_m: 0.01 * distance,
        far_m: 2.0 * (distance + radius),
        shadow_distance: None,
    };
    let place = center + 1.8 * radius * Vec3::new(-0.55, 1.0, 0.4).normalize();
    let light = || Light::new(LightShape::Rectangle { size_m: Vec2::splat(radius / 6.0) }, place, center);
    Setup {
        camera: scene.cameras.first().copied().unwrap_or(camera),
        lights: if scene.lights.is_empty() { vec![light()] } else { scene.lights.clone() },
    }
}

/// Mean over some pixels; panics if there are none, because such a mean would pass any bound.
pub(crate) fn mean_at(visibility: &Visibility, pixels: &[usize]) -> f64 {
    assert!(!pixels.is_empty(), "a mean of no pixels");
    let sum: f64 = pixels.iter().map(|i| f64::from(visibility.at(*i, 0))).sum();
    sum / pixels.len() as f64
}
