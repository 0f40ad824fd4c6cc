//! Frames of a technique: drawn synchronously one after the other until an observer has enough.

use std::time::Instant;

use antumbra::{AnyShadow, Frame, Mask, MaskChannels, PassTime, PassTimer, Prepared, Recorder};
use glam::Vec3;

use super::timings::FrameTimes;
use crate::device::{DeviceError, LabDevice};
use crate::error::LabError;
use crate::limits::End;
use crate::picture::Visibility;
use crate::readback::read_f32_layer;
use crate::stopwatch::{FrameMeasurement, Stopwatch};

/// Maximum number of overflows, after each of which lists are enlarged, before a technique fails.
const MAX_OVERFLOWS: u32 = 8;

/// Observer of drawn frames, which decides when there are enough.
pub(super) trait Audience {
    /// Discards the frames so far, because their lists overflowed.
    fn begin_anew(&mut self);
    /// Returns whether there are enough frames.
    fn is_done(&self) -> bool;
    /// Adds a drawn frame.
    fn see(&mut self, frame: FrameTimes) -> Result<(), LabError>;
}

/// Observer that takes a fixed number of frames.
pub(super) struct Counted {
    pub(super) frames: u32,
    pub(super) drawn: u32,
    pub(super) end: Option<End>,
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

/// Observer that takes as many frames as a stopwatch needs, with their times and the mask after the requested number.
pub(super) struct Timed<'a> {
    pub(super) lab: &'a LabDevice,
    pub(super) mask: &'a Mask,
    pub(super) watch: Stopwatch,
    pub(super) asked_for: usize,
    /// Minimum number of frames.
    pub(super) least: usize,
    pub(super) frames: Vec<FrameTimes>,
    pub(super) visibility: Option<Visibility>,
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
        self.watch.see(FrameMeasurement { ms: frame.processor_ms + frame.submit_to_done_ms, has_made: frame.has_made });
        self.frames.push(frame);
        if self.frames.len() == self.asked_for {
            self.visibility = Some(read_mask(self.lab, self.mask)?);
        }
        Ok(())
    }
}

/// Draws frames one after the other, each synchronously, until the observer is done.
pub(super) fn draw_frames(
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
        let made_before = gpu.objects_created();
        let prepare_began = Instant::now();
        let work = technique.prepare(frame)?;
        let prepare_ms = prepare_began.elapsed().as_secs_f64() * 1e3;
        // `prepare` reports the overflow of the previous frame.
        if let Some(overflow) = work.overflow() {
            overflows += 1;
            if overflows > MAX_OVERFLOWS {
                return Err(LabError::NoRoom { technique: kind, overflow });
            }
            audience.begin_anew();
        }
        if audience.is_done() {
            return Ok(());
        }
        let mut times = one_frame(lab, work, timer.as_deref_mut())?;
        times.processor_ms += prepare_ms;
        times.has_made = gpu.objects_created() != made_before;
        audience.see(times)?;
    }
}

/// Reads a mask's visibility, with one channel or three.
pub(super) fn read_mask(lab: &LabDevice, mask: &Mask) -> Result<Visibility, LabError> {
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

pub(super) fn one_frame(
    lab: &LabDevice,
    work: Prepared<'_>,
    mut timer: Option<&mut PassTimer>,
) -> Result<FrameTimes, LabError> {
    let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("technique") });
    let record_began = Instant::now();
    work.record(&mut Recorder::new(&mut encoder, timer.as_deref_mut()));
    let processor_ms = record_began.elapsed().as_secs_f64() * 1e3;
    if let Some(timer) = &timer {
        timer.resolve(&mut encoder);
    }
    // Uploads of `prepare` go with the submission; earlier work must not be timed.
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
