//! What is asked of the tracer, and what it answers: options and images of visibility.

use antumbra_light::SampleSet;
use glam::UVec2;

/// How finely a light is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibilityOptions {
    /// Light points per receiver, from 1 to 2²⁰; default 1024, the reference's 32 × 32. More of them halve the noise
    /// for every fourfold. A list of points is not sampled: each counts once.
    pub samples: u32,
    /// How the points are spread over the light; default stratified.
    pub set: SampleSet,
    /// Which points of that kind; default 0.
    pub seed: u32,
    /// Every pixel uses the one set `set.points(samples, seed)`, as techniques do; default false: neighbours differ, and
    /// noise does not gather into bands.
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
    /// 3 where occluders tint, else 1.
    pub channels: u32,
    /// Visibility in [0, 1], row by row from the top left: RGB, or three times the same where `channels` is 1.
    pub values: Vec<[f32; 3]>,
    /// The pixel shows a surface that the light reaches and whose geometric normal, turned to the camera, leans
    /// towards the light's centre: the pixels over which techniques are judged.
    pub faces_light_center: Vec<bool>,
    /// Visibility queries answered: pairs of a receiver that the light reaches and a light point.
    pub rays: u64,
    /// Those of them that occluders of a neighbouring receiver, or the receiver's own triangle, settled without a walk
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

    /// One value per pixel: the visibility, or the mean of its channels.
    pub fn mean_channel(&self) -> Vec<f32> {
        self.values.iter().map(|v| if self.channels == 1 { v[0] } else { (v[0] + v[1] + v[2]) / 3.0 }).collect()
    }
}
