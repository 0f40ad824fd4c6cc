//! Progressive ground truth: rays are traced while the image is static. Natively threads do this; in a browser, whose pages
//! have a single thread, some rows are traced between two frames.

#[cfg(any(test, target_arch = "wasm32"))]
mod in_slices;
#[cfg(not(target_arch = "wasm32"))]
mod on_thread;
mod tracing;

use std::sync::Arc;

use antumbra_light::Light;
use antumbra_scene::{Camera, Scene};
use glam::UVec2;

#[cfg(target_arch = "wasm32")]
use in_slices::Slices as Worker;
#[cfg(not(target_arch = "wasm32"))]
use on_thread::Thread as Worker;

use crate::background::Wake;

/// Light samples per round; a square number for the stratified set.
pub const ROUND_POINTS: u32 = 16;
/// Maximum number of rounds; together they have the reference's 1024 samples.
pub const ROUNDS: u32 = 64;
/// Value of pixels that are not judged.
pub const NOT_JUDGED: f32 = -1.0;

/// A view to trace.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The camera.
    pub camera: Camera,
    /// Image size.
    pub size_px: UVec2,
    /// The light.
    pub light: Light,
}

impl Job {
    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.camera, self.size_px) == (other.camera, other.size_px)
            && self.light == other.light
    }
}

/// Visibility traced so far.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Identifier of the job.
    pub job: u64,
    /// Width and height.
    pub size_px: UVec2,
    /// Light samples per pixel so far.
    pub points: u32,
    /// Visibility by pixel, averaged over channels; [`NOT_JUDGED`] for background and surfaces turned away from the light.
    pub values: Vec<f32>,
}

impl Estimate {
    /// Root-mean-square error of a mask over judged pixels; `None` if there are none.
    pub fn rmse(&self, mask: &[f32]) -> Option<f64> {
        let judged = self.values.iter().zip(mask).filter(|(truth, _)| **truth >= 0.0);
        let (sum, count) =
            judged.fold((0.0, 0u64), |(sum, count), (truth, mask)| (sum + f64::from(mask - truth).powi(2), count + 1));
        (count > 0 && mask.len() == self.values.len()).then(|| (sum / count as f64).sqrt())
    }
}

/// Progressive tracer of one job at a time.
#[derive(Debug)]
pub struct LiveTruth {
    worker: Worker,
    current: Option<Job>,
    count: u64,
    /// Newest estimate of the current job.
    estimate: Option<Estimate>,
    /// Reason why there is no estimate.
    pub problem: Option<String>,
}

impl LiveTruth {
    /// Creates a tracer without a job. `wake` is called whenever [`estimate`](Self::estimate) may have changed.
    pub fn new(wake: Wake) -> Self {
        Self { worker: Worker::new(wake), current: None, count: 0, estimate: None, problem: None }
    }

    /// Traces `job`, from the start if it differs from the current one; `None` stops.
    pub fn want(&mut self, job: Option<Job>) {
        let is_same = match (&self.current, &job) {
            (Some(current), Some(job)) => current.is(job),
            (current, job) => current.is_none() && job.is_none(),
        };
        if is_same {
            return;
        }
        (self.estimate, self.problem) = (None, None);
        self.count += 1;
        match &job {
            Some(job) => self.worker.start(self.count, job.clone()),
            None => self.worker.stop(),
        }
        self.current = job;
    }

    /// Returns the newest estimate of the current job.
    pub fn estimate(&mut self) -> Option<&Estimate> {
        while let Some(result) = self.worker.take() {
            match result {
                Ok(estimate) if self.current.is_some() && estimate.job == self.count => self.estimate = Some(estimate),
                Ok(_) => {}
                Err(problem) => self.problem = Some(problem),
            }
        }
        self.estimate.as_ref()
    }
}

impl Drop for LiveTruth {
    fn drop(&mut self) {
        self.want(None);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;
    use std::thread;
    use std::time::{Duration, Instant};

    use antumbra_reference::{Tracer, VisibilityOptions};
    use antumbra_scene::{LoadOptions, Setup, load};

    use super::*;

    /// Waits for an estimate of at least `points` light samples.
    fn wait_for(truth: &mut LiveTruth, points: u32) -> Estimate {
        let began = Instant::now();
        loop {
            if let Some(estimate) = truth.estimate()
                && estimate.points >= points
            {
                return estimate.clone();
            }
            assert!(began.elapsed() < Duration::from_secs(120), "no truth: {:?}", truth.problem);
            thread::sleep(Duration::from_millis(2));
        }
    }

    /// Error of `values` over the pixels that `estimate` judges.
    fn judged_rmse(estimate: &Estimate, exact: &[f32], values: &[f32]) -> f64 {
        let keep = |(judged, value): (&f32, &f32)| if *judged < 0.0 { NOT_JUDGED } else { *value };
        let values = estimate.values.iter().zip(values).map(keep).collect();
        Estimate { values, ..estimate.clone() }.rmse(exact).unwrap()
    }

    #[test]
    fn rounds_converge_to_the_reference_and_another_view_starts_anew() {
        let scene = Arc::new(load("builtin:overlap", &LoadOptions::default()).unwrap());
        let setup = Setup::for_scene(&scene);
        let size_px = UVec2::new(48, 32);
        let job = Job { scene: scene.clone(), camera: setup.camera, size_px, light: setup.lights[0].clone() };
        let tracer = Tracer::new(&scene).unwrap();
        let receivers = tracer.primary(&setup.camera, size_px);
        let options = VisibilityOptions { samples: 4096, ..VisibilityOptions::default() };
        let trace = |options: &VisibilityOptions| {
            tracer.visibility(&receivers, &job.light, options, &|_| {}, &AtomicBool::new(false)).unwrap().mean_channel()
        };
        let exact = trace(&options);
        let first_round = trace(&VisibilityOptions { samples: ROUND_POINTS, seed: 0, ..options });

        let mut truth = LiveTruth::new(Arc::new(|| {}));
        truth.want(Some(job.clone()));
        let late = wait_for(&mut truth, ROUNDS * ROUND_POINTS);
        // The thread's progress at the first request depends on the machine, so the first round is traced here.
        let (early_rmse, late_rmse) = (judged_rmse(&late, &exact, &first_round), late.rmse(&exact).unwrap());
        // Measured: 4.3e-3. Sixty-four sets of sixteen samples are noisier than one set of 1024.
        assert!(late_rmse < 6e-3, "{late_rmse}");
        assert!(late_rmse < 0.5 * early_rmse, "{early_rmse} to {late_rmse}");

        let mut elsewhere = job;
        elsewhere.camera.eye.y += 1.0;
        truth.want(Some(elsewhere));
        assert!(truth.estimate().is_none_or(|estimate| estimate.job != late.job));
        assert_ne!(wait_for(&mut truth, 1).job, late.job);
        truth.want(None);
        assert!(truth.estimate().is_none());
    }
}
