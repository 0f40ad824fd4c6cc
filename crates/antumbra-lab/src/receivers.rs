//! Receivers of `antumbra-render`: rendered synchronously, with readback on demand.

use std::ops::Deref;
use std::time::Instant;

use antumbra_render::receivers;
pub use antumbra_render::receivers::Layer;
use antumbra_scene::Camera;
use glam::{UVec2, Vec2, Vec3, Vec4};

use crate::device::{DeviceError, LabDevice};
use crate::gpu_scene::GpuScene;
use crate::readback::{read_f32, read_rgba32f};
use crate::stopwatch::{FrameCount, FrameMeasurement, Stopwatch, Timing, clock_rise};
use crate::technique_run::median;
use crate::truth::SurfacePoint;

/// Rendered images of one layer.
#[derive(Clone, Debug)]
pub struct ReceiverImages(receivers::ReceiverImages);

impl Deref for ReceiverImages {
    type Target = receivers::ReceiverImages;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl ReceiverImages {
    /// Returns the renderer's type.
    pub fn into_inner(self) -> receivers::ReceiverImages {
        self.0
    }

    /// Reads the world position of each pixel, in single precision with the same operations as the
    /// library's shaders; `None` for background.
    ///
    /// # Errors
    /// If the device fails.
    pub fn read_shader_positions(&self, lab: &LabDevice) -> Result<Vec<Option<Vec3>>, DeviceError> {
        Ok(self.shader_positions(&read_f32(lab, &self.depth)?))
    }

    /// Reads the world position of each of `width · height` pixels, reconstructed from depth; `None` for background.
    ///
    /// # Errors
    /// If the device fails.
    pub fn read_positions(&self, lab: &LabDevice) -> Result<Vec<Option<Vec3>>, DeviceError> {
        Ok(self.positions(&read_f32(lab, &self.depth)?))
    }

    /// Reads the surface at each pixel: position reconstructed from depth, and normal; `None` for background.
    ///
    /// # Errors
    /// If the device fails.
    pub fn read_surface_points(&self, lab: &LabDevice) -> Result<Vec<Option<SurfacePoint>>, DeviceError> {
        let normals = read_rgba32f(lab, &self.geometric_normal)?;
        let point = |(position, normal): (Option<Vec3>, [f32; 4])| {
            position.map(|position| SurfacePoint { position, normal: Vec4::from(normal).truncate() })
        };
        Ok(self.read_positions(lab)?.into_iter().zip(normals).map(point).collect())
    }
}

/// Render pass of the receiver images.
#[derive(Debug)]
pub struct ReceiverPass(receivers::ReceiverPass);

impl ReceiverPass {
    /// Creates the pipelines.
    pub fn new(lab: &LabDevice) -> Self {
        Self(receivers::ReceiverPass::new(lab))
    }

    /// Renders a layer of `scene`, waits for it, and records the visible positions. `size_px` must be positive and
    /// within the device's maximum texture size.
    ///
    /// # Errors
    /// If the device fails.
    pub fn render(
        &self,
        lab: &LabDevice,
        scene: &GpuScene,
        camera: &Camera,
        size_px: UVec2,
        layer: Layer,
    ) -> Result<ReceiverImages, DeviceError> {
        let mut images = self.render_shifted(lab, scene, camera, size_px, layer, Vec2::ZERO);
        let seen: Vec<Vec3> = images.read_positions(lab)?.into_iter().flatten().collect();
        images.0.note_seen(&seen);
        Ok(images)
    }

    /// Renders shifted by a fraction of a pixel, without waiting and without visible positions: for images only.
    pub(crate) fn render_shifted(
        &self,
        lab: &LabDevice,
        scene: &GpuScene,
        camera: &Camera,
        size_px: UVec2,
        layer: Layer,
        offset_px: Vec2,
    ) -> ReceiverImages {
        let mut images = ReceiverImages(receivers::ReceiverImages::new(&lab.device, camera, size_px));
        images.0.shift(offset_px);
        let groups = self.0.draw_groups(lab, scene);
        let mut encoder =
            lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("receivers") });
        self.0.record(lab, &mut encoder, scene, &groups, &images, layer);
        lab.queue.submit([encoder.finish()]);
        images
    }

    /// Renders a layer repeatedly. Returns the median time from submission to completion, milliseconds, on the
    /// CPU's clock, and the number of frames.
    ///
    /// # Errors
    /// If the device fails.
    pub fn time(
        &self,
        lab: &LabDevice,
        scene: &GpuScene,
        images: &ReceiverImages,
        layer: Layer,
        timing: &Timing,
    ) -> Result<(f64, FrameCount), DeviceError> {
        let groups = self.0.draw_groups(lab, scene);
        let (mut watch, mut times_ms) = (Stopwatch::new(*timing, clock_rise(lab.adapter.is_software())), Vec::new());
        // At least one frame is timed.
        let has_ended = |watch: &Stopwatch| watch.is_done() || (watch.is_over() && watch.has_timed());
        while !has_ended(&watch) {
            let mut encoder =
                lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("receivers") });
            self.0.record(lab, &mut encoder, scene, &groups, images, layer);
            let began = Instant::now();
            lab.queue.submit([encoder.finish()]);
            lab.check()?;
            let ms = began.elapsed().as_secs_f64() * 1e3;
            watch.see(FrameMeasurement { ms, has_made: false });
            times_ms.push(ms);
        }
        let timed = times_ms.split_off(watch.warm_up() as usize);
        let count = FrameCount { frames: timed.len() as u32, warm_up: watch.warm_up() };
        Ok((median(timed), count))
    }
}

#[cfg(test)]
mod tests;
