//! The truth, live: rays traced while the picture stands still, ever more of them. Natively on threads of their own; in a
//! browser, whose pages have one, some rows between two frames.

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

use crate::aside::Wake;

/// Light points of each round; a multiple of nothing, and a square for the stratified set.
pub const ROUND_POINTS: u32 = 16;
/// Rounds until nothing more is traced: the reference's 1024 points.
pub const ROUNDS: u32 = 64;
/// Pixels that are not judged hold this.
pub const NOT_JUDGED: f32 = -1.0;

/// What is traced.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Where from.
    pub camera: Camera,
    /// The picture's size.
    pub size_px: UVec2,
    /// Which light.
    pub light: Light,
}

impl Job {
    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && (self.camera, self.size_px) == (other.camera, other.size_px)
            && self.light == other.light
    }
}

/// What the rays say so far.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Which tracing this is of.
    pub job: u64,
    /// Width and height.
    pub size_px: UVec2,
    /// Light points for each pixel so far.
    pub points: u32,
    /// Visibility by pixel, the mean of its channels; [`NOT_JUDGED`] for background and what faces away.
    pub values: Vec<f32>,
}

impl Estimate {
    /// The root mean square of a mask's error, over the pixels that are judged. `None` where none is.
    pub fn rmse(&self, mask: &[f32]) -> Option<f64> {
        let judged = self.values.iter().zip(mask).filter(|(truth, _)| **truth >= 0.0);
        let (sum, count) =
            judged.fold((0.0, 0u64), |(sum, count), (truth, mask)| (sum + f64::from(mask - truth).powi(2), count + 1));
        (count > 0 && mask.len() == self.values.len()).then(|| (sum / count as f64).sqrt())
    }
}

/// Traces one job at a time.
#[derive(Debug)]
pub struct LiveTruth {
    worker: Worker,
    current: Option<Job>,
    count: u64,
    /// The newest estimate of the current job.
    estimate: Option<Estimate>,
    /// Why there is none.
    pub problem: Option<String>,
}

impl LiveTruth {
    /// Nothing to trace yet. `wake` is called whenever [`estimate`](Self::estimate) is worth asking again.
    pub fn new(wake: Wake) -> Self {
        Self { worker: Worker::new(wake), current: None, count: 0, estimate: None, problem: None }
    }

    /// Traces `job`, anew where it is another one; `None` stops.
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

    /// What the rays say so far.
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

    /// Waits for an estimate of so many points.
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

    /// The error of `values` over the pixels that `estimate` judges.
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
        // How far the thread is when it is first asked depends on the machine, so the first round is traced here.
        let (early_rmse, late_rmse) = (judged_rmse(&late, &exact, &first_round), late.rmse(&exact).unwrap());
        // 4.3e-3 when this was written: sixty-four sets of sixteen points are noisier than one of 1024.
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
