//! Options and results of the tracer: images of visibility.

use antumbra_light::SampleSet;
use glam::UVec2;

/// Sampling options of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibilityOptions {
    /// Light points per receiver, from 1 to 2²⁰; default 1024, the reference's 32 × 32. Four times as many halve the noise.
    /// A list of points is not sampled: each point counts once.
    pub samples: u32,
    /// Sample set that distributes the points over the light; default stratified.
    pub set: SampleSet,
    /// Seed of the set; default 0.
    pub seed: u32,
    /// Whether every pixel uses the one set `set.points(samples, seed)`, as techniques do. Default false: neighbours differ,
    /// so that noise does not form bands.
    pub same_set_for_all_pixels: bool,
}

impl Default for VisibilityOptions {
    fn default() -> Self {
        Self { samples: 1024, set: SampleSet::Stratified, seed: 0, same_set_for_all_pixels: false }
    }
}

/// The visibility of a light from a list of receivers, or from the pixels of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VisibilityImage {
    /// Width and height; the product is the number of values. A list of points is one row.
    pub size_px: UVec2,
    /// Number of channels: 3 if occluders tint, else 1.
    pub channels: u32,
    /// Visibility in [0, 1], row by row from the top left: RGB, or three equal values if `channels` is 1.
    pub values: Vec<[f32; 3]>,
    /// Whether the pixel shows a surface that the light reaches and whose geometric normal, on the camera's side, faces the
    /// light's centre: techniques are judged over these pixels.
    pub faces_light_center: Vec<bool>,
    /// Number of visibility queries: pairs of a receiver that the light reaches and a light point.
    pub rays: u64,
    /// Number of queries that occluders of a neighbouring receiver, or the receiver's own triangle, answered without a walk
    /// through the tree.
    pub rays_without_walk: u64,
    /// Wall-clock time, seconds.
    pub seconds: f64,
}

impl VisibilityImage {
    /// Queries per second of wall-clock time, over all cores.
    pub fn rays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds } else { 0.0 }
    }

    /// Returns one value per pixel: the visibility, or the mean of its channels.
    pub fn mean_channel(&self) -> Vec<f32> {
        self.values.iter().map(|v| if self.channels == 1 { v[0] } else { (v[0] + v[1] + v[2]) / 3.0 }).collect()
    }
}
