//! Ground truth of a setup: visible surfaces, and visibility of each light from them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use antumbra_light::Light;
use antumbra_reference::{ReceiverPoint, Receivers, ReferenceError, Tracer, VisibilityImage, VisibilityOptions};
use antumbra_scene::{Scene, Setup};
use glam::{UVec2, Vec3};

use crate::picture::Visibility;
use crate::progress::Progress;

/// Position and normal of a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World position, metres.
    pub position: Vec3,
    /// Unit geometric normal in world space, facing the camera.
    pub normal: Vec3,
}

/// Ground truth of one light.
#[derive(Clone, Debug)]
pub struct LightTruth {
    /// Visibility of every pixel, with three channels if occluders tint.
    pub visibility: Visibility,
    /// Whether each pixel is judged: it has geometry that the light reaches and that faces the light's centre.
    pub judged: Vec<bool>,
    /// First surface on each pixel's ray; `None` for background.
    pub first_hits: Arc<[Option<SurfacePoint>]>,
    /// Duration of tracing, seconds.
    pub seconds: f64,
    /// Number of light samples over all pixels.
    pub rays: u64,
}

impl LightTruth {
    fn of(image: VisibilityImage, first_hits: Arc<[Option<SurfacePoint>]>) -> Self {
        let visibility = if image.channels == 1 {
            Visibility::one(image.size_px, image.values.iter().map(|v| v[0]).collect())
        } else {
            Visibility::three(image.size_px, image.values.iter().copied().map(Vec3::from).collect())
        };
        Self { visibility, judged: image.faces_light_center, first_hits, seconds: image.seconds, rays: image.rays }
    }

    /// Stops judging pixels at whose centre depth buffer and ray show different surfaces, or different faces of one, and returns their
    /// number: techniques see one surface, and the truth is of the other. An edge is at the pixel's centre then, within the rasteriser's
    /// rounding of vertices. `seen` has the drawn surface of each pixel.
    pub fn unjudge_mismatched_surfaces(&mut self, seen: &[Option<SurfacePoint>], eye: Vec3) -> usize {
        let mut others = 0;
        for ((judged, hit), seen) in self.judged.iter_mut().zip(self.first_hits.iter()).zip(seen) {
            let is_same = match (hit, seen) {
                (Some(hit), Some(seen)) => is_same_surface(hit, seen, eye),
                (hit, seen) => hit.is_none() && seen.is_none(),
            };
            others += usize::from(*judged && !is_same);
            *judged &= is_same;
        }
        others
    }

    /// Returns the light samples per second of wall-clock time, over all cores.
    pub fn rays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds } else { 0.0 }
    }
}

/// Traces every light of a setup, in the setup's order.
///
/// # Errors
/// If the scene or a light cannot be traced.
pub fn trace(
    scene: &Scene,
    setup: &Setup,
    size_px: UVec2,
    options: &VisibilityOptions,
    progress: &dyn Progress,
) -> Result<Vec<LightTruth>, ReferenceError> {
    progress.begin("building the acceleration structure", 0);
    let tracer = Tracer::new(scene)?;
    let receivers = tracer.primary(&setup.camera, size_px);
    trace_lights(&tracer, &receivers, &setup.lights, options, progress)
}

/// Traces lights from what a camera sees, with an existing tracer.
///
/// # Errors
/// If a light or the options are invalid.
pub fn trace_lights(
    tracer: &Tracer,
    receivers: &Receivers,
    lights: &[Light],
    options: &VisibilityOptions,
    progress: &dyn Progress,
) -> Result<Vec<LightTruth>, ReferenceError> {
    trace_lights_until(tracer, receivers, lights, options, None, progress)
}

/// Traces as [`trace_lights`], until a deadline.
///
/// # Errors
/// If a light or the options are invalid, or the deadline passes.
pub fn trace_lights_until(
    tracer: &Tracer,
    receivers: &Receivers,
    lights: &[Light],
    options: &VisibilityOptions,
    deadline: Option<Instant>,
    progress: &dyn Progress,
) -> Result<Vec<LightTruth>, ReferenceError> {
    let first_hits = first_hits(receivers);
    let truths = lights
        .iter()
        .map(|light| {
            progress.begin(&format!("tracing light {}", light.name), STEPS);
            let report = |fraction: f32| progress.reach((f64::from(fraction) * STEPS as f64) as u64);
            until(deadline, &report, |report, stop| tracer.visibility(receivers, light, options, report, stop))
                .map(|image| LightTruth::of(image, first_hits.clone()))
        })
        .collect();
    progress.end();
    truths
}

/// Traces one light from what a camera sees, with an existing tracer. `report` receives the completed fraction, from 0 to 1.
///
/// # Errors
/// If the light or the options are invalid, or the deadline passes.
pub fn trace_light(
    tracer: &Tracer,
    receivers: &Receivers,
    light: &Light,
    options: &VisibilityOptions,
    deadline: Option<Instant>,
    report: &(dyn Fn(f32) + Sync),
) -> Result<LightTruth, ReferenceError> {
    let image = until(deadline, report, |report, stop| tracer.visibility(receivers, light, options, report, stop))?;
    Ok(LightTruth::of(image, first_hits(receivers)))
}

/// Traces with a progress callback that stops the work after a deadline.
fn until(
    deadline: Option<Instant>,
    report: &(dyn Fn(f32) + Sync),
    trace: impl FnOnce(&(dyn Fn(f32) + Sync), &AtomicBool) -> Result<VisibilityImage, ReferenceError>,
) -> Result<VisibilityImage, ReferenceError> {
    let is_over = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let stop = AtomicBool::new(is_over());
    let watched = |fraction: f32| {
        report(fraction);
        // Complete work is kept.
        if fraction < 1.0 && is_over() {
            stop.store(true, Ordering::Relaxed);
        }
    };
    trace(&watched, &stop)
}

fn first_hits(receivers: &Receivers) -> Arc<[Option<SurfacePoint>]> {
    let surface_of = |point: ReceiverPoint| SurfacePoint { position: point.position, normal: point.normal };
    receivers.points.iter().map(|hit| hit.map(surface_of)).collect()
}

/// Returns whether camera ray and depth buffer show the same face of the same surface.
pub(crate) fn is_same_surface(hit: &SurfacePoint, seen: &SurfacePoint, eye: Vec3) -> bool {
    hit.position.distance(seen.position) <= SAME_SURFACE * hit.position.distance(eye)
        && hit.normal.dot(seen.normal) >= SAME_FACE
}

/// Maximum distance between positions of one surface, relative to the distance to the camera. A pixel is about as wide,
/// and depth is rounded far more finely.
const SAME_SURFACE: f32 = 2e-3;

/// Minimum cosine between the normals of one face, or of two with a nearly flat edge: eight degrees. The sides of a hair are within
/// [`SAME_SURFACE`], and one may be lit where the other faces away.
const SAME_FACE: f32 = 0.99;

/// Number of steps in which progress is reported.
const STEPS: u64 = 1000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_that_shows_another_face_is_not_judged() {
        let at = |x: f32, normal: Vec3| Some(SurfacePoint { position: Vec3::new(x, 0.0, 0.0), normal });
        // Other side of a hair, close to the ray's hit; a surface behind; background; a nearly flat neighbour.
        let seen = [at(1e-4, Vec3::Z), at(1.0, Vec3::Y), None, at(1e-4, Vec3::new(0.1, 1.0, 0.0).normalize())];
        let hit = at(0.0, Vec3::Y);
        let mut truth = LightTruth {
            visibility: Visibility::one(UVec2::new(6, 1), vec![1.0; 6]),
            judged: vec![true, true, true, true, true, false],
            first_hits: [hit, hit, hit, hit, None, hit].into(),
            seconds: 0.0,
            rays: 0,
        };
        let seen = [&seen[..], &[None, at(1.0, Vec3::Y)]].concat();
        assert_eq!(truth.unjudge_mismatched_surfaces(&seen, Vec3::new(0.0, 5.0, 0.0)), 3);
        assert_eq!(truth.judged, [false, false, false, true, true, false]);
    }
}
