//! One technique, on one view, for one light: made, set, prepared, warmed up, timed, and its mask read back.

use std::time::Instant;

use antumbra::contract::{ParamSpec, ParamValue, SampleWeights};
use antumbra::{
    AnyShadow, Casters, Denoise, Error, Frame, Gpu, Mask, MaskChannels, Opacity, Overflow, PassTime, PassTimer,
    Prepared, Quality, Receivers, Recorder, TechniqueKind, WarmUp,
};
use antumbra_light::Light;
use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Number, Value};

use crate::cut_short::CutShort;
use crate::device::{DeviceError, LabDevice};
use crate::error::LabError;
use crate::limits::End;
use crate::picture::Visibility;
use crate::readback::read_f32_layer;
use crate::stopwatch::{Seen, Stopwatch, clock_rise};

pub use crate::stopwatch::{FrameCount, Timing};

/// A technique with the parameters that a user set.
#[derive(Clone, Debug, PartialEq)]
pub struct TechniqueChoice {
    /// Which technique.
    pub kind: TechniqueKind,
    /// How much it may spend.
    pub quality: Quality,
    /// Keys and values as written, set after what the quality sets; later ones win.
    pub settings: Vec<(String, String)>,
    /// Passes beside its own.
    pub extras: Extras,
}

/// Passes that any technique can have beside its own: what its name ends with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// Masks of half the width and height, interpolated: `+half`.
    pub is_half: bool,
    /// Masks made smooth over frames and pixels, as the library does by default where it is asked to: `+denoised`.
    pub is_denoised: bool,
}

impl Extras {
    const HALF: &str = "+half";
    const DENOISED: &str = "+denoised";

    /// Of masks that are made smooth, and nothing else.
    pub const fn denoised() -> Self {
        Self { is_half: false, is_denoised: true }
    }

    /// A technique's name without its ends, and what these say, in any case and order.
    pub fn split(name: &str) -> (&str, Self) {
        let (mut name, mut extras) = (name, Self::default());
        loop {
            if let Some(head) = without_end(name, Self::HALF).filter(|_| !extras.is_half) {
                (name, extras.is_half) = (head, true);
            } else if let Some(head) = without_end(name, Self::DENOISED).filter(|_| !extras.is_denoised) {
                (name, extras.is_denoised) = (head, true);
            } else {
                return (name, extras);
            }
        }
    }

    /// What a name ends with.
    pub fn suffix(self) -> String {
        let ends = [(self.is_half, Self::HALF), (self.is_denoised, Self::DENOISED)];
        ends.into_iter().filter_map(|(is, end)| is.then_some(end)).collect()
    }
}

/// A name without an end in any case; `None` where it has another.
fn without_end<'n>(name: &'n str, end: &str) -> Option<&'n str> {
    let (head, tail) = name.split_at_checked(name.len().checked_sub(end.len())?)?;
    tail.eq_ignore_ascii_case(end).then_some(head)
}

impl TechniqueChoice {
    /// A technique at its defaults.
    pub fn default_of(kind: TechniqueKind) -> Self {
        Self::of_quality(kind, Quality::Balanced)
    }

    /// A technique that may spend so much.
    pub fn of_quality(kind: TechniqueKind, quality: Quality) -> Self {
        Self { kind, quality, settings: Vec::new(), extras: Extras::default() }
    }

    /// A technique at its defaults, with settings.
    pub fn with_settings(kind: TechniqueKind, settings: Vec<(String, String)>) -> Self {
        Self { settings, ..Self::default_of(kind) }
    }

    /// The same with passes beside its own.
    pub fn with_extras(self, extras: Extras) -> Self {
        Self { extras, ..self }
    }

    /// Name of the technique, with its quality where that is not the default, and its extras: `pcss`, `pcss:fast+half+denoised`.
    pub fn name(&self) -> String {
        let extras = self.extras.suffix();
        match self.quality {
            Quality::Balanced => format!("{}{extras}", self.kind),
            quality => format!("{}:{quality}{extras}", self.kind),
        }
    }

    /// The technique that [`name`](Self::name) names, in any case; `None` where there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        let (name, extras) = Extras::split(name);
        let (kind, quality) = name.split_once(':').map_or((name, None), |(kind, quality)| (kind, Some(quality)));
        let quality = quality.map_or(Some(Quality::default()), Quality::from_name)?;
        let kind = TechniqueKind::from_name(kind).filter(|kind| kind.has_quality(quality))?;
        Some(Self::of_quality(kind, quality).with_extras(extras))
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
            extras: Extras::default(),
        })
    }

    /// The same with masks for shading alone: the part of a light's own irradiance that arrives ([`SampleWeights::Irradiance`]), where the
    /// technique has it and no setting says otherwise.
    pub fn for_shading(&self) -> Self {
        let (key, irradiance) = (SampleWeights::KEY, SampleWeights::Irradiance.to_string());
        let is_set = self.settings.iter().any(|(set, _)| set == key);
        if is_set || !SampleWeights::is_parameter_of(self.kind.param_specs()) {
            return self.clone();
        }
        let weights = [(key.to_owned(), irradiance)];
        Self { settings: self.settings.iter().cloned().chain(weights).collect(), ..self.clone() }
    }

    /// The settings as they would be given to `compare` or `bench`: ` --set pcss.map_size=2048`.
    pub fn as_arguments(&self) -> String {
        self.settings.iter().map(|(key, value)| format!(" --set {}.{key}={value}", self.name())).collect()
    }
}

/// A technique that still lacks room after so many frames that made more will not find it.
const MOST_OVERFLOWS: u32 = 8;

/// A pass's time over the timed frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

impl Timings {
    /// What stands beside its times.
    pub fn count(&self) -> FrameCount {
        FrameCount { frames: self.frames, warm_up: self.warm_up }
    }
}

/// What a technique drew.
#[derive(Debug)]
pub struct Drawn {
    /// The mask.
    pub visibility: Visibility,
    /// GPU memory that the technique takes for the light, bytes.
    pub memory_bytes: u64,
    /// Texels along a side of each map whose size is `auto`; none where sizes are given.
    pub auto_map_sizes: Vec<u32>,
}

/// Time before a technique's first result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StartUp {
    /// Making its pipelines, milliseconds: those that no technique before it has made on this device.
    pub compile_ms: f64,
    /// Its first frame, milliseconds, in which drivers compile what they put off, and memory is made.
    pub first_frame_ms: f64,
}

/// What a technique gave.
#[derive(Debug)]
pub struct TechniqueRun {
    /// The mask.
    pub visibility: Visibility,
    /// Its times.
    pub timings: Timings,
    /// GPU memory that the technique takes for the light, bytes.
    pub memory_bytes: u64,
    /// Texels along a side of each map whose size is `auto`; none where sizes are given.
    pub auto_map_sizes: Vec<u32>,
    /// Time before its first result.
    pub start_up: StartUp,
    /// The technique's limit, seconds, where fewer frames are timed because of it.
    pub cut_short_s: Option<f64>,
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
    technique.set_denoise(choice.extras.is_denoised.then(Denoise::default));
    technique.set_half_resolution(choice.extras.is_half);
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

/// Draws a light's mask: once, or so many times where it changes from frame to frame. Frames that lacked room are not
/// counted, and the mask is never theirs: pictures are exact.
///
/// # Errors
/// Where the technique cannot be prepared or finds no room, or the device fails.
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

/// The same, given up at an end.
///
/// # Errors
/// As [`draw`], and where the end comes first.
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

/// Runs a technique: its programs are compiled, frames are drawn until nothing is new any more ([`Timing`] says how many at
/// least), and those that follow are timed. Frames that lacked room are not counted. The mask is that of the frame up to which
/// as many were drawn as are asked for, so that what adds up over frames is as often added up on any machine; or of the last,
/// where time ran out before.
///
/// # Errors
/// Where the technique cannot be prepared or finds no room, the device fails, or the end that `timing` sets comes before a frame that
/// counts.
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
    // The error of what is denoised depends on how many frames it has seen, so that all of them are drawn.
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

/// What is said of a technique whose end came before a result.
pub(crate) fn cut_short(technique: &AnyShadow, end: Option<End>, began: Instant, frames: u32) -> LabError {
    let (limit, seconds) = (end.and_then(|end| end.limit), began.elapsed().as_secs_f64());
    LabError::CutShort { technique: technique.kind(), cut: CutShort { limit, seconds, frames } }
}

/// GPU memory that one light takes, bytes: what it retains, and what it would share with others.
fn memory_of(lab: &LabDevice, technique: &AnyShadow) -> u64 {
    technique.memory_bytes() + lab.gpu().memory_bytes().shared
}

/// Observer of frames as they are drawn, which decides when there are enough.
trait Audience {
    /// The frames so far lacked room: they do not count.
    fn begin_anew(&mut self);
    /// Whether there are enough.
    fn is_done(&self) -> bool;
    /// One more is drawn.
    fn see(&mut self, frame: FrameTimes) -> Result<(), LabError>;
}

/// So many frames.
struct Counted {
    frames: u32,
    drawn: u32,
    end: Option<End>,
}

impl Audience for Counted {
    fn begin_anew(&mut self) {
        self.drawn = 0;
    }
    fn is_done(&self) -> bool {
        self.drawn >= self.frames || self.end.is_some_and(|end| end.is_past())
    }
    fn see(&mut self, _: FrameTimes) -> Result<(), LabError> {
        self.drawn += 1;
        Ok(())
    }
}

/// As many as a stopwatch takes, their times, and the mask after so many as were asked for.
struct Timed<'a> {
    lab: &'a LabDevice,
    mask: &'a Mask,
    watch: Stopwatch,
    asked_for: usize,
    /// Drawn in any case.
    least: usize,
    frames: Vec<FrameTimes>,
    visibility: Option<Visibility>,
}

impl Audience for Timed<'_> {
    fn begin_anew(&mut self) {
        self.watch.begin_anew();
        self.frames.clear();
        self.visibility = None;
    }
    fn is_done(&self) -> bool {
        (self.watch.is_done() && self.frames.len() >= self.least) || self.watch.is_over()
    }
    fn see(&mut self, frame: FrameTimes) -> Result<(), LabError> {
        self.watch.see(Seen { ms: frame.processor_ms + frame.submit_to_done_ms, has_made: frame.has_made });
        self.frames.push(frame);
        if self.frames.len() == self.asked_for {
            self.visibility = Some(read_mask(self.lab, self.mask)?);
        }
        Ok(())
    }
}

/// Draws frames one after the other, each waited for, for as long as they are wanted.
fn draw_frames(
    lab: &LabDevice,
    technique: &mut AnyShadow,
    frame: &Frame<'_>,
    mut timer: Option<&mut PassTimer>,
    audience: &mut impl Audience,
) -> Result<(), LabError> {
    let gpu = lab.gpu();
    let kind = technique.kind();
    let mut overflows = 0;
    loop {
        let made_before = gpu.objects_made();
        let prepare_began = Instant::now();
        let work = technique.prepare(frame)?;
        let prepare_ms = prepare_began.elapsed().as_secs_f64() * 1e3;
        // What `prepare` learns is of the frame before.
        if let Some(overflow) = work.overflow() {
            overflows += 1;
            if overflows > MOST_OVERFLOWS {
                return Err(LabError::NoRoom { technique: kind, overflow });
            }
            audience.begin_anew();
        }
        if audience.is_done() {
            return Ok(());
        }
        let mut times = one_frame(lab, work, timer.as_deref_mut())?;
        times.processor_ms += prepare_ms;
        times.has_made = gpu.objects_made() != made_before;
        audience.see(times)?;
    }
}

/// What there is among casters, by which programs differ.
fn kinds_of(casters: &Casters<'_>) -> WarmUp {
    let Casters::Meshes(meshes) = casters else { return WarmUp::default() };
    WarmUp {
        masked: meshes.iter().any(|mesh| !matches!(mesh.opacity, Opacity::Opaque) && !mesh.opacity.tints()),
        tinted: meshes.iter().any(|mesh| mesh.opacity.tints()),
    }
}

/// A mask of as many channels as a technique writes of these casters.
pub(crate) fn mask_for(lab: &LabDevice, technique: &AnyShadow, casters: &Casters<'_>, size_px: UVec2) -> Mask {
    let is_colored = technique.params().any(|(spec, value)| spec.colors_mask(value));
    let channels = if is_colored { MaskChannels::Three } else { casters.mask_channels() };
    Mask::with_channels(&lab.device, size_px, channels)
}

/// Draws one frame as a host does, without timing, and reads the mask; whether the frame before lacked room is said too,
/// since no host draws a frame again for that.
///
/// # Errors
/// Where the technique cannot be prepared, or the device fails.
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
    /// It made objects of the library's.
    has_made: bool,
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
    Ok(FrameTimes { passes, submit_to_done_ms, processor_ms, has_made: false })
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
    fn names_are_read_as_they_are_written() {
        for kind in TechniqueKind::ALL.iter().copied() {
            for quality in Quality::ALL.into_iter().filter(|quality| kind.has_quality(*quality)) {
                for (is_half, is_denoised) in [(false, false), (true, false), (false, true), (true, true)] {
                    let extras = Extras { is_half, is_denoised };
                    let choice = TechniqueChoice::of_quality(kind, quality).with_extras(extras);
                    assert_eq!(TechniqueChoice::from_name(&choice.name()), Some(choice.clone()));
                    assert_eq!(TechniqueChoice::from_name(&choice.name().to_uppercase()), Some(choice));
                }
            }
        }
        let both = Extras { is_half: true, is_denoised: true };
        assert_eq!(Extras::split("pcss+denoised+half"), ("pcss", both));
        assert_eq!(
            ["pscs", "pcss:", "pcss:quick", "+denoised", "+half", "pcss+half+half", "pcss:paper", ""]
                .map(TechniqueChoice::from_name),
            [const { None }; 8]
        );
    }

    #[test]
    fn masks_for_shading_are_by_irradiance_unless_someone_says_otherwise() {
        let irradiance = [("weights".to_owned(), "irradiance".to_owned())];
        for kind in TechniqueKind::ALL.iter().copied() {
            let choice = TechniqueChoice::default_of(kind);
            let has_it = matches!(kind, TechniqueKind::RayTraced | TechniqueKind::SampleBased | TechniqueKind::Smrt);
            assert_eq!(choice.for_shading().settings, &irradiance[..usize::from(has_it)], "{kind}");
        }
        let settings = [("samples", "8"), ("weights", "emission")].map(|(key, value)| (key.into(), value.into()));
        let set = TechniqueChoice::with_settings(TechniqueKind::Smrt, settings.to_vec());
        assert_eq!(set.for_shading(), set);
    }

    #[test]
    fn medians_are_by_label() {
        let frame = |a, b| FrameTimes {
            passes: Some(vec![PassTime { label: "a", ms: a }, PassTime { label: "b", ms: b }]),
            submit_to_done_ms: 9.0,
            processor_ms: a,
            has_made: false,
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
        let frame = FrameTimes { passes, submit_to_done_ms: 9.0, processor_ms: 0.0, has_made: false };
        let timings = medians(&[frame], 1, true);
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
        let frame = |ms| FrameTimes { passes: None, submit_to_done_ms: ms, processor_ms: 0.0, has_made: false };
        let timings = medians(&[frame(4.0), frame(8.0)], 0, true);
        assert!(timings.passes.is_empty());
        assert_eq!((timings.total_ms, timings.clock), (6.0, Clock::SubmitToDone));
    }
}
