//! One technique, on one view, for one light: made, set, prepared, warmed up, timed, and its mask read back.

use std::time::{Duration, Instant};

use antumbra::contract::{ParamSpec, ParamValue};
use antumbra::{
    AnyShadow, Casters, Denoise, Error, Frame, Gpu, Mask, MaskChannels, Overflow, PassTime, PassTimer, Prepared,
    Quality, Receivers, Recorder, TechniqueKind,
};
use antumbra_light::Light;
use glam::{UVec2, Vec3};
use serde::Serialize;
use serde_json::{Map, Number, Value};

use crate::device::{DeviceError, LabDevice};
use crate::error::LabError;
use crate::picture::Visibility;
use crate::readback::read_f32_layer;

/// A technique with the parameters that a user set.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniqueChoice {
    /// Which technique.
    pub kind: TechniqueKind,
    /// How much it may spend.
    pub quality: Quality,
    /// Keys and values as written, set after what the quality sets; later ones win.
    pub settings: Vec<(String, String)>,
    /// Whether its masks are made smooth over frames and pixels, as the library does by default where it is asked to.
    pub is_denoised: bool,
}

/// What the name of a technique ends with whose masks are made smooth.
pub const DENOISED: &str = "+denoised";

impl TechniqueChoice {
    /// A technique as it comes.
    pub fn default_of(kind: TechniqueKind) -> Self {
        Self::of_quality(kind, Quality::Balanced)
    }

    /// A technique that may spend so much.
    pub fn of_quality(kind: TechniqueKind, quality: Quality) -> Self {
        Self { kind, quality, settings: Vec::new(), is_denoised: false }
    }

    /// A technique as it comes, with settings.
    pub fn with_settings(kind: TechniqueKind, settings: Vec<(String, String)>) -> Self {
        Self { settings, ..Self::default_of(kind) }
    }

    /// The same with masks that are made smooth, or not.
    pub fn denoised(self, is_denoised: bool) -> Self {
        Self { is_denoised, ..self }
    }

    /// `pcss`, or `pcss:fast` where it is not as it comes; and whether its masks are made smooth: `pcss:fast+denoised`.
    pub fn name(&self) -> String {
        let denoised = if self.is_denoised { DENOISED } else { "" };
        match self.quality {
            Quality::Balanced => format!("{}{denoised}", self.kind),
            quality => format!("{}:{quality}{denoised}", self.kind),
        }
    }

    /// The same technique with exact comparisons under its own kernel in its basis's place: the truth of techniques with
    /// a kernel of fixed width. `None` for the others.
    pub fn filtered_truth(&self) -> Option<Self> {
        let is_exact = |spec: &&ParamSpec| spec.key == "resolve" && spec.choices.contains(&"exact");
        self.kind.param_specs().iter().find(is_exact)?;
        let exact = [("resolve".to_owned(), "exact".to_owned())];
        Some(Self {
            kind: self.kind,
            quality: self.quality,
            settings: self.settings.iter().cloned().chain(exact).collect(),
            is_denoised: false,
        })
    }

    /// The settings as they would be given to `compare` or `bench`: ` --set pcss.map_size=2048`.
    pub fn as_arguments(&self) -> String {
        self.settings.iter().map(|(key, value)| format!(" --set {}.{key}={value}", self.name())).collect()
    }
}

/// A technique that still lacks room after so many frames that made more will not find it.
const MOST_OVERFLOWS: u32 = 8;

/// How long and how often to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Frames before the timed ones: drivers compile, allocate and clock up.
    pub warm_up: u32,
    /// Timed frames.
    pub frames: u32,
    /// Once this much time has gone by, warm-up included, no further frame is begun; one frame is always timed.
    pub at_most: Duration,
}

/// A pass's time over the timed frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassStatistics {
    /// The pass's label.
    pub label: String,
    /// Median, milliseconds.
    pub ms: f64,
    /// 10th percentile, milliseconds.
    pub p10_ms: f64,
    /// 90th percentile, milliseconds.
    pub p90_ms: f64,
}

/// Which clock measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// The GPU's own timestamps about every pass.
    GpuTimestamps,
    /// The processor's, from submission to completion: the device has no timestamps.
    SubmitToDone,
    /// The device's timestamps for passes, the processor's clock for the frame: a software device dates the ends of
    /// passes when it gets to them, so that some come out as nothing and their sum as too little.
    SoftwareTimestamps,
}

/// The times of one technique.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Timings {
    /// By pass, in the order of recording; empty where the device has no timestamps.
    pub passes: Vec<PassStatistics>,
    /// Median over the frames of a frame's whole time, milliseconds.
    pub total_ms: f64,
    /// The frames' 10th percentile, milliseconds.
    pub total_p10_ms: f64,
    /// The frames' 90th percentile, milliseconds.
    pub total_p90_ms: f64,
    /// Median over the frames of the processor's time for preparing and recording, milliseconds.
    pub processor_ms: f64,
    /// Which clock measured.
    pub clock: Clock,
    /// Frames before the timed ones.
    pub warm_up: u32,
    /// Timed frames.
    pub frames: u32,
}

/// What a technique gave.
#[derive(Debug)]
pub struct TechniqueRun {
    /// The mask.
    pub visibility: Visibility,
    /// Its times.
    pub timings: Timings,
    /// GPU memory that the technique holds, bytes.
    pub memory_bytes: u64,
}

/// Makes a technique and sets its parameters.
///
/// # Errors
/// Where the device lacks something, or a setting is wrong.
pub fn create(gpu: &Gpu, choice: &TechniqueChoice) -> Result<AnyShadow, Error> {
    let mut technique = choice.kind.create(gpu)?;
    technique.set_quality(choice.quality);
    for (key, value) in &choice.settings {
        technique.set(key, value)?;
    }
    technique.set_denoise(choice.is_denoised.then(Denoise::default));
    Ok(technique)
}

/// The parameters of a technique as they stand, for reports.
pub fn parameters_of(technique: &AnyShadow) -> Map<String, Value> {
    technique.params().map(|(spec, value)| (spec.key.to_owned(), json_of(value))).collect()
}

/// A parameter's value as JSON: numbers as numbers, choices as text.
fn json_of(value: ParamValue) -> Value {
    match value {
        ParamValue::U32(v) => v.into(),
        // By way of text, so that 0.1 stays 0.1 and does not become its double-precision neighbour.
        ParamValue::F32(v) => v.to_string().parse::<Number>().map_or(Value::Null, Value::Number),
        ParamValue::Bool(v) => v.into(),
        ParamValue::Choice(v) => v.into(),
        ParamValue::List(v) => v.values().iter().map(|v| json_of(ParamValue::F32(*v))).collect(),
    }
}

/// Runs a technique: warm-up, timed frames, mask. Frames that lacked room are not counted, and the mask is never
/// theirs: measured pictures are exact.
///
/// # Errors
/// Where the technique cannot be prepared or finds no room, or the device fails.
pub fn run(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    light: &Light,
    casters: Casters<'_>,
    receivers: Receivers<'_>,
    timing: &Timing,
) -> Result<TechniqueRun, LabError> {
    let gpu = lab.gpu();
    let kind = technique.kind();
    let mask = mask_for(lab, technique, &casters, receivers.size_px);
    let frame = Frame { light, casters, receivers, mask: &mask };
    let mut timer = PassTimer::new(&gpu);
    // The error of what is denoised hangs on how many frames it has seen, so that all of them are drawn.
    let at_most = if technique.denoise().is_some() { Duration::MAX } else { timing.at_most };
    let began = Instant::now();
    let mut frames = Vec::new();
    let mut overflows = 0;
    loop {
        let prepare_began = Instant::now();
        let work = technique.prepare(&frame)?;
        let prepare_ms = prepare_began.elapsed().as_secs_f64() * 1e3;
        // What `prepare` learns is of the frame before.
        if let Some(overflow) = work.overflow() {
            overflows += 1;
            if overflows > MOST_OVERFLOWS {
                return Err(LabError::NoRoom { technique: kind, overflow });
            }
            frames.clear();
        }
        let enough = frames.len() >= (timing.warm_up + timing.frames) as usize || began.elapsed() >= at_most;
        if enough && !frames.is_empty() {
            break;
        }
        let mut times = one_frame(lab, work, timer.as_mut())?;
        times.processor_ms += prepare_ms;
        frames.push(times);
    }
    // Where time ran out while it was warming up, the last frame is the one that counts: a slow frame is hardly
    // slower for being cold.
    let warm_up = timing.warm_up.min(frames.len() as u32 - 1);
    let timings = medians(&frames[warm_up as usize..], warm_up, lab.adapter.is_software());
    let visibility = read_mask(lab, &mask)?;
    Ok(TechniqueRun { visibility, timings, memory_bytes: technique.memory_bytes() })
}

/// A mask of as many channels as a technique writes of these casters.
pub(crate) fn mask_for(lab: &LabDevice, technique: &AnyShadow, casters: &Casters<'_>, size_px: UVec2) -> Mask {
    // Debug views are in colour.
    let is_colored =
        technique.params().any(|(spec, value)| spec.key == "show" && value == ParamValue::Choice("layers"));
    let channels = if is_colored { MaskChannels::Three } else { casters.mask_channels() };
    Mask::with_channels(&lab.device, size_px, channels)
}

/// Draws one frame as a host does, without timing, and reads the mask; whether the frame before lacked room is said too,
/// since no host draws a frame again for that.
///
/// # Errors
/// Where the technique cannot be prepared, or the device fails.
pub(crate) fn draw(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    frame: &Frame<'_>,
) -> Result<(Visibility, Option<Overflow>), LabError> {
    let work = technique.prepare(frame)?;
    let overflow = work.overflow();
    one_frame(lab, work, None)?;
    Ok((read_mask(lab, frame.mask)?, overflow))
}

/// A mask's visibility, of one channel or three.
fn read_mask(lab: &LabDevice, mask: &Mask) -> Result<Visibility, LabError> {
    let layer = |layer| read_f32_layer(lab, mask.texture(), layer);
    Ok(match mask.channels() {
        MaskChannels::One => Visibility::one(mask.size_px(), layer(0)?),
        MaskChannels::Three => {
            let [red, green, blue] = [layer(0)?, layer(1)?, layer(2)?];
            let rgb = red.iter().zip(&green).zip(&blue).map(|((r, g), b)| Vec3::new(*r, *g, *b));
            Visibility::three(mask.size_px(), rgb.collect())
        }
    })
}

/// One frame's times.
struct FrameTimes {
    passes: Option<Vec<PassTime>>,
    submit_to_done_ms: f64,
    /// Preparing and recording.
    processor_ms: f64,
}

fn one_frame(lab: &LabDevice, work: Prepared<'_>, mut timer: Option<&mut PassTimer>) -> Result<FrameTimes, LabError> {
    let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("technique") });
    let record_began = Instant::now();
    work.record(&mut Recorder::new(&mut encoder, timer.as_deref_mut()));
    let processor_ms = record_began.elapsed().as_secs_f64() * 1e3;
    if let Some(timer) = &timer {
        timer.resolve(&mut encoder);
    }
    // Uploads of `prepare` go with the submission; what is left of them must not count.
    lab.check()?;
    let began = Instant::now();
    lab.queue.submit([encoder.finish()]);
    lab.check()?;
    let submit_to_done_ms = began.elapsed().as_secs_f64() * 1e3;
    let passes = timer.map(|timer| read_times(lab, timer)).transpose()?;
    Ok(FrameTimes { passes, submit_to_done_ms, processor_ms })
}

fn read_times(lab: &LabDevice, timer: &PassTimer) -> Result<Vec<PassTime>, LabError> {
    let bytes = timer.readback_bytes();
    if bytes == 0 {
        return Ok(Vec::new());
    }
    let buffer = timer.readback();
    buffer.map_async(wgpu::MapMode::Read, ..bytes, |_| {});
    lab.check()?;
    let times = buffer
        .get_mapped_range(..bytes)
        .map(|mapped| timer.read(&mapped))
        .map_err(|error| DeviceError::Failed { count: 1, first: format!("cannot map the timestamps: {error}") })?;
    buffer.unmap();
    Ok(times)
}

fn medians(frames: &[FrameTimes], warm_up: u32, is_software: bool) -> Timings {
    let submit_to_done = || frames.iter().map(|frame| frame.submit_to_done_ms).collect();
    let timed: Option<Vec<&Vec<PassTime>>> = frames.iter().map(|frame| frame.passes.as_ref()).collect();
    let (passes, totals, clock) = match timed {
        Some(timed) => {
            let labels = timed.first().map_or(&[][..], |passes| passes.as_slice());
            let passes = labels
                .iter()
                .map(|first| {
                    let same = timed.iter().flat_map(|passes| passes.iter()).filter(|pass| pass.label == first.label);
                    PassStatistics::of(first.label, same.map(|pass| pass.ms).collect())
                })
                .collect();
            let totals = timed.iter().map(|passes| passes.iter().map(|pass| pass.ms).sum()).collect();
            if is_software {
                (passes, submit_to_done(), Clock::SoftwareTimestamps)
            } else {
                (passes, totals, Clock::GpuTimestamps)
            }
        }
        None => (Vec::new(), submit_to_done(), Clock::SubmitToDone),
    };
    let totals = sorted(totals);
    let [total_ms, total_p10_ms, total_p90_ms] = [0.5, 0.1, 0.9].map(|fraction| percentile(&totals, fraction));
    let processor_ms = percentile(&sorted(frames.iter().map(|frame| frame.processor_ms).collect()), 0.5);
    let frames = frames.len() as u32;
    Timings { passes, total_ms, total_p10_ms, total_p90_ms, processor_ms, clock, warm_up, frames }
}

impl PassStatistics {
    fn of(label: &str, times_ms: Vec<f64>) -> Self {
        let times_ms = sorted(times_ms);
        let at = |fraction| percentile(&times_ms, fraction);
        Self { label: label.to_owned(), ms: at(0.5), p10_ms: at(0.1), p90_ms: at(0.9) }
    }
}

/// The middle of some times; 0 for none.
pub(crate) fn median(values: Vec<f64>) -> f64 {
    percentile(&sorted(values), 0.5)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// The value at rank `fraction · (n − 1)` of sorted values, interpolated between its neighbours; 0 for none.
fn percentile(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let rank = fraction * last as f64;
    let below = rank.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (rank - below as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_by_label() {
        let frame = |a, b| FrameTimes {
            passes: Some(vec![PassTime { label: "a", ms: a }, PassTime { label: "b", ms: b }]),
            submit_to_done_ms: 9.0,
            processor_ms: a,
        };
        let timings = medians(&[frame(1.0, 10.0), frame(3.0, 30.0), frame(2.0, 80.0)], 4, false);
        assert_eq!(timings.passes.iter().map(|pass| pass.ms).collect::<Vec<_>>(), [2.0, 30.0]);
        assert_eq!(
            (timings.total_ms, timings.processor_ms, timings.clock, timings.frames),
            (33.0, 2.0, Clock::GpuTimestamps, 3)
        );
    }

    #[test]
    fn a_software_device_s_frames_are_timed_whole() {
        let passes = Some(vec![PassTime { label: "a", ms: 1.0 }]);
        let timings = medians(&[FrameTimes { passes, submit_to_done_ms: 9.0, processor_ms: 0.0 }], 0, true);
        assert_eq!((timings.passes[0].ms, timings.total_ms, timings.clock), (1.0, 9.0, Clock::SoftwareTimestamps));
    }

    #[test]
    fn percentiles_interpolate() {
        let pass = PassStatistics::of("a", (0..=10).rev().map(f64::from).collect());
        assert_eq!((pass.p10_ms, pass.ms, pass.p90_ms), (1.0, 5.0, 9.0));
        assert_eq!(percentile(&[1.0, 2.0], 0.5), 1.5);
    }

    #[test]
    fn without_timestamps_the_frame_counts() {
        let frame = |ms| FrameTimes { passes: None, submit_to_done_ms: ms, processor_ms: 0.0 };
        let timings = medians(&[frame(4.0), frame(8.0)], 0, true);
        assert!(timings.passes.is_empty());
        assert_eq!((timings.total_ms, timings.clock), (6.0, Clock::SubmitToDone));
    }
}
