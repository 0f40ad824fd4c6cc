//! Readback of depths, the inspected pixel, the output image and masks.

use antumbra::contract::MaskChannels;
use glam::UVec2;

use super::Renderer;
use super::inspector::Inspected;
use super::texture_reader::Texels;
use crate::state::State;

impl Renderer {
    /// Whether a readback that this module handles is in flight. Depths trigger another frame once they are taken. Masks
    /// belong to the caller and change nothing.
    pub(super) fn is_reading(&self) -> bool {
        self.view.as_ref().is_some_and(|view| view.depth_reader.is_pending())
            || self.output_reader.is_waiting()
            || self.pixel_reader.is_waiting()
            || self.sides.iter().any(|side| side.mask_reader.is_waiting() || side.are_list_totals_awaited())
    }

    /// Selects the pixel to inspect; `None` ends inspection. [`inspected`](Self::inspected) returns its values.
    pub fn inspect(&mut self, pixel: Option<UVec2>) {
        self.pointer_px = pixel;
    }

    /// Values of the inspected pixel, as last read.
    pub fn inspected(&self) -> Option<Inspected> {
        let ((pixel, _, camera_version), inspected) = self.inspected.as_ref()?;
        let view = self.view.as_ref().filter(|_| self.pointer_px == Some(*pixel))?;
        let mut inspected = inspected.clone();
        if let Some(surface) = &mut inspected.surface
            && view.seen_version == Some(*camera_version)
        {
            let place = (pixel.y * view.images.size_px.x + pixel.x) as usize;
            surface.position = view.depths.get(place).and_then(|depth| view.images.position_at(*pixel, *depth));
        }
        Some(inspected)
    }

    /// Reads the inspected pixel if it or the drawn images have changed.
    pub(super) fn read_pixel(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State) {
        if let Some(read) = self.pixel_reader.take() {
            self.inspected = Some(read);
        }
        let (Some(view), Some(pixel)) = (&self.view, self.pointer_px) else { return };
        let key = (pixel, self.version << 8 | state.light as u64, view.camera_version);
        let is_known = self.inspected.as_ref().is_some_and(|(read, _)| *read == key);
        if is_known || self.pixel_reader.key().is_some() || pixel.cmpge(view.images.size_px).any() {
            return;
        }
        let shown = state.shown_sides().len();
        let masks = [0, 1].map(|side| self.sides[side].mask(state.light).filter(|_| side < shown));
        self.pixel_reader.record(&self.gpu, encoder, key, &view.images, masks);
    }

    /// Reads back the visible depths once the camera is static.
    pub(super) fn read_seen(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let is_still = self.drawn.as_ref().is_some_and(|(_, frames)| *frames > 1);
        let Some(view) = &mut self.view else { return };
        let is_known = view.seen_version == Some(view.camera_version);
        if is_still && !is_known && !view.depth_reader.is_pending() {
            view.depth_reader.record(&self.gpu, encoder, &view.images.depth, view.camera_version);
        }
    }

    /// Starts the readback of the output image for [`take_output`](Self::take_output). `None` before there is one.
    pub fn read_output(&mut self) -> Option<()> {
        let texture = self.output_texture()?.clone();
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("viewer: picture") });
        self.output_reader.record(&self.gpu, &mut encoder, &texture, self.version);
        self.gpu.queue().submit([encoder.finish()]);
        Some(())
    }

    /// Returns the output image once it is read back: four bytes per pixel, sRGB.
    pub fn take_output(&mut self) -> Option<Texels> {
        self.output_reader.take()
    }

    /// Starts the readback of the sides' masks of the selected light for [`take_mask`](Self::take_mask).
    pub fn read_masks(&mut self, state: &State) {
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("viewer: masks") });
        for (_, work) in state.shown_sides().iter().zip(&mut self.sides) {
            if let Some(texture) = work.mask(state.light).map(|mask| mask.texture().clone()) {
                work.mask_reader.record(&self.gpu, &mut encoder, &texture, self.version);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
    }

    /// Returns a side's mask once it is read back, with its version: visibility by pixel, averaged over channels.
    pub fn take_mask(&mut self, side: usize, light: usize) -> Option<(u64, Vec<f32>)> {
        let channels = self.sides[side].mask(light)?.channels();
        let texels = self.sides[side].mask_reader.take()?;
        let values = match channels {
            MaskChannels::One => texels.f32s(),
            MaskChannels::Three => texels.mean_of_half_rgb(),
        };
        Some((texels.version, values))
    }
}
