//! The picture of a [`State`], drawn on someone's device: receivers once, each side's masks and shading, then the window's
//! picture of the two.
//!
//! Nothing is drawn that has not changed: each step knows what it was last drawn from. After a change a few frames more are
//! drawn, because techniques that ran out of room learn of it a frame later.

mod antialiasing;
mod inspector;
mod light_map;
mod lists;
mod present;
mod refusals;
mod side;
mod side_readings;
mod texture_reader;
mod times;

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use antumbra::contract::MaskChannels;
use antumbra::{Gpu, WarmUp};
use antumbra_light::Light;
use antumbra_render::drawn_texture;
use antumbra_render::gpu_scene::GpuScene;
use antumbra_render::receivers::{DrawGroups, Layer, ReceiverImages, ReceiverPass};
use antumbra_render::shading::{Shading, ShadingPrograms};
use antumbra_scene::{AlphaMode, Camera, Scene};
use glam::{UVec2, Vec3};

pub use inspector::{Inspected, InspectedSurface};
pub use light_map::MapChoices;
pub use present::{ERROR_RAMP, ERROR_RANGE, NOT_JUDGED_COLOR, OUTPUT_FORMAT};
pub use side::SideWork;
pub use side_readings::SideReadings;
pub use texture_reader::Texels;
pub use times::{FRAMES, FrameTimes, Times};

pub use crate::aside::Wake;
use crate::state::{Show, Side, State};
use crate::truth::Estimate;
use antialiasing::{Antialiasing, Smoothed, Still, StillSide};
use inspector::{Asked, PixelReader};
use light_map::LightMapPass;
use lists::ListsPass;
use present::{Present, Shown, SideImages, upload_f32};
use side::SideFrame;
use texture_reader::TextureReader;

/// When a technique's programs are compiled.
#[derive(Clone)]
pub enum Compile {
    /// Before the call returns.
    AtOnce,
    /// Aside, on a thread where there are any; then whoever draws is woken.
    Aside(Wake),
}

impl fmt::Debug for Compile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtOnce => "AtOnce",
            Self::Aside(_) => "Aside",
        })
    }
}

/// Frames that are drawn after the last change: one that runs out of room, one that learns of it, one that has it.
const SETTLING_FRAMES: u32 = 3;
/// And so many more at most, until one of them was timed that others had warmed up for.
const WARMING_FRAMES: u32 = 8;

/// Points of the scene that lights are exposed to before it is known what the camera sees.
const EXPOSURE_POINTS: usize = 2048;

/// Draws.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    compile: Compile,
    receivers: ReceiverPass,
    programs: ShadingPrograms,
    present: Present,
    antialiasing: Antialiasing,
    light_map: LightMapPass,
    lists: ListsPass,
    scene: Option<LoadedScene>,
    view: Option<View>,
    /// The left side, or the only one, and the right side.
    pub sides: [SideWork; 2],
    /// What the truth texture holds: which tracing, after how many points.
    truth: Option<(u64, u32)>,
    truth_view: wgpu::TextureView,
    /// What the sides were last drawn from, and how many frames of it there were.
    drawn: Option<(DrawnFrom, u32)>,
    shown: Option<(Shown, [u64; 5])>,
    /// Counts what the sides drew.
    version: u64,
    output_reader: TextureReader,
    /// The pixel that is asked about, and what was there when it was last read.
    pointer_px: Option<UVec2>,
    pixel_reader: PixelReader,
    inspected: Option<(Asked, Inspected)>,
    errors: DeviceErrors,
    lost: Arc<Mutex<Option<String>>>,
}

/// What a device has complained about.
pub type DeviceErrors = Arc<Mutex<Vec<String>>>;

#[derive(Debug)]
struct LoadedScene {
    generation: u64,
    /// Counts the times at which it was shown.
    pose: u64,
    scene: GpuScene,
    groups: DrawGroups,
    what: WarmUp,
    /// Where lights are exposed to: what the camera saw when the scene was opened, or else points of its surfaces.
    exposure: Vec<Vec3>,
    is_exposed: bool,
}

/// What depends on the picture's size.
#[derive(Debug)]
struct View {
    images: ReceiverImages,
    behind: Option<ReceiverImages>,
    /// Made when the picture first stands still.
    smoothed: Option<Smoothed>,
    output: wgpu::Texture,
    output_view: wgpu::TextureView,
    /// The camera that the images were drawn from.
    camera: Option<Camera>,
    /// How often the camera has been another one.
    camera_version: u64,
    /// The camera by which it is known what is seen.
    seen_version: Option<u64>,
    /// Of what is seen, by pixel; of the camera whose version is `seen_version`.
    depths: Vec<f32>,
    depth_reader: TextureReader,
}

/// What masks and pictures are drawn from.
#[derive(Clone, Debug, PartialEq)]
struct DrawnFrom {
    generation: u64,
    pose: u64,
    size_px: UVec2,
    camera: Camera,
    is_seen: bool,
    is_exposed: bool,
    lights: Vec<Light>,
    sides: Vec<Side>,
    ready: u64,
}

/// What drawing came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// The output holds another picture than before.
    pub is_new: bool,
    /// More is to come without any change: draw again soon.
    pub is_unfinished: bool,
}

impl Renderer {
    /// Makes what every scene needs. Errors of the device are kept from now on, see [`take_error`](Self::take_error).
    pub fn new(gpu: &Gpu, compile: Compile) -> Self {
        let errors = DeviceErrors::default();
        let kept = errors.clone();
        gpu.device().on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            kept.lock().unwrap_or_else(PoisonError::into_inner).push(error.to_string());
        }));
        let lost = Arc::new(Mutex::new(None));
        let told = lost.clone();
        gpu.device().set_device_lost_callback(move |reason, message| {
            let why = if message.is_empty() { format!("{reason:?}") } else { message };
            *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
        });
        Self {
            receivers: ReceiverPass::new(gpu),
            programs: ShadingPrograms::new(gpu.device()),
            present: Present::new(gpu.device()),
            antialiasing: Antialiasing::new(gpu.device()),
            light_map: LightMapPass::new(gpu.device()),
            lists: ListsPass::new(gpu.device()),
            scene: None,
            view: None,
            sides: [SideWork::new(gpu, UVec2::ONE), SideWork::new(gpu, UVec2::ONE)],
            truth: None,
            truth_view: upload_f32(gpu, "no truth", UVec2::ONE, &[-1.0]),
            drawn: None,
            shown: None,
            version: 0,
            output_reader: TextureReader::default(),
            pointer_px: None,
            pixel_reader: PixelReader::default(),
            inspected: None,
            errors,
            lost,
            gpu: gpu.clone(),
            compile,
        }
    }

    /// The first of what the device has complained about since the last call, and how much more there was.
    pub fn take_error(&self) -> Option<String> {
        let errors = std::mem::take(&mut *self.errors.lock().unwrap_or_else(PoisonError::into_inner));
        let first = errors.first()?.split_whitespace().collect::<Vec<_>>().join(" ");
        Some(if errors.len() > 1 { format!("{first} (and {} more)", errors.len() - 1) } else { first })
    }

    /// Why the device is no more, once that is known: nothing can be drawn with it.
    pub fn lost(&self) -> Option<String> {
        // Callbacks come by this.
        let polled = self.gpu.device().poll(wgpu::PollType::Poll);
        let why = self.lost.lock().unwrap_or_else(PoisonError::into_inner).clone();
        debug_assert!(polled.is_ok() || why.is_some(), "{polled:?}");
        why
    }

    /// Takes in a scene, which the state has opened as `generation`.
    pub fn open(&mut self, scene: &Scene, generation: u64) {
        let uploaded = GpuScene::upload(&self.gpu, scene);
        let groups = self.receivers.draw_groups(&self.gpu, &uploaded);
        let has = |is: fn(&AlphaMode) -> bool| scene.materials.iter().any(|material| is(&material.alpha));
        self.scene = Some(LoadedScene {
            generation,
            pose: 0,
            groups,
            what: WarmUp {
                masked: has(|alpha| matches!(alpha, AlphaMode::Mask { .. } | AlphaMode::Blend)),
                tinted: has_tint(&uploaded),
            },
            scene: uploaded,
            exposure: some_points(scene),
            is_exposed: false,
        });
        self.view = None;
    }

    /// Shows the open scene as it is at another time: `before` is what is shown, `after` the same scene then. Nothing else
    /// changes, exposure neither.
    pub fn pose(&mut self, before: &Scene, after: &Scene) {
        let Some(open) = &mut self.scene else { return };
        if !open.scene.repose(&self.gpu, before, after) {
            // Something has come or gone.
            open.scene = GpuScene::upload(&self.gpu, after);
            open.groups = self.receivers.draw_groups(&self.gpu, &open.scene);
            open.what.tinted |= has_tint(&open.scene);
        }
        open.pose += 1;
        if let Some(view) = &mut self.view {
            view.camera = None;
            if view.behind.is_some() != open.scene.has_translucent_surfaces() {
                self.view = None;
            }
        }
    }

    /// Exposes the lights anew, to what the camera sees now.
    pub fn expose(&mut self) {
        if let (Some(scene), Some(view)) = (&mut self.scene, &mut self.view) {
            scene.is_exposed = false;
            view.seen_version = None;
        }
    }

    /// The window's picture, of [`OUTPUT_FORMAT`]; `None` before the first.
    pub fn output(&self) -> Option<&wgpu::TextureView> {
        self.view.as_ref().map(|view| &view.output_view)
    }

    /// The texture behind [`output`](Self::output).
    pub fn output_texture(&self) -> Option<&wgpu::Texture> {
        self.view.as_ref().map(|view| &view.output)
    }

    /// Bytes of GPU memory that the scene takes.
    pub fn scene_memory_bytes(&self) -> u64 {
        self.scene.as_ref().map_or(0, |scene| scene.scene.memory_bytes)
    }

    /// Counts up whenever masks are drawn.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Draws what has changed of `state`, in a picture of `size_px`, and submits it.
    pub fn draw(&mut self, state: &State, size_px: UVec2, truth: Option<&Estimate>) -> Drawn {
        // Nobody else need wait for anything, so callbacks come only by this.
        if self.lost().is_some() {
            return Drawn::default();
        }
        let is_open = self.scene.as_ref().map(|scene| scene.generation);
        if is_open.is_none() || is_open != state.scene.as_ref().map(|scene| scene.generation) {
            return Drawn::default();
        }
        self.fit_size(state, size_px);
        self.draw_receivers(state);
        self.collect(state);
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("viewer") });
        let are_drawn = self.draw_sides(&mut encoder, state);
        self.read_seen(&mut encoder);
        let is_smoothing = self.smooth(&mut encoder, state);
        let is_new = self.draw_output(&mut encoder, state, truth);
        self.read_pixel(&mut encoder, state);
        if are_drawn || is_smoothing || is_new || self.is_reading() {
            self.gpu.queue().submit([encoder.finish()]);
        }
        let is_settling = self.drawn.as_ref().is_some_and(|(_, frames)| *frames < self.wanted_frames());
        let is_compiling = state.shown_sides().iter().zip(&self.sides).any(|(_, work)| work.is_busy());
        Drawn { is_new, is_unfinished: is_settling || is_compiling || is_smoothing || self.is_reading() }
    }

    /// Whether something is still to be read. Depths are taken by the next frame, which then draws anew; masks are the
    /// caller's, and change nothing once they are there.
    fn is_reading(&self) -> bool {
        self.view.as_ref().is_some_and(|view| view.depth_reader.is_pending())
            || self.output_reader.is_waiting()
            || self.pixel_reader.is_waiting()
            || self.sides.iter().any(|side| side.mask_reader.is_waiting() || side.are_list_totals_awaited())
    }

    /// Asks what is at a pixel from now on, to be had by [`inspected`](Self::inspected); `None` asks nothing.
    pub fn inspect(&mut self, pixel: Option<UVec2>) {
        self.pointer_px = pixel;
    }

    /// What is at the pixel that is asked about, as it was when it was last read.
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

    /// Reads the pixel that is asked about, where it or anything drawn is another one than before.
    fn read_pixel(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State) {
        if let Some(read) = self.pixel_reader.take() {
            self.inspected = Some(read);
        }
        let (Some(view), Some(pixel)) = (&self.view, self.pointer_px) else { return };
        let asked = (pixel, self.version << 8 | state.light as u64, view.camera_version);
        let is_known = self.inspected.as_ref().is_some_and(|(read, _)| *read == asked);
        if is_known || self.pixel_reader.asked().is_some() || pixel.cmpge(view.images.size_px).any() {
            return;
        }
        let shown = state.shown_sides().len();
        let masks = [0, 1].map(|side| self.sides[side].mask(state.light).filter(|_| side < shown));
        self.pixel_reader.record(&self.gpu, encoder, asked, &view.images, masks);
    }

    /// Images of the right size.
    fn fit_size(&mut self, state: &State, size_px: UVec2) {
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

    fn draw_receivers(&mut self, state: &State) {
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

    /// Takes in what has come back: what the camera sees, compiled techniques, times.
    fn collect(&mut self, state: &State) {
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

    /// The sides as they are drawn: with ratio masks in *shaded* while no pixel is inspected, with visibility otherwise.
    fn drawn_sides(&self, state: &State) -> Vec<Side> {
        let is_picture = state.show == Show::Shaded && self.pointer_px.is_none();
        let drawn = |side: &Side| if is_picture { side.for_shading() } else { side.clone() };
        state.shown_sides().iter().map(drawn).collect()
    }

    /// Draws the sides, where anything that they are drawn from has changed or has not settled.
    fn draw_sides(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State) -> bool {
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
        // What cannot be drawn will not be by trying again.
        let is_refused = self.sides.iter().any(|work| work.problem().is_some());
        self.drawn = Some((from, if is_refused { SETTLING_FRAMES + WARMING_FRAMES } else { frames + 1 }));
        true
    }

    /// Adds to the antialiased pictures, where pictures are shown that stand still, until they are complete.
    fn smooth(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State) -> bool {
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

    /// Frames to draw after a change.
    fn wanted_frames(&self) -> u32 {
        let is_cold = self.sides.iter().any(|side| side.kind().is_some() && side.times.counts().0 == 0);
        SETTLING_FRAMES + if is_cold { WARMING_FRAMES } else { 0 }
    }

    /// Prepares and records the left side's masks, and drops them; why that cannot be.
    #[cfg(test)]
    fn record_only(&mut self, state: &State) -> Result<(), String> {
        let (Some(scene), Some(view)) = (&self.scene, &self.view) else { return Err("nothing is open".into()) };
        let lights = &state.setup.lights;
        let shading = Shading::new(&self.gpu, &self.programs, &view.images, None, lights, &scene.exposure);
        let frame = SideFrame { scene: &scene.scene, images: &view.images, shading: &shading, lights };
        self.sides[0].masks_commands(&self.gpu, &state.sides[0], &frame).map(drop)
    }

    /// Asks what the camera sees, once it stands still.
    fn read_seen(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let is_still = self.drawn.as_ref().is_some_and(|(_, frames)| *frames > 1);
        let Some(view) = &mut self.view else { return };
        let is_known = view.seen_version == Some(view.camera_version);
        if is_still && !is_known && !view.depth_reader.is_pending() {
            view.depth_reader.record(&self.gpu, encoder, &view.images.depth, view.camera_version);
        }
    }

    /// Draws the window's picture, where a side or the view has changed.
    fn draw_output(&mut self, encoder: &mut wgpu::CommandEncoder, state: &State, truth: Option<&Estimate>) -> bool {
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

    /// Asks for the window's picture, to be had by [`take_output`](Self::take_output). `None` before there is one.
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

    /// The window's picture that has come back: four bytes a pixel, sRGB.
    pub fn take_output(&mut self) -> Option<Texels> {
        self.output_reader.take()
    }

    /// Asks for the sides' masks of the chosen light, to be had by [`take_mask`](Self::take_mask).
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

    /// A side's mask that has come back, with the version that it is of: visibility by pixel, the mean of its channels.
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

/// Whether any caster changes light's colour.
fn has_tint(scene: &GpuScene) -> bool {
    scene.casters().iter().any(|caster| caster.opacity.tints())
}

/// Some points of the scene's surfaces, whoever sees them.
fn some_points(scene: &Scene) -> Vec<Vec3> {
    let every = scene.triangle_count().div_ceil(EXPOSURE_POINTS).max(1);
    scene.world_triangles().step_by(every).map(|triangle| triangle.positions.iter().sum::<Vec3>() / 3.0).collect()
}

#[cfg(test)]
mod tests;
