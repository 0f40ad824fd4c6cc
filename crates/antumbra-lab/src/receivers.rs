//! Receivers of `antumbra-render`, rendered and waited for, with readback on demand.

use std::ops::Deref;
use std::time::Instant;

use antumbra_render::receivers;
pub use antumbra_render::receivers::Layer;
use antumbra_scene::Camera;
use glam::{UVec2, Vec2, Vec3, Vec4};

use crate::device::{DeviceError, LabDevice};
use crate::gpu_scene::GpuScene;
use crate::readback::{read_f32, read_rgba32f};
use crate::stopwatch::{FrameCount, Seen, Stopwatch, Timing, clock_rise};
use crate::technique_run::median;
use crate::truth::SurfacePoint;

/// The images of one layer, drawn.
#[derive(Clone, Debug)]
pub struct ReceiverImages(receivers::ReceiverImages);

impl Deref for ReceiverImages {
    type Target = receivers::ReceiverImages;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl ReceiverImages {
    /// As the renderer takes them.
    pub fn into_inner(self) -> receivers::ReceiverImages {
        self.0
    }

    /// World positions by pixel, in single precision and operation by operation as the library's shaders have them;
    /// `None` for background.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn read_shader_positions(&self, lab: &LabDevice) -> Result<Vec<Option<Vec3>>, DeviceError> {
        Ok(self.shader_positions(&read_f32(lab, &self.depth)?))
    }

    /// World positions by pixel, rebuilt from depth; `None` where there is nothing. `width · height` of them.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn read_positions(&self, lab: &LabDevice) -> Result<Vec<Option<Vec3>>, DeviceError> {
        Ok(self.positions(&read_f32(lab, &self.depth)?))
    }

    /// What is drawn at each pixel: positions rebuilt from depth, with the normals; `None` where there is nothing.
    ///
    /// # Errors
    /// Where the device failed.
    pub fn read_surface_points(&self, lab: &LabDevice) -> Result<Vec<Option<SurfacePoint>>, DeviceError> {
        let normals = read_rgba32f(lab, &self.geometric_normal)?;
        let point = |(position, normal): (Option<Vec3>, [f32; 4])| {
            position.map(|position| SurfacePoint { position, normal: Vec4::from(normal).truncate() })
        };
        Ok(self.read_positions(lab)?.into_iter().zip(normals).map(point).collect())
    }
}

/// The pass that draws them.
#[derive(Debug)]
pub struct ReceiverPass(receivers::ReceiverPass);

impl ReceiverPass {
    /// Makes the pipelines.
    pub fn new(lab: &LabDevice) -> Self {
        Self(receivers::ReceiverPass::new(lab))
    }

    /// Draws a layer of `scene` and waits for it, to know what is seen. `size_px` must be positive and within the
    /// device's largest texture.
    ///
    /// # Errors
    /// Where the device failed.
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

    /// The same, shifted by a part of a pixel, without waiting and without what is seen: for pictures alone.
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

    /// Draws a layer again and again: the median time from submission to completion, milliseconds, by the processor's clock, and of
    /// how many drawings it is.
    ///
    /// # Errors
    /// Where the device failed.
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
        // One is always timed.
        let has_ended = |watch: &Stopwatch| watch.is_done() || (watch.is_over() && watch.has_timed());
        while !has_ended(&watch) {
            let mut encoder =
                lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("receivers") });
            self.0.record(lab, &mut encoder, scene, &groups, images, layer);
            let began = Instant::now();
            lab.queue.submit([encoder.finish()]);
            lab.check()?;
            let ms = began.elapsed().as_secs_f64() * 1e3;
            watch.see(Seen { ms, has_made: false });
            times_ms.push(ms);
        }
        let timed = times_ms.split_off(watch.warm_up() as usize);
        let count = FrameCount { frames: timed.len() as u32, warm_up: watch.warm_up() };
        Ok((median(timed), count))
    }
}

#[cfg(test)]
mod tests;
