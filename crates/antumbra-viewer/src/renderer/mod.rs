//! Draws the image of a [`State`] on a given device: receivers once, each side's masks and shading, then the output image.
//!
//! Each step remembers its inputs and runs only if they have changed. A few more frames follow each change, because a
//! technique learns of an overflow one frame later.

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

pub use crate::background::Wake;
use crate::state::{Side, State};
use crate::truth::Estimate;
use antialiasing::{Antialiasing, Smoothed};
use inspector::{PixelReader, ReadingKey};
use light_map::LightMapPass;
use lists::ListsPass;
use loaded_scene::LoadedScene;
use present::{Present, Shown, upload_f32};
use texture_reader::TextureReader;

/// Policy for compiling a technique's shaders.
#[derive(Clone)]
pub enum Compile {
    /// Compile before the call returns.
    AtOnce,
    /// Compile in the background, on a thread if there are threads; then call the callback.
    Background(Wake),
}

impl fmt::Debug for Compile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtOnce => "AtOnce",
            Self::Background(_) => "Background",
        })
    }
}

/// Renderer of the viewer's image.
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
    /// The left or only side, and the right side.
    pub sides: [SideWork; 2],
    /// Content of the truth texture: the tracing job and its number of light samples.
    truth: Option<(u64, u32)>,
    truth_view: wgpu::TextureView,
    /// Inputs of the last drawn sides, and the number of frames drawn from them.
    drawn: Option<(DrawnFrom, u32)>,
    shown: Option<(Shown, [u64; 5])>,
    /// Version of the masks.
    version: u64,
    output_reader: TextureReader,
    /// The inspected pixel; `inspected` is the last reading.
    pointer_px: Option<UVec2>,
    pixel_reader: PixelReader,
    inspected: Option<(ReadingKey, Inspected)>,
    errors: DeviceErrors,
    lost: Arc<Mutex<Option<String>>>,
}

/// Uncaptured errors of a device.
pub type DeviceErrors = Arc<Mutex<Vec<String>>>;

/// Resources that depend on the image's size.
#[derive(Debug)]
struct View {
    images: ReceiverImages,
    behind: Option<ReceiverImages>,
    /// Created when the image first becomes static.
    smoothed: Option<Smoothed>,
    output: wgpu::Texture,
    output_view: wgpu::TextureView,
    /// Camera of the images.
    camera: Option<Camera>,
    /// Number of camera changes.
    camera_version: u64,
    /// Camera version of `depths`.
    seen_version: Option<u64>,
    /// Depths of visible surfaces by pixel, for camera version `seen_version`.
    depths: Vec<f32>,
    depth_reader: TextureReader,
}

/// Inputs of masks and images.
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

/// Result of drawing a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Whether the output has changed.
    pub is_new: bool,
    /// Whether work is left although the state is unchanged: the caller should draw again soon.
    pub is_unfinished: bool,
}

impl Renderer {
    /// Creates the pipelines that every scene needs. Uncaptured errors of the device are collected for
    /// [`take_error`](Self::take_error).
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

    /// Returns the first device error since the last call, with the number of further ones.
    pub fn take_error(&self) -> Option<String> {
        let errors = std::mem::take(&mut *self.errors.lock().unwrap_or_else(PoisonError::into_inner));
        let first = errors.first()?.split_whitespace().collect::<Vec<_>>().join(" ");
        Some(if errors.len() > 1 { format!("{first} (and {} more)", errors.len() - 1) } else { first })
    }

    /// Reason for the loss of the device, if it is lost: nothing can be drawn with it.
    pub fn lost(&self) -> Option<String> {
        // Polling runs the callbacks.
        let polled = self.gpu.device().poll(wgpu::PollType::Poll);
        let why = self.lost.lock().unwrap_or_else(PoisonError::into_inner).clone();
        debug_assert!(polled.is_ok() || why.is_some(), "{polled:?}");
        why
    }

    /// View of the output image, in [`OUTPUT_FORMAT`]; `None` before the first frame.
    pub fn output(&self) -> Option<&wgpu::TextureView> {
        self.view.as_ref().map(|view| &view.output_view)
    }

    /// Texture of [`output`](Self::output).
    pub fn output_texture(&self) -> Option<&wgpu::Texture> {
        self.view.as_ref().map(|view| &view.output)
    }

    /// GPU memory of the scene, bytes.
    pub fn scene_memory_bytes(&self) -> u64 {
        self.scene.as_ref().map_or(0, |scene| scene.scene.memory_bytes)
    }

    /// Version of the masks; it increases whenever masks are drawn.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Draws the changes of `state` into an image of `size_px` and submits them.
    pub fn draw(&mut self, state: &State, size_px: UVec2, truth: Option<&Estimate>) -> Drawn {
        // Nothing else polls the device, so this call runs its callbacks.
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
