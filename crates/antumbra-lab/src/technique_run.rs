//! Run of one technique, on one view, for one light: creation, preparation, warm-up, timing, and readback of the mask.

mod choice;
mod frames;
mod timings;

use std::time::Instant;

use antumbra::contract::ParamValue;
use antumbra::{
    AnyShadow, Casters, Denoise, Error, Frame, Gpu, Mask, MaskChannels, Opacity, Overflow, PassTimer, Receivers, WarmUp,
};
use antumbra_light::Light;
use glam::UVec2;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Number, Value};

use crate::cut_short::CutShort;
use crate::device::LabDevice;
use crate::error::LabError;
use crate::limits::End;
use crate::picture::Visibility;
use crate::stopwatch::{Stopwatch, clock_rise};
use frames::{Counted, Timed, draw_frames, one_frame, read_mask};
use timings::medians;

pub use crate::stopwatch::{FrameCount, Timing};
pub use choice::{Extras, TechniqueChoice};
pub(crate) use timings::median;
pub use timings::{Clock, PassStatistics, Timings};

/// Result of drawing a technique.
#[derive(Debug)]
pub struct Drawn {
    /// Visibility mask.
    pub visibility: Visibility,
    /// GPU memory of the technique for the light, bytes.
    pub memory_bytes: u64,
    /// Side of each map whose size is `auto`, texels; empty if sizes are given.
    pub auto_map_sizes: Vec<u32>,
}

/// Time before a technique's first result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StartUp {
    /// Time to create its pipelines, milliseconds, except those that earlier techniques created on this device.
    pub compile_ms: f64,
    /// Time of its first frame, milliseconds, including deferred driver compilation and memory allocation.
    pub first_frame_ms: f64,
}

/// Result of running a technique.
#[derive(Debug)]
pub struct TechniqueRun {
    /// Visibility mask.
    pub visibility: Visibility,
    /// Times of frames and passes.
    pub timings: Timings,
    /// GPU memory of the technique for the light, bytes.
    pub memory_bytes: u64,
    /// Side of each map whose size is `auto`, texels; empty if sizes are given.
    pub auto_map_sizes: Vec<u32>,
    /// Time before its first result.
    pub start_up: StartUp,
    /// Time limit of the technique if it reduced the number of timed frames, seconds.
    pub cut_short_s: Option<f64>,
}

/// Creates a technique and sets its parameters.
///
/// # Errors
/// If the device lacks a feature, or a setting is wrong.
pub fn create(gpu: &Gpu, choice: &TechniqueChoice) -> Result<AnyShadow, Error> {
    let mut technique = choice.kind.create(gpu)?;
    technique.set_quality(choice.quality);
    for (key, value) in &choice.settings {
        technique.set(key, value)?;
    }
    technique.set_denoise(choice.extras.is_denoised.then(Denoise::default));
    technique.set_half_resolution(choice.extras.is_half);
    Ok(technique)
}

/// Returns the current parameters of a technique, for reports.
pub fn parameters_of(technique: &AnyShadow) -> Map<String, Value> {
    technique.params().map(|(spec, value)| (spec.key.to_owned(), json_of(value))).collect()
}

/// Converts a parameter's value to JSON: numbers as numbers, choices as text.
fn json_of(value: ParamValue) -> Value {
    match value {
        ParamValue::U32(v) => v.into(),
        // Converted through text, so that 0.1 stays 0.1 and does not become its double-precision neighbour.
        ParamValue::F32(v) => v.to_string().parse::<Number>().map_or(Value::Null, Value::Number),
        ParamValue::Bool(v) => v.into(),
        ParamValue::Choice(v) => v.into(),
        ParamValue::List(v) => v.values().iter().map(|v| json_of(ParamValue::F32(*v))).collect(),
    }
}

/// Draws a light's mask: once, or `frames` times if it changes from frame to frame. Frames with overflowing lists do
/// not count and never provide the mask.
///
/// # Errors
/// If the technique cannot be prepared or its lists overflow repeatedly, or the device fails.
pub fn draw(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    light: &Light,
    casters: Casters<'_>,
    receivers: Receivers<'_>,
    frames: u32,
) -> Result<Drawn, LabError> {
    draw_until(lab, technique, light, casters, receivers, frames, None)
}

/// Draws as [`draw`], until an end time.
///
/// # Errors
/// As [`draw`], and if the end passes.
pub(crate) fn draw_until(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    light: &Light,
    casters: Casters<'_>,
    receivers: Receivers<'_>,
    frames: u32,
    end: Option<End>,
) -> Result<Drawn, LabError> {
    let mask = mask_for(lab, technique, &casters, receivers.size_px);
    let frame = Frame { light, casters, receivers, mask: &mask };
    let began = Instant::now();
    let mut counted = Counted { frames: frames.max(1), drawn: 0, end };
    draw_frames(lab, technique, &frame, None, &mut counted)?;
    if counted.drawn < counted.frames {
        return Err(cut_short(technique, end, began, counted.drawn));
    }
    Ok(Drawn {
        visibility: read_mask(lab, &mask)?,
        memory_bytes: memory_of(lab, technique),
        auto_map_sizes: technique.auto_map_sizes(),
    })
}

/// Runs a technique: creates its pipelines, draws frames until nothing new is created ([`Timing`] sets the minimum number), and times the
/// following ones. Frames with overflowing lists do not count. The mask is taken after the requested number of frames, so that
/// accumulation is the same on any machine, or after the last frame if time ran out before.
///
/// # Errors
/// If the technique cannot be prepared or its lists overflow repeatedly, the device fails, or the end in
/// `timing` passes before a frame counts.
pub fn run(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    light: &Light,
    casters: Casters<'_>,
    receivers: Receivers<'_>,
    timing: &Timing,
) -> Result<TechniqueRun, LabError> {
    let began = Instant::now();
    technique.warm_up(kinds_of(&casters))?;
    let compile_ms = began.elapsed().as_secs_f64() * 1e3;
    let mask = mask_for(lab, technique, &casters, receivers.size_px);
    let asked_for = (timing.warm_up + timing.frames.max(1)) as usize;
    // The error of denoised masks depends on the number of frames, so all requested frames are drawn.
    let least = if technique.denoise().is_some() { asked_for } else { 1 };
    let watch = Stopwatch::new(*timing, clock_rise(lab.adapter.is_software()));
    let mut timed = Timed { lab, mask: &mask, watch, asked_for, least, frames: Vec::new(), visibility: None };
    let mut timer = PassTimer::new(&lab.gpu());
    let frame = Frame { light, casters, receivers, mask: &mask };
    draw_frames(lab, technique, &frame, timer.as_mut(), &mut timed)?;
    let Timed { watch, frames, visibility, .. } = timed;
    let warm_up = watch.warm_up();
    if !watch.has_timed() {
        return Err(cut_short(technique, timing.end, began, frames.len() as u32));
    }
    let first_frame_ms = frames[0].processor_ms + frames[0].submit_to_done_ms;
    let timings = medians(&frames[warm_up as usize..], warm_up, lab.adapter.is_software());
    let visibility = visibility.map_or_else(|| read_mask(lab, &mask), Ok)?;
    Ok(TechniqueRun {
        visibility,
        timings,
        memory_bytes: memory_of(lab, technique),
        auto_map_sizes: technique.auto_map_sizes(),
        start_up: StartUp { compile_ms, first_frame_ms },
        cut_short_s: timing
            .end
            .filter(|_| watch.is_cut_short())
            .and_then(|end| end.limit)
            .map(|limit| limit.as_secs_f64()),
    })
}

/// Returns the error of a technique whose end passed before a result.
pub(crate) fn cut_short(technique: &AnyShadow, end: Option<End>, began: Instant, frames: u32) -> LabError {
    let (limit, seconds) = (end.and_then(|end| end.limit), began.elapsed().as_secs_f64());
    LabError::CutShort { technique: technique.kind(), cut: CutShort { limit, seconds, frames } }
}

/// Returns the GPU memory of one light, bytes: retained memory, and memory that lights would share.
fn memory_of(lab: &LabDevice, technique: &AnyShadow) -> u64 {
    technique.memory_bytes() + lab.gpu().memory_bytes().shared
}

/// Returns the kinds of casters present, which determine the pipelines.
fn kinds_of(casters: &Casters<'_>) -> WarmUp {
    let Casters::Meshes(meshes) = casters else { return WarmUp::default() };
    WarmUp {
        masked: meshes.iter().any(|mesh| !matches!(mesh.opacity, Opacity::Opaque) && !mesh.opacity.tints()),
        tinted: meshes.iter().any(|mesh| mesh.opacity.tints()),
    }
}

/// Creates a mask with as many channels as the technique writes for these casters.
pub(crate) fn mask_for(lab: &LabDevice, technique: &AnyShadow, casters: &Casters<'_>, size_px: UVec2) -> Mask {
    let is_colored = technique.params().any(|(spec, value)| spec.colors_mask(value));
    let channels = if is_colored { MaskChannels::Three } else { casters.mask_channels() };
    Mask::with_channels(&lab.device, size_px, channels)
}

/// Draws one frame as a host does, without timing, and reads the mask. Also returns whether the previous frame's lists overflowed, because
/// a host does not redraw such a frame.
///
/// # Errors
/// If the technique cannot be prepared, or the device fails.
pub(crate) fn draw_as_host(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    frame: &Frame<'_>,
) -> Result<(Visibility, Option<Overflow>), LabError> {
    let work = technique.prepare(frame)?;
    let overflow = work.overflow();
    one_frame(lab, work, None)?;
    Ok((read_mask(lab, frame.mask)?, overflow))
}
