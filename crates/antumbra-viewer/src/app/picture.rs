//! The image in the window: the state drawn at the window's size, the ground truth, and the text over it.

use std::time::Duration;

use glam::UVec2;

use super::App;
use crate::state::Show;
use crate::truth::Job;
use crate::ui;

/// Interval at which unfinished GPU work is polled.
const SOON: Duration = Duration::from_millis(15);

impl App {
    /// Draws the state at the size of the space that the panels leave.
    pub(super) fn draw(&mut self, ui: &egui::Ui) {
        let points = ui.available_size();
        let pixels = points * ui.ctx().pixels_per_point();
        let largest = self.render_state.device.limits().max_texture_dimension_2d;
        let size_px =
            UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32).clamp(UVec2::ONE, UVec2::splat(largest));
        self.size_px = size_px;
        if let Some(framing) = self.unframed.take() {
            let camera = framing.camera(size_px.x as f32 / size_px.y as f32);
            self.state.setup.camera = camera.relative_to(self.state.anchor);
        }
        self.ask_for_truth();
        let estimate = self.truth.estimate();
        self.renderer.inspect(self.asked_px);
        let drawn = self.renderer.draw(&self.state, size_px, estimate);
        self.take_output();
        if let Some(error) = self.renderer.take_error() {
            self.complain(format!("the graphics device reports: {error}"));
        }
        self.read_masks();
        self.save_picture();
        self.advance_screenshot(ui.ctx(), drawn.is_unfinished || self.is_posing());
        // Panels were laid out before this frame was drawn, so one more frame after the last one updates them.
        let was_unfinished = std::mem::replace(&mut self.was_unfinished, drawn.is_unfinished);
        if self.state.is_moving() {
            ui.ctx().request_repaint();
        } else if drawn.is_unfinished || was_unfinished || self.screenshot.is_some() {
            ui.ctx().request_repaint_after(SOON);
        }
    }

    /// Shows the image and the text over it.
    pub(super) fn show_picture(&mut self, ui: &mut egui::Ui) {
        let texture = self.texture.as_ref().map(|(_, id)| *id);
        let map_line = |side: usize| {
            let side = &self.renderer.sides[side];
            match self.state.show {
                Show::LightMap => side.map_line(self.state.light, self.state.level, self.state.layer),
                Show::Lists => side.lists_line(self.state.light, self.state.level),
                _ => None,
            }
        };
        let map_lines = [map_line(0), map_line(1)];
        let pointer = ui::show_picture(ui, &mut self.state, texture, map_lines).filter(|_| self.panels.is_inspecting);
        let pixel = |unit: glam::Vec2| (unit * self.size_px.as_vec2()).as_uvec2().min(self.size_px - 1);
        let asked = pointer.map(|pointer| pixel(pointer.unit));
        if asked != self.asked_px {
            // The next frame reads this pixel.
            ui.ctx().request_repaint();
        }
        self.asked_px = asked;
        if let (Some(pointer), Some(inspected)) = (pointer, self.renderer.inspected()) {
            let place = (inspected.pixel.y * self.size_px.x + inspected.pixel.x) as usize;
            let truth = self.truth.estimate().filter(|estimate| estimate.size_px == self.size_px);
            let truth = truth.and_then(|estimate| estimate.values.get(place).copied());
            ui::inspector(ui.ctx(), &self.state, pointer.place, &inspected, truth);
        }
    }

    /// Registers the renderer's output with egui if its texture has changed.
    fn take_output(&mut self) {
        let Some(view) = self.renderer.output() else { return };
        if self.texture.as_ref().is_some_and(|(held, _)| held == view) {
            return;
        }
        let mut egui_renderer = self.render_state.renderer.write();
        if let Some((_, old)) = self.texture.take() {
            egui_renderer.free_texture(&old);
        }
        let device = &self.render_state.device;
        let id = egui_renderer.register_native_texture(device, view, wgpu::FilterMode::Linear);
        self.texture = Some((view.clone(), id));
    }

    fn wants_truth(&self) -> bool {
        self.state.show.needs_truth() || self.panels.is_inspecting
    }

    /// Requests the ground truth while it is shown and nothing moves.
    fn ask_for_truth(&mut self) {
        let scene = self.scene.as_ref().filter(|_| self.wants_truth() && !self.state.is_moving() && !self.is_posing());
        let job = scene.map(|scene| Job {
            scene: scene.clone(),
            camera: self.state.setup.camera,
            size_px: self.size_px,
            light: self.state.setup.lights[self.state.light].clone(),
        });
        self.truth.want(job);
        if let Some(problem) = self.truth.problem.take() {
            self.complain(problem);
        }
    }

    /// Reads the masks that are compared with the ground truth, once per drawn version.
    fn read_masks(&mut self) {
        if !self.state.show.needs_truth() {
            self.masks = [None, None];
            return;
        }
        for (side, mask) in self.masks.iter_mut().enumerate() {
            if let Some(read) = self.renderer.take_mask(side, self.state.light) {
                *mask = Some(read);
            }
        }
        let version = self.renderer.version();
        let shown = self.state.shown_sides().len();
        let is_stale = self.masks[..shown].iter().any(|mask| mask.as_ref().is_none_or(|(read, _)| *read != version));
        let is_reading = self.renderer.sides.iter().any(|side| side.mask_reader.is_waiting());
        if is_stale && !is_reading && self.state.scene.is_some() {
            self.renderer.read_masks(&self.state);
        }
    }
}
