//! Drawing of a frame in steps: receivers, sides, antialiasing, output image.

use antumbra::WarmUp;
use antumbra_render::drawn_texture;
use antumbra_render::receivers::{Layer, ReceiverImages};
use antumbra_render::shading::Shading;
use glam::{UVec2, Vec3};

use super::antialiasing::{Smoothed, Still, StillSide};
use super::loaded_scene::EXPOSURE_POINTS;
use super::present::{OUTPUT_FORMAT, Shown, SideImages, upload_f32};
use super::side::{SideFrame, SideWork};
use super::texture_reader::TextureReader;
use super::{DrawnFrom, Renderer, View};
use crate::state::{Show, Side, State};
use crate::truth::Estimate;

/// Frames drawn after a change: one that may overflow, one that reads the overflow back, one with enough room.
pub(super) const SETTLING_FRAMES: u32 = 3;
/// Maximum number of further frames until a warmed-up frame has been timed.
const WARMING_FRAMES: u32 = 8;

impl Renderer {
    /// Creates the images for a new size.
    pub(super) fn fit_size(&mut self, state: &State, size_px: UVec2) {
        if self.view.as_ref().is_some_and(|view| view.images.size_px == size_px) {
            return;
        }
        let Some(scene) = &self.scene else { return };
        let device = self.gpu.device();
        let images = || ReceiverImages::new(device, &state.setup.camera, size_px);
        let output = drawn_texture(device, "viewer: output", OUTPUT_FORMAT, size_px);
        let camera_version = self.view.as_ref().map_or(0, |view| view.camera_version);
        self.view = Some(View {
            behind: scene.scene.has_translucent_surfaces().then(images),
            images: images(),
            smoothed: None,
            output_view: output.create_view(&wgpu::TextureViewDescriptor::default()),
            output,
            camera: None,
            camera_version,
            seen_version: None,
            depths: Vec::new(),
            depth_reader: TextureReader::default(),
        });
        for side in &mut self.sides {
            side.resize(&self.gpu, size_px);
        }
        (self.drawn, self.shown) = (None, None);
    }

    pub(super) fn draw_receivers(&mut self, state: &State) {
        let (Some(scene), Some(view)) = (&self.scene, &mut self.view) else { return };
        let camera = state.setup.camera;
        if view.camera == Some(camera) {
            return;
        }
        view.camera = Some(camera);
        view.camera_version += 1;
        view.seen_version = None;
        let bounds = Some(scene.scene.bounds).filter(|bounds| !bounds.is_empty());
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("viewer: receivers") });
        let layers = [(Some(&mut view.images), Layer::FirstHits), (view.behind.as_mut(), Layer::BehindTranslucent)];
        for (images, layer) in layers {
            if let Some(images) = images {
                images.look_from(&camera, bounds);
                self.receivers.record(&self.gpu, &mut encoder, &scene.scene, &scene.groups, images, layer);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
    }

    /// Collects completed readbacks, compiled techniques and times.
    pub(super) fn collect(&mut self, state: &State) {
        if let (Some(scene), Some(view)) = (&mut self.scene, &mut self.view)
            && let Some(texels) = view.depth_reader.take()
            && texels.version == view.camera_version
        {
            view.depths = texels.f32s();
            let seen: Vec<Vec3> = view.images.positions(&view.depths).into_iter().flatten().collect();
            view.images.note_seen(&seen);
            view.seen_version = Some(view.camera_version);
            if !scene.is_exposed && !seen.is_empty() {
                scene.exposure = seen.iter().copied().step_by(seen.len().div_ceil(EXPOSURE_POINTS)).collect();
                scene.is_exposed = true;
            }
            self.drawn = None;
        }
        let what = self.scene.as_ref().map_or(WarmUp::default(), |scene| scene.what);
        for (side, work) in self.drawn_sides(state).iter().zip(&mut self.sides) {
            if work.collect(&self.gpu) {
                self.drawn = None;
            }
            work.request(&self.gpu, side, what, &self.compile);
        }
    }

    /// Returns the sides with the parameters for drawing: ratio masks in *shaded* while no pixel is inspected, visibility otherwise.
    fn drawn_sides(&self, state: &State) -> Vec<Side> {
        let is_picture = state.show == Show::Shaded && self.pointer_px.is_none();
        let drawn = |side: &Side| if is_picture { side.for_shading() } else { side.clone() };
        state.shown_sides().iter().map(drawn).collect()
    }

    /// Draws the sides if any of their inputs has changed or their feedback has not settled.
    pub(super) fn draw_sides(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State) -> bool {
        let (Some(scene), Some(view)) = (&self.scene, &self.view) else { return false };
        let from = DrawnFrom {
            generation: scene.generation,
            pose: scene.pose,
            size_px: view.images.size_px,
            camera: state.setup.camera,
            is_seen: view.seen_version == Some(view.camera_version),
            is_exposed: scene.is_exposed,
            lights: state.setup.lights.clone(),
            sides: self.drawn_sides(state),
            ready: self.sides.iter().filter(|side| side.kind().is_some()).count() as u64,
        };
        let frames = match &self.drawn {
            Some((drawn, frames)) if *drawn == from => *frames,
            _ => 0,
        };
        if frames >= self.wanted_frames() {
            return false;
        }
        let lights = &state.setup.lights;
        let shading =
            Shading::new(&self.gpu, &self.programs, &view.images, view.behind.clone(), lights, &scene.exposure);
        let frame = SideFrame { scene: &scene.scene, images: &view.images, shading: &shading, lights };
        for (side, work) in from.sides.iter().zip(&mut self.sides) {
            work.draw(&self.gpu, encoder, side, &frame);
        }
        self.version += 1;
        // Another attempt would fail, too.
        let is_refused = self.sides.iter().any(|work| work.problem().is_some());
        self.drawn = Some((from, if is_refused { SETTLING_FRAMES + WARMING_FRAMES } else { frames + 1 }));
        true
    }

    /// Adds to the antialiased images while *shaded* is shown and static, until they are complete.
    pub(super) fn smooth(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State) -> bool {
        let wanted = self.wanted_frames();
        let is_still = self.drawn.as_ref().is_some_and(|(_, frames)| *frames >= wanted);
        let (Some(scene), Some(view)) = (&self.scene, &mut self.view) else { return false };
        if !is_still || state.show != Show::Shaded || view.depth_reader.is_pending() {
            return false;
        }
        let shown = state.shown_sides().len();
        let sides: Option<Vec<StillSide<'_>>> = self.sides[..shown].iter().map(SideWork::still).collect();
        let Some(sides) = sides else { return false };
        let camera = &state.setup.camera;
        let smoothed = view
            .smoothed
            .get_or_insert_with(|| Smoothed::new(&self.gpu, camera, view.images.size_px, view.behind.is_some()));
        let still = Still {
            receivers: &self.receivers,
            programs: &self.programs,
            scene: &scene.scene,
            groups: &scene.groups,
            images: &view.images,
            camera,
            lights: &state.setup.lights,
            exposure: &scene.exposure,
            version: self.version,
        };
        self.antialiasing.record(&self.gpu, encoder, smoothed, &still, &sides)
    }

    /// Number of frames to draw after a change.
    pub(super) fn wanted_frames(&self) -> u32 {
        let is_cold = self.sides.iter().any(|side| side.kind().is_some() && side.times.counts().0 == 0);
        SETTLING_FRAMES + if is_cold { WARMING_FRAMES } else { 0 }
    }

    /// Prepares and records the left side's masks without submitting them. Returns the reason if that fails.
    #[cfg(test)]
    pub(super) fn record_only(&mut self, state: &State) -> Result<(), String> {
        let (Some(scene), Some(view)) = (&self.scene, &self.view) else { return Err("no scene is open".into()) };
        let lights = &state.setup.lights;
        let shading = Shading::new(&self.gpu, &self.programs, &view.images, None, lights, &scene.exposure);
        let frame = SideFrame { scene: &scene.scene, images: &view.images, shading: &shading, lights };
        self.sides[0].masks_commands(&self.gpu, &state.sides[0], &frame).map(drop)
    }

    /// Draws the output image if a side or the view has changed.
    pub(super) fn draw_output(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        state: &State,
        truth: Option<&Estimate>,
    ) -> bool {
        let held = truth.map(|truth| (truth.job, truth.points));
        if held != self.truth {
            self.truth = held;
            self.truth_view = match truth {
                Some(truth) => upload_f32(&self.gpu, "truth", truth.size_px, &truth.values),
                None => upload_f32(&self.gpu, "no truth", UVec2::ONE, &[-1.0]),
            };
        }
        let Some(view) = &self.view else { return false };
        let width = view.images.size_px.x;
        let divider_px = if state.is_split { (state.divider.clamp(0.0, 1.0) * width as f32) as u32 } else { width };
        let shown = Shown { divider_px, show: state.show };
        let truth_version = held.map_or(0, |(job, points)| job << 32 | u64::from(points));
        let smooth = [0, 1].map(|side| view.smoothed.as_ref().and_then(|all| all.picture(side, self.version)));
        let of_light = self.version << 8 | state.light as u64;
        let of = [of_light, truth_version, state.level as u64, state.layer as u64, smooth[0].is_some().into()];
        if self.shown == Some((shown, of)) {
            return false;
        }
        let light = state.light;
        if state.show == Show::LightMap {
            let [left, right] = [0, 1].map(|side| self.sides[side].shown_maps(light, state.level, state.layer));
            let (size_px, output) = (view.images.size_px, &view.output_view);
            self.light_map.record(&self.gpu, encoder, [&left, &right], divider_px, output, size_px);
            self.shown = Some((shown, of));
            return true;
        }
        if state.show == Show::Lists {
            let [left, right] = [0, 1].map(|side| self.sides[side].drawn_lists(light));
            let (size_px, output) = (view.images.size_px, &view.output_view);
            let level = state.level;
            let totals = self.lists.record(&self.gpu, encoder, [&left, &right], level, divider_px, output, size_px);
            for (side, totals) in self.sides.iter_mut().zip(totals) {
                side.read_list_totals(&self.gpu, encoder, totals.as_ref());
            }
            self.shown = Some((shown, of));
            return true;
        }
        let Some(left) = self.sides[0].mask(light) else { return false };
        let left = SideImages { picture: smooth[0].unwrap_or(self.sides[0].picture()), mask: left };
        let right = match self.sides[1].mask(light) {
            Some(mask) if state.is_split => SideImages { picture: smooth[1].unwrap_or(self.sides[1].picture()), mask },
            _ => left,
        };
        self.present.record(&self.gpu, encoder, shown, [left, right], &self.truth_view, &view.output_view);
        self.shown = Some((shown, of));
        true
    }
}
