//! The picture of a [`State`], drawn on someone's device: receivers once, each side's masks and shading, then the window's
//! picture of the two.
//!
//! Nothing is drawn that has not changed: each step knows what it was last drawn from. After a change a few frames more are
//! drawn, because techniques that ran out of room learn of it a frame later.

mod antialiasing;
mod drawing;
mod inspector;
mod light_map;
mod lists;
mod loaded_scene;
mod present;
mod readback;
mod refusals;
mod side;
mod side_readings;
mod texture_reader;
mod times;

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use antumbra::Gpu;
use antumbra_light::Light;
use antumbra_render::receivers::{ReceiverImages, ReceiverPass};
use antumbra_render::shading::ShadingPrograms;
use antumbra_scene::Camera;
use glam::UVec2;

pub use inspector::{Inspected, InspectedSurface};
pub use light_map::MapChoices;
pub use present::{ERROR_RAMP, ERROR_RANGE, NOT_JUDGED_COLOR, OUTPUT_FORMAT};
pub use side::SideWork;
pub use side_readings::SideReadings;
pub use texture_reader::Texels;
pub use times::{FRAMES, FrameTimes, Times};

pub use crate::aside::Wake;
use crate::state::{Side, State};
use crate::truth::Estimate;
use antialiasing::{Antialiasing, Smoothed};
use inspector::{Asked, PixelReader};
use light_map::LightMapPass;
use lists::ListsPass;
use loaded_scene::LoadedScene;
use present::{Present, Shown, upload_f32};
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
}

#[cfg(test)]
mod tests;
