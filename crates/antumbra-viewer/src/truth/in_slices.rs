//! Tracing without a thread: a few milliseconds of rows each time that someone asks for an estimate.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use antumbra_reference::Tracer;
use antumbra_scene::Scene;
use web_time::Instant;

use super::tracing::Tracing;
use super::{Estimate, Job};
use crate::aside::Wake;

/// How long a frame may trace: about half of a sixtieth of a second.
const SLICE: Duration = Duration::from_millis(8);
/// Rows between two looks at the clock: neighbours share what hides them, so single rows would cost more.
const ROWS: u32 = 4;

/// A job and how far it is.
pub struct Slices {
    wake: Wake,
    /// Of the scene that was traced last.
    tracer: Option<(Arc<Scene>, Tracer)>,
    tracing: Option<Tracing>,
    /// When the slice began that is going on; `None` before the first question of a frame.
    began: Option<Instant>,
}

impl fmt::Debug for Slices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Slices({:?})", self.tracing)
    }
}

impl Slices {
    /// Nothing to trace yet. `wake` is called after each slice that leaves something to trace.
    pub fn new(wake: Wake) -> Self {
        Self { wake, tracer: None, tracing: None, began: None }
    }

    /// Traces a job instead of what was traced before.
    pub fn start(&mut self, id: u64, job: Job) {
        self.tracing = Some(Tracing::new(id, job));
    }

    /// Traces nothing more.
    pub fn stop(&mut self) {
        self.tracing = None;
    }

    /// Traces until an estimate is there or the slice is over, which ends with `None`.
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
