//! Tracing without a thread: a few milliseconds of rows whenever an estimate is requested.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use antumbra_reference::Tracer;
use antumbra_scene::Scene;
use web_time::Instant;

use super::tracing::Tracing;
use super::{Estimate, Job};
use crate::background::Wake;

/// Tracing time per frame: about half of a sixtieth of a second.
const SLICE: Duration = Duration::from_millis(8);
/// Rows between two checks of the clock. Neighbouring pixels share occluders, so single rows would cost more.
const ROWS: u32 = 4;

/// Time-sliced tracer of one job.
pub struct Slices {
    wake: Wake,
    /// Tracer of the last scene.
    tracer: Option<(Arc<Scene>, Tracer)>,
    tracing: Option<Tracing>,
    /// Start of the current time slice; `None` before the first request of a frame.
    began: Option<Instant>,
}

impl fmt::Debug for Slices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Slices({:?})", self.tracing)
    }
}

impl Slices {
    /// Creates a tracer without a job. `wake` is called after each time slice that leaves work.
    pub fn new(wake: Wake) -> Self {
        Self { wake, tracer: None, tracing: None, began: None }
    }

    /// Traces a job instead of the current one.
    pub fn start(&mut self, id: u64, job: Job) {
        self.tracing = Some(Tracing::new(id, job));
    }

    /// Stops tracing.
    pub fn stop(&mut self) {
        self.tracing = None;
    }

    /// Traces until an estimate is available or the time slice ends. The end of the slice returns `None`.
    pub fn take(&mut self) -> Option<Result<Estimate, String>> {
        let began = *self.began.get_or_insert_with(Instant::now);
        while began.elapsed() < SLICE {
            match self.advance() {
                Ok(None) if self.tracing.is_some() => {}
                Ok(None) => break,
                Ok(Some(estimate)) => return Some(Ok(estimate)),
                Err(problem) => {
                    self.tracing = None;
                    return Some(Err(problem));
                }
            }
        }
        self.began = None;
        if self.tracing.is_some() {
            (self.wake)();
        }
        None
    }

    fn advance(&mut self) -> Result<Option<Estimate>, String> {
        let Some(tracing) = &mut self.tracing else { return Ok(None) };
        let scene = &tracing.job().scene;
        if !self.tracer.as_ref().is_some_and(|(held, _)| Arc::ptr_eq(held, scene)) {
            let tracer = Tracer::new(scene).map_err(|error| error.to_string())?;
            self.tracer = Some((scene.clone(), tracer));
        }
        let Some((_, tracer)) = &self.tracer else { return Ok(None) };
        let estimate = tracing.advance(tracer, ROWS, &AtomicBool::new(false))?;
        if tracing.is_done() {
            self.tracing = None;
        }
        Ok(estimate)
    }
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{LoadOptions, Setup, load};
    use glam::UVec2;

    use super::super::on_thread::Thread;
    use super::*;

    #[test]
    fn slices_come_to_what_a_thread_traces() {
        let scene = Arc::new(load("builtin:overlap", &LoadOptions::default()).unwrap());
        let setup = Setup::for_scene(&scene);
        let light = setup.lights[0].clone();
        let job = Job { scene, camera: setup.camera, size_px: UVec2::new(31, 19), light };
        let mut slices = Slices::new(Arc::new(|| {}));
        slices.start(1, job.clone());
        let mut thread = Thread::new(Arc::new(|| {}));
        thread.start(1, job);
        for points in [16, 32, 48] {
            let sliced = std::iter::repeat_with(|| slices.take()).flatten().next().unwrap().unwrap();
            let whole = std::iter::repeat_with(|| thread.take()).flatten().next().unwrap().unwrap();
            assert_eq!((sliced.points, whole.points), (points, points));
            assert_eq!(sliced.values, whole.values);
            assert!(sliced.values.iter().any(|value| *value > 0.0 && *value < 1.0), "no penumbra");
        }
        slices.stop();
        assert!(slices.take().is_none());
    }
}
