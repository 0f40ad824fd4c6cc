//! Image of a motion: frames side by side above, their changes below.
//!
//! ```text
//! mask, frame N/4   N/2   3N/4   N    settled
//! change's error    …     …      …    flicker of each pixel
//! ```
//!
//! The error of a change is (M_i − M_{i−1}) − (V_i − V_{i−1}) on the scale of the error maps, and a pixel's flicker is its rms over the
//! frames. The truth's own strip shows V_i − V_{i−1} and its rms in the lower row.

use glam::UVec2;
use image::RgbImage;
use image::imageops::{FilterType, overlay, resize};

use super::flicker::{FlickerSums, TrueFrame};
use crate::color_maps::{NOT_JUDGED_COLOR, magnitude_map, signed_error_color};
use crate::picture::{Visibility, rgb_image};

/// Number of frames in a strip, evenly spaced over the motion.
pub const STRIP_FRAMES: u32 = 4;

/// Flicker of a pixel that is shown brightest.
pub const STRIP_FLICKER_RANGE: f32 = 0.25;

/// Maximum width of one image of a strip, pixels.
const CELL_WIDTH_PX: u32 = 320;
/// Gap between images, pixels.
const GAP_PX: u32 = 4;

/// A strip in progress.
#[derive(Debug)]
pub(super) struct Strip {
    cell_px: UVec2,
    picture: RgbImage,
}

/// Returns the column of frame `frame` of `frames`; `None` if the strip does not show it.
fn column_of(frame: u32, frames: u32) -> Option<u32> {
    (1..=STRIP_FRAMES).find(|column| (frames * column).div_ceil(STRIP_FRAMES) == frame).map(|column| column - 1)
}

impl Strip {
    /// Creates an empty strip for masks of `size_px`.
    pub(super) fn new(size_px: UVec2) -> Self {
        let width = size_px.x.min(CELL_WIDTH_PX);
        let cell_px = UVec2::new(width, (size_px.y * width).div_ceil(size_px.x).max(1));
        let extent = |cells: u32, cell: u32| cells * (cell + GAP_PX) - GAP_PX;
        let whole = UVec2::new(extent(STRIP_FRAMES + 1, cell_px.x), extent(2, cell_px.y));
        Self { cell_px, picture: rgb_image(whole, |_| NOT_JUDGED_COLOR) }
    }

    fn put(&mut self, column: u32, row: u32, picture: &RgbImage) {
        let scaled = resize(picture, self.cell_px.x, self.cell_px.y, FilterType::Triangle);
        let place = UVec2::new(column, row) * (self.cell_px + GAP_PX);
        overlay(&mut self.picture, &scaled, i64::from(place.x), i64::from(place.y));
    }

    /// Adds a moving frame out of `frames`: truths and masks of the previous and the current frame. Frames that
    /// the strip does not show are ignored.
    pub(super) fn add(&mut self, frame: u32, frames: u32, truths: [&TrueFrame; 2], masks: [&Visibility; 2]) {
        let Some(column) = column_of(frame, frames) else { return };
        self.put(column, 0, &masks[1].to_gray_levels());
        self.put(column, 1, &change_map(truths, |i, c| masks[1].at(i, c) - masks[0].at(i, c) - change(truths, i, c)));
    }

    /// Adds a moving frame of the truth itself.
    pub(super) fn add_truth(&mut self, frame: u32, frames: u32, truths: [&TrueFrame; 2]) {
        let Some(column) = column_of(frame, frames) else { return };
        self.put(column, 0, &truths[1].visibility.to_gray_levels());
        self.put(column, 1, &change_map(truths, |i, c| change(truths, i, c)));
    }

    /// Returns the strip with the settled mask and the flicker of each pixel of `judged`.
    pub(super) fn finish(mut self, settled: &Visibility, sums: &FlickerSums, judged: &[bool]) -> RgbImage {
        self.put(STRIP_FRAMES, 0, &settled.to_gray_levels());
        let flicker = magnitude_map(settled.size_px, &sums.by_pixel(), STRIP_FLICKER_RANGE, judged);
        self.put(STRIP_FRAMES, 1, &flicker);
        self.picture
    }
}

/// Returns the change of the truth.
fn change(truths: [&TrueFrame; 2], pixel: usize, channel: usize) -> f32 {
    truths[1].visibility.at(pixel, channel) - truths[0].visibility.at(pixel, channel)
}

/// Maps a signed value of each pixel that is judged in both frames, using the channel with the largest magnitude.
fn change_map(truths: [&TrueFrame; 2], value: impl Fn(usize, usize) -> f32) -> RgbImage {
    let Visibility { size_px, .. } = truths[0].visibility;
    rgb_image(size_px, |i| {
        if truths.iter().any(|truth| !truth.judged[i]) {
            return NOT_JUDGED_COLOR;
        }
        let values = (0..truths[0].visibility.channel_count()).map(|c| value(i, c));
        values.max_by(|a, b| a.abs().total_cmp(&b.abs())).map_or(NOT_JUDGED_COLOR, signed_error_color)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_frame_is_shown_and_as_many_as_there_are() {
        let shown = |frames: u32| (1..=frames).filter(|frame| column_of(*frame, frames).is_some()).collect::<Vec<_>>();
        assert_eq!(shown(16), [4, 8, 12, 16]);
        assert_eq!(shown(4), [1, 2, 3, 4]);
        assert_eq!(shown(2), [1, 2]);
        assert_eq!(column_of(2, 2), Some(2), "two places are of one frame: it is at the first of them");
    }

    #[test]
    fn masks_stand_above_and_changes_below() {
        let size_px = UVec2::new(8, 4);
        let frame = |v: f32| TrueFrame { visibility: Visibility::one(size_px, vec![v; 32]), judged: vec![true; 32] };
        let (dark, lit) = (frame(0.0), frame(1.0));
        let mut strip = Strip::new(size_px);
        let mut sums = FlickerSums::new(32);
        // The truth is constant and the mask lights up.
        strip.add(4, 4, [&dark, &dark], [&dark.visibility, &lit.visibility]);
        sums.add([&dark, &dark], [&dark.visibility, &lit.visibility]);
        let picture = strip.finish(&lit.visibility, &sums, &dark.judged);
        assert_eq!(picture.dimensions(), (5 * 12 - 4, 2 * 8 - 4));
        let at = |column: u32, row: u32| picture.get_pixel(column * 12 + 4, row * 8 + 2).0;
        assert_eq!((at(3, 0), at(3, 1)), ([255; 3], signed_error_color(1.0)));
        assert_eq!((at(4, 0), at(4, 1)), ([255; 3], crate::color_maps::magnitude_color(1.0)));
        assert_eq!(at(0, 0), NOT_JUDGED_COLOR, "a frame that was not given");
    }
}
