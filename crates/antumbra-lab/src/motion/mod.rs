//! Flicker and lag of techniques in motion.
//!
//! A camera, a light or a caster moves for some frames and stops ([`Motion`]). Each technique keeps one state over all of them, as a
//! host's light does, and each frame is compared with its traced ground truth. [`flicker`] defines the resulting measures; `trajectory`
//! defines the poses in each frame.
//!
//! ```text
//! trajectory ─► scene and camera of a frame ─┬─► rays ──► true change ─┐
//!                                        └─► mask ──► its change ──┴─► flicker, lag, strip
//! ```
//!
//! **The truth's own noise.** All pixels of all frames are traced with the same light samples, so static parts have the same
//! truth in every frame. The remaining noise is the quantisation by the number of samples, in which a penumbra moves. To
//! measure it, the last change is also traced with other light samples; the rms of the difference, divided by √2 because both
//! have equal noise, is [`TrueMotion::noise`].

mod caster;
pub mod flicker;
mod strip;
mod tracing;
mod trajectory;

#[cfg(test)]
mod tests;

pub use caster::{MovingCaster, largest_caster, named_caster};
pub use strip::{STRIP_FLICKER_RANGE, STRIP_FRAMES};

use std::time::Instant;

use antumbra::{AnyShadow, Casters, Frame, Mask};
use antumbra_reference::Tracer;
use antumbra_scene::{Camera, Scene, Setup};
use glam::UVec2;
use image::RgbImage;

use crate::device::LabDevice;
use crate::error::LabError;
use crate::gpu_scene::GpuScene;
use crate::limits::End;
use crate::picture::{Visibility, pixel_count};
use crate::progress::Progress;
use crate::receivers::{Layer, ReceiverImages, ReceiverPass};
use crate::technique_run::{cut_short, draw_as_host, mask_for};
use crate::truth::trace_light;
use flicker::{FlickerSums, TrueFrame, distances_to_settled, lag_frames, touched_pixels};
use strip::Strip;
use tracing::Tracing;
use trajectory::{Pose, Trajectory};

/// Number of progress steps per traced frame.
const STEPS: u64 = 100;

/// Moving object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The camera moves to its right or along a path.
    Camera,
    /// The judged light moves to the camera's right.
    Light,
    /// One caster moves to the camera's right.
    Caster,
}

impl Motion {
    /// All motions.
    pub const ALL: [Self; 3] = [Self::Camera, Self::Light, Self::Caster];

    /// Returns the name on the command line and in `metrics.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Light => "light",
            Self::Caster => "caster",
        }
    }
}

/// Options of the motions.
#[derive(Clone, Debug)]
pub struct MotionOptions {
    /// Motions, measured one after the other.
    pub motions: Vec<Motion>,
    /// Number of moving frames, at least one.
    pub frames: u32,
    /// Metres per frame. A sun turns by the angle that this subtends at ten metres.
    pub step_m: f32,
    /// Mesh whose instances are the moving caster; `None` uses [`largest_caster`].
    pub caster: Option<String>,
    /// Cameras that the camera passes at even intervals before it reaches the setup's; empty moves it sideways.
    pub path: Vec<Camera>,
}

/// Number of static frames at the start, in which lists and maps reach their sizes.
const STILL_BEFORE: u32 = 4;
/// Maximum number of frames measured after the stop.
const STILL_AFTER: u32 = 16;
/// Number of consecutive identical masks that count as settled.
const SAME_MASKS: usize = 4;

/// Ground truth of a motion, frame by frame.
#[derive(Debug)]
pub struct MotionTruth {
    /// Summary for reports.
    pub summary: TrueMotion,
    /// Truth of each frame from the start on, N + 1 of them.
    frames: Vec<TrueFrame>,
    touched: Vec<usize>,
}

/// Summary of a motion's ground truth.
#[derive(Clone, Debug)]
pub struct TrueMotion {
    /// Motion.
    pub motion: Motion,
    /// Name of the moving caster; `None` for other motions.
    pub caster: Option<String>,
    /// Rms change of the truth between frames, over frames and judged pixels; `None` if none is judged.
    pub change: Option<f64>,
    /// Rms noise of the light samples in that change, over the pixels of the last frame.
    pub noise: Option<f64>,
    /// Image with frames and their changes, in two rows.
    pub strip: RgbImage,
}

/// Measures of a technique in a motion.
#[derive(Clone, Debug)]
pub struct MotionFigures {
    /// Motion.
    pub motion: Motion,
    /// Root mean square of the mask's change minus the truth's; `None` if no pixel is judged in two frames.
    pub flicker: Option<f64>,
    /// Ratio of flicker to the truth's change; `None` if the truth does not change.
    pub ratio: Option<f64>,
    /// Frames after the stop until the mask stays within [`flicker::SETTLED`] of the settled one; `None` if it does not
    /// settle, or the motion touched no pixel.
    pub lag_frames: Option<u32>,
    /// Rms distances of the masks after the stop to the last of them, starting with the frame that stops;
    /// empty if the motion touched no pixel.
    pub after_stop: Vec<f64>,
    /// Number of frames whose lists overflowed during the motion. A host does not redraw them, so they count.
    pub lacking_room: u32,
    /// Image with frames and their changes, in two rows.
    pub strip: RgbImage,
}

/// Scene with moving parts, rendered frame by frame.
#[derive(Debug)]
pub struct MovingScene<'a> {
    lab: &'a LabDevice,
    setup: &'a Setup,
    light: usize,
    size_px: UVec2,
    options: &'a MotionOptions,
    at_rest: &'a Scene,
    caster: Option<MovingCaster>,
    gpu_scene: GpuScene,
    receiver_pass: ReceiverPass,
}

impl<'a> MovingScene<'a> {
    /// Uploads the scene, and finds the caster if one is to move. `light` is the index of the judged
    /// light, which is also the one that moves.
    ///
    /// # Errors
    /// If no mesh has the caster's name, or the scene cannot be traced to find one. An image without a movable
    /// caster is no error: see [`Self::motions`].
    ///
    /// # Panics
    /// If the number of moving frames is zero.
    pub fn new(
        lab: &'a LabDevice,
        scene: &'a Scene,
        setup: &'a Setup,
        light: usize,
        size_px: UVec2,
        options: &'a MotionOptions,
    ) -> Result<Self, LabError> {
        assert!(options.frames > 0, "a motion has at least one frame");
        let caster = match &options.caster {
            _ if !options.motions.contains(&Motion::Caster) => None,
            Some(name) => Some(named_caster(scene, name)?),
            None => largest_caster(scene, &Tracer::new(scene)?.primary(&setup.camera, size_px)),
        };
        let gpu_scene = GpuScene::upload(lab, scene);
        let receiver_pass = ReceiverPass::new(lab);
        Ok(Self { lab, setup, light, size_px, options, at_rest: scene, caster, gpu_scene, receiver_pass })
    }

    /// Returns the possible motions, and a line for the user about omitted ones.
    pub fn motions(&self) -> (Vec<Motion>, Option<String>) {
        let can_move = |motion: &Motion| *motion != Motion::Caster || self.caster.is_some();
        let motions: Vec<_> = self.options.motions.iter().copied().filter(can_move).collect();
        let left_out = (motions.len() < self.options.motions.len()).then(|| {
            let names = caster::names(self.at_rest);
            format!(
                "No caster moves, because none in this image is separate from its surroundings. Choose one with `--caster`: {names}."
            )
        });
        (motions, left_out)
    }

    /// Returns the number of moving frames, and metres per frame.
    pub fn frames_and_step_m(&self) -> (u32, f32) {
        (self.options.frames, self.options.step_m)
    }

    fn trajectory(&self, motion: Motion) -> Trajectory<'a> {
        let MotionOptions { frames, step_m, ref path, .. } = *self.options;
        Trajectory { setup: self.setup, light: self.light, motion, frames, step_m, path }
    }

    /// Applies a pose and renders what the camera sees.
    fn look(&mut self, pose: &Pose) -> Result<ReceiverImages, LabError> {
        if let Some(caster) = &self.caster {
            self.gpu_scene.offset_instances(self.lab, &caster.instances, pose.caster_offset_m);
        }
        let images =
            self.receiver_pass.render(self.lab, &self.gpu_scene, &pose.camera, self.size_px, Layer::FirstHits)?;
        Ok(images)
    }

    /// Traces every frame of a motion, with `samples` light samples per pixel.
    ///
    /// # Errors
    /// If the scene cannot be traced, or the device fails.
    pub fn trace(&mut self, motion: Motion, samples: u32, progress: &dyn Progress) -> Result<MotionTruth, LabError> {
        self.trace_until(motion, samples, None, progress)
    }

    /// Traces as [`Self::trace`], until a deadline.
    ///
    /// # Errors
    /// As [`Self::trace`], and if the deadline passes.
    pub fn trace_until(
        &mut self,
        motion: Motion,
        samples: u32,
        deadline: Option<Instant>,
        progress: &dyn Progress,
    ) -> Result<MotionTruth, LabError> {
        let caster = self.caster.clone().filter(|_| motion == Motion::Caster);
        let trajectory = self.trajectory(motion);
        let last = self.options.frames;
        let mut tracing = Tracing::new(self.at_rest.clone(), caster.as_ref(), samples)?;
        let mut frames: Vec<TrueFrame> = Vec::new();
        let mut sums = FlickerSums::new(pixel_count(self.size_px));
        let mut strip = Strip::new(self.size_px);
        // The last two frames are traced twice.
        progress.begin(&format!("tracing the {}'s motion", motion.name()), u64::from(last + 3) * STEPS);
        let mut other_points: Vec<Visibility> = Vec::new();
        for i in 0..=last {
            let pose = trajectory.at(i);
            let receivers = tracing.receivers(&pose, self.size_px)?;
            let done = u64::from(i) * STEPS + other_points.len() as u64 * STEPS;
            let report = |fraction: f32| progress.reach(done + (f64::from(fraction) * STEPS as f64) as u64);
            let (tracer, light) = (&tracing.tracer, &pose.light);
            let mut truth = trace_light(tracer, &receivers, light, &tracing.options(0), deadline, &report)?;
            let seen = self.look(&pose)?.read_surface_points(self.lab)?;
            truth.unjudge_mismatched_surfaces(&seen, pose.camera.eye);
            if i + 1 >= last {
                let report = |fraction: f32| report(1.0 + fraction);
                let other = trace_light(tracer, &receivers, light, &tracing.options(1), deadline, &report)?;
                other_points.push(other.visibility);
            }
            let frame = TrueFrame { visibility: truth.visibility, judged: truth.judged };
            if let Some(before) = frames.last() {
                // Against a constant mask, flicker is the truth's own change.
                let still = [&before.visibility; 2];
                sums.add([before, &frame], still);
                strip.add_truth(i, last, [before, &frame]);
            }
            frames.push(frame);
        }
        progress.end();
        let [before, after] = &frames[frames.len() - 2..] else { unreachable!("a motion has at least two positions") };
        let mut noise = FlickerSums::new(pixel_count(self.size_px));
        noise.add([before, after], [&other_points[0], &other_points[1]]);
        let summary = TrueMotion {
            motion,
            caster: caster.map(|caster| caster.name),
            change: sums.truth_change(),
            noise: noise.flicker().map(|both| both * std::f64::consts::FRAC_1_SQRT_2),
            strip: strip.finish(&after.visibility, &sums, &after.judged),
        };
        Ok(MotionTruth { summary, touched: touched_pixels(&frames), frames })
    }

    /// Runs a new technique through a motion, and some frames beyond its stop.
    ///
    /// # Errors
    /// If the technique cannot be prepared, or the device fails.
    pub fn run(&mut self, truth: &MotionTruth, technique: &mut AnyShadow) -> Result<MotionFigures, LabError> {
        self.run_until(truth, technique, None)
    }

    /// Runs as [`Self::run`], until an end time.
    ///
    /// # Errors
    /// As [`Self::run`], and if the end passes.
    pub fn run_until(
        &mut self,
        truth: &MotionTruth,
        technique: &mut AnyShadow,
        end: Option<End>,
    ) -> Result<MotionFigures, LabError> {
        let began = Instant::now();
        let in_time = |frames: u32, technique: &AnyShadow| match end {
            Some(end) if end.is_past() => Err(cut_short(technique, Some(end), began, frames)),
            _ => Ok(()),
        };
        let trajectory = self.trajectory(truth.summary.motion);
        let last = self.options.frames;
        let casters = self.gpu_scene.casters();
        let mask = mask_for(self.lab, technique, &Casters::Meshes(&casters), self.size_px);
        let mut sums = FlickerSums::new(pixel_count(self.size_px));
        let mut strip = Strip::new(self.size_px);
        let mut lacking_room = 0;

        let start = trajectory.at(0);
        let images = self.look(&start)?;
        let mut before = self.draw(technique, &start, &images, &mask)?.0;
        for _ in 1..STILL_BEFORE {
            before = self.draw(technique, &start, &images, &mask)?.0;
        }
        for i in 1..=last {
            in_time(STILL_BEFORE + i - 1, technique)?;
            let pose = trajectory.at(i);
            let images = self.look(&pose)?;
            let (now, lacked) = self.draw(technique, &pose, &images, &mask)?;
            lacking_room += u32::from(lacked);
            let [true_before, true_now] = [i - 1, i].map(|i| &truth.frames[i as usize]);
            sums.add([true_before, true_now], [&before, &now]);
            strip.add(i, last, [true_before, true_now], [&before, &now]);
            before = now;
        }
        let rest = trajectory.at(last);
        let images = self.look(&rest)?;
        let in_time = |i: u32, technique: &AnyShadow| in_time(STILL_BEFORE + last + i, technique);
        let (masks, lacked) = self.settle(technique, (&rest, &images), &mask, before, in_time)?;
        // The first frame after the stop reports the overflow of the last moving frame.
        lacking_room += u32::from(lacked);
        let true_rest = &truth.frames[last as usize];
        let after_stop = distances_to_settled(&masks, true_rest, &truth.touched);
        Ok(MotionFigures {
            motion: truth.summary.motion,
            flicker: sums.flicker(),
            ratio: sums.ratio(),
            lag_frames: lag_frames(&after_stop),
            after_stop,
            lacking_room,
            strip: strip.finish(masks.last().expect("the mask that stopped is there"), &sums, &true_rest.judged),
        })
    }

    /// Draws frames at rest until masks are equal. Returns `last`, the last moving frame's mask, followed by theirs; and whether the
    /// first of them reports an overflow. `in_time` fails once the end of the run has passed.
    fn settle(
        &self,
        technique: &mut AnyShadow,
        (rest, images): (&Pose, &ReceiverImages),
        mask: &Mask,
        last: Visibility,
        in_time: impl Fn(u32, &AnyShadow) -> Result<(), LabError>,
    ) -> Result<(Vec<Visibility>, bool), LabError> {
        let (mut masks, mut lacked_room) = (vec![last], false);
        for i in 0..STILL_AFTER {
            in_time(i, technique)?;
            let (now, lacked) = self.draw(technique, rest, images, mask)?;
            lacked_room |= lacked && i == 0;
            masks.push(now);
            let newest = &masks[masks.len().saturating_sub(SAME_MASKS)..];
            if newest.len() == SAME_MASKS && newest.iter().all(|mask| *mask == newest[0]) {
                break;
            }
        }
        Ok((masks, lacked_room))
    }

    /// Draws a frame. Returns its mask, and whether the previous frame's lists overflowed.
    fn draw(
        &self,
        technique: &mut AnyShadow,
        pose: &Pose,
        images: &ReceiverImages,
        mask: &Mask,
    ) -> Result<(Visibility, bool), LabError> {
        let casters = self.gpu_scene.casters_for(&pose.light);
        let frame =
            Frame { light: &pose.light, casters: Casters::Meshes(&casters), receivers: images.receivers(), mask };
        let (visibility, overflow) = draw_as_host(self.lab, technique, &frame)?;
        Ok((visibility, overflow.is_some()))
    }
}
