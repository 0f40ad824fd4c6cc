//! Images and visibility images on the CPU: plain data, first row at the top.

use antumbra_scene::srgb_from_linear;
use glam::{UVec2, Vec3};
use image::{Rgb, RgbImage};

/// Image in linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size_px: UVec2,
    /// `width · height` linear colours, top row first; 1 is the display's white.
    pub linear_rgb: Vec<Vec3>,
}

impl Picture {
    /// Creates an image of `size_px` whose pixels are `linear_rgb`, row by row from the top.
    ///
    /// # Panics
    /// The number of colours is not `width · height`.
    pub fn new(size_px: UVec2, linear_rgb: Vec<Vec3>) -> Self {
        assert_eq!(pixel_count(size_px), linear_rgb.len(), "the number of pixels differs from the size {size_px}");
        Self { size_px, linear_rgb }
    }

    /// Converts to 8-bit sRGB, clamped to the display's range and rounded to nearest.
    pub fn to_srgb8(&self) -> RgbImage {
        rgb_image(self.size_px, |i| self.linear_rgb[i].to_array().map(|v| u8_from_unit(srgb_from_linear(v))))
    }
}

/// Visibility image: the fraction of the light that each pixel's surface sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    /// Width and height, pixels.
    pub size_px: UVec2,
    /// `width · height` values, top row first.
    pub values: VisibilityValues,
}

/// Values of a visibility image: one channel, or three if occluders tint the light.
#[derive(Clone, Debug, PartialEq)]
pub enum VisibilityValues {
    /// One channel: 1 lit, 0 umbra.
    One(Vec<f32>),
    /// Red, green and blue.
    Three(Vec<Vec3>),
}

impl Visibility {
    /// Creates a one-channel image.
    ///
    /// # Panics
    /// The number of values is not `width · height`.
    pub fn one(size_px: UVec2, values: Vec<f32>) -> Self {
        assert_eq!(pixel_count(size_px), values.len(), "the number of pixels differs from the size {size_px}");
        Self { size_px, values: VisibilityValues::One(values) }
    }

    /// Creates a three-channel image.
    ///
    /// # Panics
    /// The number of values is not `width · height`.
    pub fn three(size_px: UVec2, values: Vec<Vec3>) -> Self {
        assert_eq!(pixel_count(size_px), values.len(), "the number of pixels differs from the size {size_px}");
        Self { size_px, values: VisibilityValues::Three(values) }
    }

    /// Number of channels, 1 or 3.
    pub fn channel_count(&self) -> usize {
        match self.values {
            VisibilityValues::One(_) => 1,
            VisibilityValues::Three(_) => 3,
        }
    }

    /// Value of a pixel in a channel; a single channel serves as all three.
    pub fn at(&self, pixel: usize, channel: usize) -> f32 {
        match &self.values {
            VisibilityValues::One(values) => values[pixel],
            VisibilityValues::Three(values) => values[pixel][channel],
        }
    }

    /// Converts to an 8-bit image whose grey level (or RGB) *is* the value, 0 to 255, without a display curve: half visibility
    /// is code 128 and looks about half as bright as lit, and the value can be read back from the image.
    pub fn to_gray_levels(&self) -> RgbImage {
        rgb_image(self.size_px, |i| [0, 1, 2].map(|channel| u8_from_unit(self.at(i, channel))))
    }
}

/// Number of pixels, `width · height`.
pub fn pixel_count(size_px: UVec2) -> usize {
    size_px.x as usize * size_px.y as usize
}

/// Creates an image from a function of the pixel's index, row by row from the top.
pub fn rgb_image(size_px: UVec2, color_at: impl Fn(usize) -> [u8; 3]) -> RgbImage {
    RgbImage::from_fn(size_px.x, size_px.y, |x, y| Rgb(color_at(y as usize * size_px.x as usize + x as usize)))
}

/// Rounds to the nearest of 256 levels; values outside `[0, 1]` saturate, NaN is 0.
fn u8_from_unit(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_bytes_match_the_standard() {
        // IEC 61966-2-1: linear 0.214 is code 127.5 / 255. Black, white and values outside the range saturate.
        let picture = Picture::new(
            UVec2::new(2, 2),
            vec![Vec3::ZERO, Vec3::ONE, Vec3::new(0.2140, 2.0, -1.0), Vec3::splat(f32::NAN)],
        );
        let bytes = picture.to_srgb8();
        assert_eq!(bytes.get_pixel(0, 0).0, [0, 0, 0]);
        assert_eq!(bytes.get_pixel(1, 0).0, [255, 255, 255]);
        assert!((127..=128).contains(&bytes.get_pixel(0, 1).0[0]));
        assert_eq!(bytes.get_pixel(0, 1).0[1..], [255, 0]);
        assert_eq!(bytes.get_pixel(1, 1).0, [0, 0, 0]);
    }

    #[test]
    fn one_channel_stands_for_three() {
        let one = Visibility::one(UVec2::new(2, 1), vec![0.25, 1.0]);
        assert_eq!([one.at(0, 0), one.at(0, 2)], [0.25, 0.25]);
        assert_eq!(one.to_gray_levels().get_pixel(0, 0).0, [64, 64, 64]);
    }
}
