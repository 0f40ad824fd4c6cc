//! Running of exhibits' rows.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

use antumbra::TechniqueKind;
use antumbra_reference::{Tracer, VisibilityOptions};
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::UVec2;
use image::RgbImage;

use super::SCENES_VARIABLE;
use super::exhibit::{Measure, Row};
use super::form::{Form, choice_with};
use super::outcome::{Measured, Outcome};
use super::views::view_named;
use crate::color_maps::signed_error_map;
use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::limits::End;
use crate::metrics::compare_visibility;
use crate::motion::MotionTruth;
use crate::picture::Visibility;
use crate::progress::Silent;
use crate::technique_run::{Drawn, TechniqueChoice, TechniqueRun, Timing, Timings};
use crate::truth::{LightTruth, trace_lights_until};
use crate::view::View;

/// Options of runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Number of timed frames.
    pub frames: u32,
    /// Image size that replaces the paper's.
    pub size_px: Option<UVec2>,
    /// Light samples per pixel of the ground truth.
    pub samples: u32,
    /// Time after which no further frame of a row is started.
    pub at_most: Duration,
    /// Whether to run rows that take a software renderer too long.
    pub runs_slow: bool,
    /// Approximate maximum number of pixels of an image; larger images of the papers are reduced.
    pub max_pixels: Option<u32>,
}

impl RunOptions {
    /// Returns the papers' settings, whatever the run time.
    pub fn as_published(frames: u32) -> Self {
        let at_most = Duration::from_secs(20);
        Self { frames, size_px: None, samples: 1024, at_most, runs_slow: true, max_pixels: None }
    }

    /// Returns the papers' settings on a GPU. On a software renderer, images have about 256 × 144 pixels, which take minutes per paper,
    /// not hours. The truth's noise is below 0.002 rmse with 1024 samples, except in foliage, and twice that with 256.
    pub fn for_device(lab: &LabDevice, frames: u32) -> Self {
        let printed = Self::as_published(frames);
        if lab.adapter.is_software() {
            let (at_most, max_pixels) = (Duration::from_secs(2), Some(256 * 144));
            Self { samples: 256, at_most, runs_slow: false, max_pixels, ..printed }
        } else {
            printed
        }
    }

    /// Returns the timing without a limit for the technique.
    fn timing(&self) -> Timing {
        Timing { warm_up: 1, frames: self.frames, at_least: Duration::ZERO, at_most: self.at_most, end: None }
    }

    /// Returns the image size of a row: the paper's aspect ratio, and its size if allowed.
    pub fn size_of(&self, row: &Row) -> UVec2 {
        let (width, height) = row.size_px;
        if let Some(size_px) = self.size_px {
            return size_px;
        }
        let pixels = width * height;
        let shrink = self.max_pixels.map_or(1.0, |most| (f64::from(most) / f64::from(pixels)).sqrt().min(1.0));
        let side = |length: u32| ((f64::from(length) * shrink).round() as u32).max(1);
        UVec2::new(side(width), side(height))
    }
}

/// Images of a row.
#[derive(Debug)]
pub struct Pictures {
    /// Image shaded with the technique's mask, or a debug view.
    pub picture: RgbImage,
    /// Image shaded with the reference, if there is one.
    pub reference: Option<RgbImage>,
    /// Signed error, for measurements of one frame.
    pub error: Option<RgbImage>,
}

/// Result of a run.
#[derive(Debug)]
pub struct RunResult {
    /// Outcome of the row.
    pub outcome: Outcome,
    /// Images, if requested and available.
    pub pictures: Option<Pictures>,
    /// Time limit that cut the measurement short, seconds.
    pub cut_short_s: Option<f64>,
}

impl RunResult {
    fn without(outcome: Outcome) -> Self {
        Self { outcome, pictures: None, cut_short_s: None }
    }
}

/// Number of cached scenes; neighbouring rows share theirs.
const KEPT_SCENES: usize = 3;

/// State shared by rows: scenes and their ground truths.
#[derive(Debug)]
pub struct Bench<'a> {
    pub(super) lab: &'a LabDevice,
    pub(super) options: RunOptions,
    /// Scenes by name, most recently used last.
    scenes: Vec<(String, Rc<Loaded>)>,
    truths: HashMap<String, Rc<LightTruth>>,
    pub(super) motion_truths: HashMap<String, Rc<MotionTruth>>,
    /// End time of the current row.
    pub(super) end: Option<End>,
    /// Deadline of the run.
    pub(super) deadline: Option<Instant>,
}

#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) scene: Scene,
    uploaded: Rc<GpuScene>,
    tracer: OnceCell<Tracer>,
}

impl Loaded {
    fn tracer(&self) -> Result<&Tracer, LabError> {
        match self.tracer.get() {
            Some(tracer) => Ok(tracer),
            None => {
                let made = Tracer::new(&self.scene)?;
                Ok(self.tracer.get_or_init(|| made))
            }
        }
    }
}

impl<'a> Bench<'a> {
    /// Creates the state for runs on a device.
    pub fn new(lab: &'a LabDevice, options: RunOptions) -> Self {
        Self {
            lab,
            options,
            scenes: Vec::new(),
            truths: HashMap::new(),
            motion_truths: HashMap::new(),
            end: None,
            deadline: None,
        }
    }

    /// Sets the deadline after which ground truths are not traced further.
    pub(super) fn until(self, deadline: Option<Instant>) -> Self {
        Self { deadline, ..self }
    }

    /// Runs a row in one form, until `end` at most.
    ///
    /// # Errors
    /// If the scene cannot be loaded or traced, the device fails, or the run's deadline passes. Anything
    /// missing or unsupported is an outcome.
    pub fn run(&mut self, row: &Row, form: Form, with_pictures: bool, end: Option<End>) -> Result<RunResult, LabError> {
        self.end = end;
        if let Some(outcome) = self.why_not(row) {
            return Ok(RunResult::without(outcome));
        }
        let loaded = self.load(row.scene)?;
        let setup = setup_of(row, &loaded.scene)?;
        let size_px = self.options.size_of(row);
        let about = Measured {
            size_px: size_px.to_array(),
            triangles: loaded.uploaded.triangle_count as u64,
            ..Measured::default()
        };
        let view = View::of_uploaded(self.lab, &loaded.uploaded, &setup, size_px)?;
        if let Measure::SceneMs { .. } = row.measure {
            let (ms, count) = view.scene_ms(&self.timing())?;
            let (ms, count) = (Some(ms), Some(count));
            return Ok(RunResult::without(Outcome::Measured(Measured { ms, count, ..about })));
        }
        let site = Site { bench: self, row, form, loaded: &loaded, setup: &setup, view: &view };
        match site.run(about, with_pictures) {
            Err(error) if !error.is_deadline() => match error.why_skipped() {
                Some(why) => {
                    Ok(RunResult { cut_short_s: error.limit_s(), ..RunResult::without(Outcome::Skipped(why)) })
                }
                None => Err(error),
            },
            ran => ran,
        }
    }

    /// Returns the timing of the current row.
    fn timing(&self) -> Timing {
        Timing { end: self.end, ..self.options.timing() }
    }

    /// Returns the reason not to run a row, if any.
    fn why_not(&self, row: &Row) -> Option<Outcome> {
        if let Some(technique) = row.missing_technique() {
            return Some(Outcome::NotYet(technique.to_owned()));
        }
        if !row.is_ready() {
            return Some(Outcome::NotReady(row.scene.to_owned()));
        }
        (row.is_slow && !self.options.runs_slow && self.lab.adapter.is_software()).then_some(Outcome::TooSlow)
    }

    fn load(&mut self, scene: &str) -> Result<Rc<Loaded>, LabError> {
        if let Some(i) = self.scenes.iter().position(|(name, _)| name == scene) {
            let found = self.scenes.remove(i);
            self.scenes.push(found);
        } else {
            let folder = std::env::var_os(SCENES_VARIABLE);
            let spec = scene_spec(scene, folder.as_deref()).unwrap_or_else(|| scene.to_owned());
            let scene_data = load(&spec, &LoadOptions::default())?;
            let uploaded = Rc::new(GpuScene::upload(self.lab, &scene_data));
            let loaded = Loaded { scene: scene_data, uploaded, tracer: OnceCell::new() };
            if self.scenes.len() == KEPT_SCENES {
                self.scenes.remove(0);
            }
            self.scenes.push((scene.to_owned(), Rc::new(loaded)));
        }
        let (_, loaded) = self.scenes.last().expect("it was just put there");
        Ok(Rc::clone(loaded))
    }
}

impl Loaded {
    fn trace(
        &self,
        setup: &Setup,
        size_px: UVec2,
        samples: u32,
        deadline: Option<Instant>,
    ) -> Result<LightTruth, LabError> {
        let tracer = self.tracer()?;
        let receivers = tracer.primary(&setup.camera, size_px);
        let options = VisibilityOptions { samples, ..VisibilityOptions::default() };
        Ok(trace_lights_until(tracer, &receivers, &setup.lights, &options, deadline, &Silent)?.swap_remove(0))
    }
}

/// A row with its scene and view.
pub(super) struct Site<'a, 'b> {
    pub(super) bench: &'a mut Bench<'b>,
    pub(super) row: &'a Row,
    pub(super) form: Form,
    pub(super) loaded: &'a Loaded,
    pub(super) setup: &'a Setup,
    pub(super) view: &'a View<'a>,
}

impl Site<'_, '_> {
    fn run(mut self, about: Measured, with_pictures: bool) -> Result<RunResult, LabError> {
        let (row, view) = (self.row, self.view);
        let choice = row.choice(self.form)?;
        if let Measure::Motion(motion) = row.measure {
            return self.look_at_motion(motion, &choice, about, with_pictures);
        }
        let mut cut_short_s = None;
        let (drawn, mut measured) = if row.measure.is_timed() || row.is_timed_too {
            let run = self.time(&choice)?;
            cut_short_s = run.cut_short_s;
            let TechniqueRun { visibility, timings, memory_bytes, auto_map_sizes, .. } = run;
            let Some(ms) = time_of(&timings, row.measure)? else {
                return Ok(RunResult::without(Outcome::Skipped("the adapter does not time single passes".to_owned())));
            };
            (
                Drawn { visibility, memory_bytes, auto_map_sizes },
                Measured { ms: Some(ms), count: Some(timings.count()), ..about },
            )
        } else {
            (self.draw(&choice)?, about)
        };
        let Drawn { visibility, memory_bytes, .. } = drawn;
        measured.memory_bytes = Some(memory_bytes);
        if let Measure::Fps { .. } = row.measure {
            let (ms, count) = view.scene_ms(&self.bench.timing())?;
            (measured.scene_ms, measured.scene_count) = (Some(ms), Some(count));
        }
        let picture = match row.measure {
            _ if !with_pictures => None,
            Measure::Colors => Some(visibility.to_gray_levels()),
            _ => Some(view.shade(&[&visibility])?.to_srgb8()),
        };
        if !row.measure.is_error() {
            let pictures = picture.map(|picture| Pictures { picture, reference: None, error: None });
            return Ok(RunResult { outcome: Outcome::Measured(measured), pictures, cut_short_s });
        }
        let (reference, judged) = self.reference(&choice)?;
        let metrics = compare_visibility(&reference, &visibility, &judged)?;
        measured.flat_rmse = compare_visibility(&reference, &flat(&reference, &judged), &judged)?.rmse;
        (measured.rmse, measured.umbra_leak, measured.lit_loss) = (metrics.rmse, metrics.umbra_leak, metrics.lit_loss);
        measured.noise = metrics.roughness;
        measured.truth_samples = (row.measure == Measure::Error).then_some(self.bench.options.samples);
        let pictures = match picture {
            None => None,
            Some(picture) => {
                let error = Some(signed_error_map(&reference, &visibility, &judged));
                Some(Pictures { picture, reference: Some(view.shade(&[&reference])?.to_srgb8()), error })
            }
        };
        Ok(RunResult { outcome: Outcome::Measured(measured), pictures, cut_short_s })
    }

    /// Draws the mask, after the row's number of accumulated frames.
    fn draw(&self, choice: &TechniqueChoice) -> Result<Drawn, LabError> {
        self.view.draw_until(&mut self.view.create(choice)?, 0, self.row.frames, self.bench.end)
    }

    fn time(&self, choice: &TechniqueChoice) -> Result<TechniqueRun, LabError> {
        self.view.run(&mut self.view.create(choice)?, 0, &self.bench.timing())
    }

    /// Returns the reference of the row's image, and the judged pixels.
    fn reference(&mut self, choice: &TechniqueChoice) -> Result<(Visibility, Vec<bool>), LabError> {
        let other = match self.row.measure {
            Measure::FilteredError => {
                let why = || LabError::Request(format!("`{}` has no exact filtering to compare with", choice.name()));
                Some(choice.filtered_truth().ok_or_else(why)?)
            }
            Measure::Difference { from, settings } => Some(choice_with(from, self.form, settings)?),
            _ => None,
        };
        let Some(other) = other else {
            let truth = self.truth(self.bench.options.samples)?;
            return Ok((truth.visibility.clone(), truth.judged.clone()));
        };
        let drawn = self.draw(&other)?.visibility;
        // The tracer only determines which pixels are judged.
        Ok((drawn, self.truth(1)?.judged.clone()))
    }

    fn truth(&mut self, samples: u32) -> Result<Rc<LightTruth>, LabError> {
        let size_px = self.bench.options.size_of(self.row);
        let Row { scene, view, light_scale, .. } = self.row;
        let key = format!("{scene} {view:?} {light_scale} {size_px} {samples}");
        if let Some(truth) = self.bench.truths.get(&key) {
            return Ok(Rc::clone(truth));
        }
        // All techniques share a truth, so its time does not count for one of them.
        let deadline = self.bench.deadline;
        let mut truth = self.loaded.trace(self.setup, size_px, samples, deadline)?;
        truth.unjudge_mismatched_surfaces(&self.view.surface_points()?, self.setup.camera.eye);
        truth.first_hits = [].into();
        let truth = Rc::new(truth);
        self.bench.truths.insert(key, Rc::clone(&truth));
        Ok(truth)
    }
}

/// Returns the milliseconds of a row's passes; `None` if single passes are not timed.
fn time_of(timings: &Timings, measure: Measure) -> Result<Option<f64>, LabError> {
    let Measure::Ms { passes, .. } = measure else { return Ok(Some(timings.total_ms)) };
    if passes.is_empty() {
        return Ok(Some(timings.total_ms));
    }
    if timings.passes.is_empty() {
        return Ok(None);
    }
    let is_meant = |label: &str| passes.split('|').any(|part| label.contains(part));
    let meant: Vec<f64> = timings.passes.iter().filter(|pass| is_meant(&pass.label)).map(|pass| pass.ms).collect();
    if meant.is_empty() {
        let labels: Vec<&str> = timings.passes.iter().map(|pass| pass.label.as_str()).collect();
        return Err(LabError::Request(format!("there is no pass `{passes}`; available: {}", labels.join(", "))));
    }
    Ok(Some(meant.iter().sum()))
}

/// Returns a constant mask with the mean of the judged pixels.
fn flat(reference: &Visibility, judged: &[bool]) -> Visibility {
    let channels = reference.channel_count();
    let meant = || (0..judged.len()).filter(|i| judged[*i]);
    let count = (meant().count() * channels).max(1) as f32;
    let sum: f32 = meant()
        .flat_map(|i| (0..channels).map(move |channel| (i, channel)))
        .map(|(i, channel)| reference.at(i, channel))
        .sum();
    Visibility::one(reference.size_px, vec![sum / count; judged.len()])
}

/// Returns the camera and the single light of a row.
fn setup_of(row: &Row, scene: &Scene) -> Result<Setup, LabError> {
    let setup = match row.view {
        None => Setup::for_scene(scene),
        Some(name) => Setup::from_toml(view_named(name), Path::new(name))?,
    };
    let light = setup.lights[0].scaled(row.light_scale);
    Ok(Setup { camera: setup.camera, lights: vec![light] })
}

impl Row {
    /// Returns the technique that the library lacks for the row.
    pub fn missing_technique(&self) -> Option<&'static str> {
        let is_there = self.technique.is_empty() || TechniqueKind::from_name(self.technique).is_some();
        (!is_there).then_some(self.technique)
    }

    /// Returns whether the row's scene is available.
    pub fn is_ready(&self) -> bool {
        scene_spec(self.scene, std::env::var_os(SCENES_VARIABLE).as_deref()).is_some()
    }
}

/// Returns the scene to load: a built-in, or a file that exists in `folder`.
fn scene_spec(scene: &str, folder: Option<&OsStr>) -> Option<String> {
    if scene.starts_with("builtin:") {
        return Some(scene.to_owned());
    }
    let file = PathBuf::from(folder?).join(scene);
    file.is_file().then(|| file.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::super::exhibit::{error, scene_ms};
    use super::*;

    #[test]
    fn a_row_without_its_scene_is_not_ready() {
        let folder = tempfile::tempdir().unwrap();
        let named = Some(folder.path().as_os_str());
        assert_eq!(scene_spec("hall.glb", None), None);
        assert_eq!(scene_spec("hall.glb", named), None);
        std::fs::write(folder.path().join("hall.glb"), "").unwrap();
        assert_eq!(scene_spec("hall.glb", named), Some(folder.path().join("hall.glb").display().to_string()));
        assert_eq!(scene_spec("builtin:overlap", None).as_deref(), Some("builtin:overlap"));
        assert!(!error("", "no-such-hall.glb", "pcss").is_ready());
        let row = error("", "builtin:overlap", "no-such-technique");
        assert_eq!(row.missing_technique(), Some("no-such-technique"));
        assert_eq!(scene_ms("", "builtin:overlap", 1.0).missing_technique(), None);
    }

    #[test]
    fn pictures_keep_the_papers_shape() {
        let options = RunOptions { max_pixels: Some(256 * 144), ..RunOptions::as_published(1) };
        let row = error("", "builtin:overlap", "pcss");
        assert_eq!(options.size_of(&row.at(1280, 720)), UVec2::new(256, 144));
        assert_eq!(options.size_of(&row.at(512, 512)), UVec2::splat(192));
        assert_eq!(options.size_of(&row.at(64, 32)), UVec2::new(64, 32));
        assert_eq!(RunOptions { max_pixels: None, ..options }.size_of(&row.at(512, 512)), UVec2::splat(512));
        assert_eq!(RunOptions { size_px: Some(UVec2::ONE), ..options }.size_of(&row), UVec2::ONE);
    }

    #[test]
    fn a_flat_mask_has_the_mean_of_what_is_judged() {
        let reference = Visibility::one(UVec2::new(3, 1), vec![0.0, 1.0, 7.0]);
        assert_eq!(flat(&reference, &[true, true, false]).at(2, 0), 0.5);
    }
}
