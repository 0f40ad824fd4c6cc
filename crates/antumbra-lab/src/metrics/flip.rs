//! FLIP of two images, per pixel.

use glam::UVec2;
use image::RgbImage;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};

use super::{Mean, Metrics, MetricsError, TILE_PX};

/// FLIP of two 8-bit sRGB images per pixel, background included, at 67 pixels per degree (Andersson et al., *FLIP: A Difference Evaluator
/// for Alternating Images*, HPG 2020).
#[derive(Clone, Debug)]
pub struct FlipMap {
    size_px: UVec2,
    /// Values from 0 to 1, row by row from the top.
    values: Vec<f32>,
}

impl FlipMap {
    /// Compares two images of equal size.
    pub fn new(reference: &RgbImage, tested: &RgbImage) -> Result<Self, MetricsError> {
        if reference.dimensions() != tested.dimensions() {
            return Err(MetricsError::Sizes {
                reference: reference.dimensions().into(),
                tested: tested.dimensions().into(),
            });
        }
        let (width, height) = reference.dimensions();
        let size_px = UVec2::new(width, height);
        if width == 0 || height == 0 {
            return Ok(Self { size_px, values: Vec::new() });
        }
        let flip_image = |image: &RgbImage| FlipImageRgb8::with_data(width, height, image.as_raw());
        let error = nv_flip::flip(flip_image(reference), flip_image(tested), DEFAULT_PIXELS_PER_DEGREE);
        Ok(Self { size_px, values: error.to_vec() })
    }

    /// Returns the mean over the image; `None` if it has no pixels.
    pub fn mean(&self) -> Option<f64> {
        self.mean_within(UVec2::ZERO, self.size_px)
    }

    /// Returns the mean over the tile of [`TILE_PX`] with this upper left pixel, clipped to the image.
    pub fn tile_mean(&self, at_px: [u32; 2]) -> Option<f64> {
        let at_px = UVec2::from(at_px).min(self.size_px);
        self.mean_within(at_px, (at_px + TILE_PX).min(self.size_px))
    }

    fn mean_within(&self, from_px: UVec2, to_px: UVec2) -> Option<f64> {
        let mut mean = Mean::default();
        for row in from_px.y..to_px.y {
            let line = &self.values[(row * self.size_px.x) as usize..][..self.size_px.x as usize];
            line[from_px.x as usize..to_px.x as usize].iter().for_each(|e| mean.add(f64::from(*e)));
        }
        mean.mean()
    }
}

impl Metrics {
    /// Adds the FLIP values of the shaded images: over the whole, and over the worst tile.
    pub fn add_flip(&mut self, map: &FlipMap) {
        self.flip = map.mean();
        self.worst_tile_flip = self.worst_tile_at.and_then(|at_px| map.tile_mean(at_px));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn flip_is_zero_for_equal_and_one_for_opposite_pictures() {
        let flat = |v: u8| RgbImage::from_pixel(40, 30, Rgb([v; 3]));
        let mean = |a: &RgbImage, b: &RgbImage| FlipMap::new(a, b).unwrap().mean();
        assert_eq!(mean(&flat(90), &flat(90)), Some(0.0));
        // Black against white is the largest difference of FLIP's colour metric (its section 4.1.2 maps it to 1).
        let opposite = mean(&flat(0), &flat(255)).unwrap();
        assert!(opposite > 0.9 && opposite <= 1.0, "{opposite}");
        assert_eq!(mean(&RgbImage::new(0, 0), &RgbImage::new(0, 0)), None);
        assert!(FlipMap::new(&flat(0), &RgbImage::new(1, 1)).is_err());
        assert!(mean(&RgbImage::new(1, 1), &RgbImage::new(1, 1)).is_some());
    }

    /// FLIP of a tile covers that tile only, clipped to the image.
    #[test]
    fn flip_of_a_tile_is_of_that_tile() {
        let flat = RgbImage::from_pixel(100, 60, Rgb([90; 3]));
        let mut marked = flat.clone();
        (70..80).flat_map(|x| (40..50).map(move |y| (x, y))).for_each(|(x, y)| marked.put_pixel(x, y, Rgb([255; 3])));
        let map = FlipMap::new(&flat, &marked).unwrap();
        let [all, there, elsewhere] = [map.mean(), map.tile_mean([60, 28]), map.tile_mean([0, 0])].map(Option::unwrap);
        assert!(there > 3.0 * all && elsewhere < 0.01 * there, "{all} {there} {elsewhere}");
        assert_eq!(map.tile_mean([100, 60]), None);
        assert!(map.tile_mean([99, 0]).is_some());

        let mut metrics = Metrics { worst_tile_at: Some([60, 28]), ..Metrics::default() };
        metrics.add_flip(&map);
        assert_eq!((metrics.flip, metrics.worst_tile_flip), (Some(all), Some(there)));
    }
}
