//! Measurement of one configuration on every view, at one of several sizes: error, time and memory.

use std::cell::{Cell, OnceCell};
use std::rc::Rc;
use std::time::{Duration, Instant};

use antumbra_reference::{Receivers, Tracer, VisibilityOptions};
use glam::UVec2;

use super::space::Config;
use super::store::Measured;
use super::{AdviseRequest, AdviseView};
use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::metrics::visibility_errors;
use crate::picture::Visibility;
use crate::progress::Progress;
use crate::scene_facts::SceneFacts;
use crate::store::fingerprint;
use crate::technique_run::{FrameCount, Timing, create};
use crate::truth::{LightTruth, trace_lights};
use crate::view::View;

/// Size of a measurement: fraction of the image's side (1 / `part`), maximum light samples of the ground truth, number of timed frames.
#[derive(Clone, Copy, Debug)]
struct MeasurementSize {
    part: u32,
    samples: u32,
    frames: u32,
}

/// Sizes from small and coarse to the requested one.
const MEASUREMENT_SIZES: [MeasurementSize; 3] = [
    MeasurementSize { part: 4, samples: 64, frames: 1 },
    MeasurementSize { part: 2, samples: 256, frames: 2 },
    MeasurementSize { part: 1, samples: u32::MAX, frames: 3 },
];

/// Index of the last entry: the requested size.
pub(super) const FULL: usize = MEASUREMENT_SIZES.len() - 1;

/// Time after which no further frame is timed. Scheduling noise is milliseconds: it matters for frames of a few
/// milliseconds, not for frames of a hundred.
const LONG_ENOUGH: Duration = Duration::from_millis(150);

/// Multiple of the budget after which no further frame of a configuration is started.
const MAX_BUDGETS: f64 = 5.0;

/// Minimum width and height of an image, pixels.
const MIN_SIDE_PX: u32 = 24;

/// A view with its ground truth, ready for techniques.
struct Scene<'a> {
    view: View<'a>,
    truth: LightTruth,
    receivers: Receivers,
}

/// Every view at every size, created on first use.
pub(super) struct Bench<'a> {
    lab: &'a LabDevice,
    pub(super) request: &'a AdviseRequest<'a>,
    progress: &'a dyn Progress,
    uploaded: Vec<Rc<GpuScene>>,
    tracers: Vec<Tracer>,
    scenes_by_size: [OnceCell<Vec<Scene<'a>>>; MEASUREMENT_SIZES.len()],
    /// Largest budget of all views, milliseconds; infinite until it is known. It bounds the time spent on a slow configuration.
    pub(super) max_ms: Cell<f64>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(
        lab: &'a LabDevice,
        request: &'a AdviseRequest<'a>,
        progress: &'a dyn Progress,
    ) -> Result<Self, LabError> {
        progress.begin("building acceleration structures", 0);
        let uploaded = request.scenes.iter().map(|scene| Rc::new(GpuScene::upload(lab, scene))).collect();
        let tracers = request.scenes.iter().map(Tracer::new).collect::<Result<_, _>>()?;
        progress.end();
        let max_ms = Cell::new(f64::INFINITY);
        Ok(Self { lab, request, progress, uploaded, tracers, scenes_by_size: Default::default(), max_ms })
    }

    /// Returns the image size of an entry of [`MEASUREMENT_SIZES`], pixels.
    pub(super) fn size_px(&self, size_index: usize) -> UVec2 {
        let full = self.request.size_px;
        (full / MEASUREMENT_SIZES[size_index].part).max(UVec2::splat(MIN_SIDE_PX)).min(full)
    }

    fn samples(&self, size_index: usize) -> u32 {
        MEASUREMENT_SIZES[size_index].samples.min(self.request.samples)
    }

    /// Returns the part of the store's key that describes a measurement size: image size and light samples.
    pub(super) fn place(&self, size_index: usize) -> String {
        let size_px = self.size_px(size_index);
        format!("{}x{}/{}", size_px.x, size_px.y, self.samples(size_index))
    }

    fn scenes(&self, size_index: usize) -> Result<&[Scene<'a>], LabError> {
        if self.scenes_by_size[size_index].get().is_none() {
            let made =
                self.request.views.iter().map(|view| self.scene(view, size_index)).collect::<Result<Vec<_>, _>>()?;
            let _ = self.scenes_by_size[size_index].set(made);
        }
        Ok(self.scenes_by_size[size_index].get().map_or(&[], Vec::as_slice))
    }

    fn scene(&self, asked: &'a AdviseView, size_index: usize) -> Result<Scene<'a>, LabError> {
        let size_px = self.size_px(size_index);
        let setup = &asked.setup;
        let view = View::of_uploaded(self.lab, &self.uploaded[asked.scene], setup, size_px)?;
        let tracer = &self.tracers[asked.scene];
        let receivers = tracer.primary(&setup.camera, size_px);
        let options = VisibilityOptions { samples: self.samples(size_index), ..VisibilityOptions::default() };
        let lights = std::slice::from_ref(&setup.lights[asked.light]);
        let mut truth = trace_lights(tracer, &receivers, lights, &options, self.progress)?.swap_remove(0);
        truth.unjudge_mismatched_surfaces(&view.surface_points()?, setup.camera.eye);
        Ok(Scene { view, truth, receivers })
    }

    /// Returns whether every view has at least one judged pixel.
    pub(super) fn judges_something(&self) -> Result<bool, LabError> {
        Ok(self.scenes(FULL)?.iter().all(|scene| scene.truth.judged.contains(&true)))
    }

    /// Measures a configuration with the number of frames of the measurement size.
    pub(super) fn measure(&self, config: &Config, size_index: usize) -> Result<Measured, LabError> {
        self.measure_frames(config, size_index, MEASUREMENT_SIZES[size_index].frames)
    }

    /// Measures a configuration with the given number of timed frames.
    pub(super) fn measure_frames(&self, config: &Config, size_index: usize, frames: u32) -> Result<Measured, LabError> {
        let scenes = self.scenes(size_index)?;
        let began = Instant::now();
        let mut measured = Measured::default();
        let max_time = Duration::from_secs_f64((MAX_BUDGETS * 1e-3 * self.max_ms.get()).clamp(0.02, 3.0));
        let at_most = LONG_ENOUGH.min(max_time);
        let timing = Timing { warm_up: 1, frames, at_least: Duration::ZERO, at_most, end: None };
        let mut counts = Vec::new();
        for (scene, asked) in scenes.iter().zip(&self.request.views) {
            let run = create(&self.lab.gpu(), &config.choice())
                .map_err(LabError::from)
                .and_then(|mut technique| scene.view.run(&mut technique, asked.light, &timing));
            let run = match run {
                Ok(run) => run,
                Err(error @ LabError::NoRoom { .. }) => return Ok(refused(&error, began)),
                Err(error @ LabError::Technique(antumbra::Error::Unsupported { .. })) => {
                    return Ok(refused(&error, began));
                }
                // Parameters that contradict each other or exceed a limit.
                Err(error @ LabError::Technique(_)) => return Ok(refused(&error, began)),
                Err(error) => return Err(error),
            };
            let errors = visibility_errors(&scene.truth.visibility, &run.visibility, &scene.truth.judged)?;
            measured.rmse.push(errors.rmse.unwrap_or(0.0));
            measured.roughness.push(errors.roughness.unwrap_or(0.0));
            measured.ms.push(run.timings.total_ms);
            measured.spread_ms.push([run.timings.total_p10_ms, run.timings.total_p90_ms]);
            measured.masks.push(fingerprint_of(&run.visibility));
            counts.push(run.timings.count());
            for pass in &run.timings.passes {
                *measured.pass_ms.entry(pass.label.clone()).or_default() += pass.ms;
            }
            measured.memory_bytes = measured.memory_bytes.max(run.memory_bytes);
        }
        measured.count = FrameCount::least(counts).unwrap_or_default();
        measured.spent_s = began.elapsed().as_secs_f64();
        Ok(measured)
    }

    /// Returns the scene facts of each view, by name.
    pub(super) fn facts(&self) -> Result<Vec<(String, SceneFacts)>, LabError> {
        let facts = self.scenes(FULL)?.iter().zip(&self.request.views).map(|(made, asked)| {
            let (scene, setup) = (&self.request.scenes[asked.scene], &asked.setup);
            let light = &setup.lights[asked.light];
            let tracer = &self.tracers[asked.scene];
            let facts = SceneFacts::measure(scene, tracer, &made.receivers, &setup.camera, light, &made.truth)?;
            Ok((asked.name.clone(), facts))
        });
        facts.collect()
    }

    /// Returns the ground truth and the technique's mask of a view's judged light.
    pub(super) fn masks(&self, config: &Config, view: usize) -> Result<(&LightTruth, Visibility), LabError> {
        let (scene, asked) = (&self.scenes(FULL)?[view], &self.request.views[view]);
        let drawn = scene.view.draw(&mut scene.view.create(&config.choice())?, asked.light, 1)?;
        Ok((&scene.truth, drawn.visibility))
    }

    /// Shades a view with one mask of the judged light. Other lights are dark.
    pub(super) fn shade(&self, visibility: &Visibility, view: usize) -> Result<image::RgbImage, LabError> {
        let (scene, asked) = (&self.scenes(FULL)?[view], &self.request.views[view]);
        let dark = Visibility::one(visibility.size_px, vec![0.0; crate::picture::pixel_count(visibility.size_px)]);
        let lights = asked.setup.lights.len();
        let visibilities: Vec<&Visibility> =
            (0..lights).map(|light| if light == asked.light { visibility } else { &dark }).collect();
        Ok(scene.view.shade(&visibilities)?.to_srgb8())
    }
}

/// Fingerprint of a mask. Equal masks have equal fingerprints.
fn fingerprint_of(visibility: &Visibility) -> String {
    let pixels = 0..crate::picture::pixel_count(visibility.size_px);
    let values = pixels.flat_map(|i| (0..visibility.channel_count()).map(move |channel| visibility.at(i, channel)));
    fingerprint(values.flat_map(f32::to_le_bytes))
}

fn refused(error: &LabError, began: Instant) -> Measured {
    Measured { refused: Some(error.to_string()), spent_s: began.elapsed().as_secs_f64(), ..Measured::default() }
}
