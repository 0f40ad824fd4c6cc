//! The truth of a setup: what the camera sees, and how much of each light it sees from there.

use std::sync::atomic::AtomicBool;

use antumbra_reference::{ReferenceError, Tracer, VisibilityImage, VisibilityOptions};
use antumbra_scene::{Scene, Setup};
use glam::{UVec2, Vec3};

use crate::picture::Visibility;
use crate::progress::Progress;

/// The truth of one light.
#[derive(Clone, Debug)]
pub struct LightTruth {
    /// Visibility of every pixel; three channels where occluders tint.
    pub visibility: Visibility,
    /// The pixels over which techniques are judged: with geometry that the light reaches and that faces its centre.
    pub judged: Vec<bool>,
    /// Wall-clock time of the rays, seconds.
    pub seconds: f64,
    /// Light points asked for, over all pixels.
    pub rays: u64,
}

impl LightTruth {
    fn of(image: VisibilityImage) -> Self {
        let visibility = if image.channels == 1 {
            Visibility::one(image.size_px, image.values.iter().map(|v| v[0]).collect())
        } else {
            Visibility::three(image.size_px, image.values.iter().copied().map(Vec3::from).collect())
        };
        Self { visibility, judged: image.faces_light_center, seconds: image.seconds, rays: image.rays }
    }

    /// Light points per second of wall-clock time, over all cores.
    pub fn rays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds } else { 0.0 }
    }
}

/// Traces every light of a setup, in the setup's order.
///
/// # Errors
/// Where the scene or a light cannot be traced.
pub fn trace(
    scene: &Scene,
    setup: &Setup,
    size_px: UVec2,
    options: &VisibilityOptions,
    progress: &dyn Progress,
) -> Result<Vec<LightTruth>, ReferenceError> {
    progress.begin("building the ray tracer's tree", 0);
    let tracer = Tracer::new(scene)?;
    let receivers = tracer.primary(&setup.camera, size_px);
    let never = AtomicBool::new(false);
    let truths = setup
        .lights
        .iter()
        .map(|light| {
            progress.begin(&format!("tracing light {}", light.name), STEPS);
            let report = |fraction: f32| progress.reach((f64::from(fraction) * STEPS as f64) as u64);
            tracer.visibility(&receivers, light, options, &report, &never).map(LightTruth::of)
        })
        .collect();
    progress.end();
    truths
}

/// How finely progress is told.
const STEPS: u64 = 1000;
