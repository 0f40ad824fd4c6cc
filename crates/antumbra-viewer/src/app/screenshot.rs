//! Screenshots: the image or the whole window as a PNG file.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use glam::UVec2;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};

use super::App;
use crate::loader::write_whole;
use crate::message::one_line;

/// Minimum number of light samples per pixel for a window screenshot that shows the ground truth.
const SCREENSHOT_POINTS: u32 = 256;
/// Number of consecutive idle frames before a window screenshot.
const SCREENSHOT_STILL_FRAMES: u32 = 8;

/// A requested screenshot of the window.
pub(super) struct Screenshot {
    pub(super) path: PathBuf,
    pub(super) still_frames: u32,
    pub(super) image: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
    pub(super) is_asked: bool,
}

impl App {
    /// Writes the requested image, once it has been read back.
    pub(super) fn save_picture(&mut self) {
        let Some(texels) = self.renderer.take_output() else { return };
        let Some(path) = self.saving.take() else { return };
        let UVec2 { x, y } = texels.size_px;
        let written = image::RgbaImage::from_raw(x, y, texels.bytes)
            .ok_or_else(|| "the image was read back incompletely; save it again".to_owned())
            .and_then(|image| write_png(&path, image));
        match written {
            Ok(()) => self.say(format!("saved the image to {}", path.display())),
            Err(why) => self.complain(why),
        }
    }

    /// Writes the window's screenshot once the application is idle, and ends.
    pub(super) fn advance_screenshot(&mut self, ctx: &egui::Context, is_unfinished: bool) {
        let points = self.truth.estimate().map_or(0, |estimate| estimate.points);
        let lacks_truth = self.state.show.needs_truth() && points < SCREENSHOT_POINTS;
        let is_busy = is_unfinished || self.scene.is_none() || lacks_truth;
        let Some(screenshot) = &mut self.screenshot else { return };
        screenshot.still_frames = if is_busy { 0 } else { screenshot.still_frames + 1 };
        let taken = screenshot.image.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(taken) = taken {
            let [x, y] = taken.size.map(|side| side as u32);
            let bytes = taken.pixels.iter().flat_map(egui::Color32::to_array).collect();
            let path = screenshot.path.clone();
            let written = image::RgbaImage::from_raw(x, y, bytes)
                .ok_or_else(|| "the window's image was read back incompletely".to_owned())
                .and_then(|image| write_png(&path, image));
            self.finish(ctx, written);
        } else if !screenshot.is_asked && screenshot.still_frames >= SCREENSHOT_STILL_FRAMES {
            screenshot.is_asked = true;
            let image = screenshot.image.clone();
            ctx.send_viewport_cmd(egui::ViewportCommand::Screenshot(egui::ScreenshotCallback::new(move |taken| {
                *image.lock().unwrap_or_else(PoisonError::into_inner) = Some(taken);
            })));
        }
    }
}

/// Writes an opaque PNG file atomically.
fn write_png(path: &Path, image: image::RgbaImage) -> Result<(), String> {
    let opaque = image::DynamicImage::ImageRgba8(image).into_rgb8();
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    opaque.write_with_encoder(encoder).map_err(|error| one_line(&error.to_string()))?;
    write_whole(path, &bytes)
}
