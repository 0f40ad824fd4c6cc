//! Tracing in whole rounds on a background thread; its tracer uses further threads.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use antumbra_reference::Tracer;
use antumbra_scene::Scene;

use super::tracing::Tracing;
use super::{Estimate, Job};
use crate::background::Wake;

/// Handle of the thread, which ends when the handle is dropped.
pub struct Thread {
    tasks: Sender<Task>,
    estimates: Receiver<Result<Estimate, String>>,
    /// Cancels the current task.
    cancel: Arc<AtomicBool>,
}

struct Task {
    id: u64,
    job: Job,
    cancel: Arc<AtomicBool>,
}

impl fmt::Debug for Thread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Thread")
    }
}

impl Thread {
    /// Starts the thread, which calls `wake` with every estimate.
    pub fn new(wake: Wake) -> Self {
        let (tasks, incoming) = channel::<Task>();
        let (sender, estimates) = channel();
        thread::spawn(move || {
            let mut worker = Worker { tracer: None, sender, wake };
            while let Ok(mut task) = incoming.recv() {
                // Older tasks are obsolete.
                while let Ok(newer) = incoming.try_recv() {
                    task = newer;
                }
                worker.run(task);
            }
        });
        Self { tasks, estimates, cancel: Arc::default() }
    }

    /// Traces a job instead of the current one.
    pub fn start(&mut self, id: u64, job: Job) {
        self.stop();
        self.cancel = Arc::default();
        // Sending succeeds, because the thread lives as long as this value.
        let _ = self.tasks.send(Task { id, job, cancel: self.cancel.clone() });
    }

    /// Stops tracing.
    pub fn stop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Returns the oldest estimate not yet taken, or an error.
    pub fn take(&mut self) -> Option<Result<Estimate, String>> {
        self.estimates.try_recv().ok()
    }
}

struct Worker {
    /// Tracer of the last scene.
    tracer: Option<(Arc<Scene>, Tracer)>,
    sender: Sender<Result<Estimate, String>>,
    wake: Wake,
}

impl Worker {
    fn run(&mut self, task: Task) {
        let cancel = task.cancel.clone();
        if let Err(problem) = self.trace(task)
            && !cancel.load(Ordering::Relaxed)
        {
            let _ = self.sender.send(Err(problem));
            (self.wake)();
        }
    }

    /// Traces rounds until all are done or the task is cancelled.
    fn trace(&mut self, task: Task) -> Result<(), String> {
        let mut tracing = Tracing::new(task.id, task.job);
        let scene = &tracing.job().scene;
        if !self.tracer.as_ref().is_some_and(|(held, _)| Arc::ptr_eq(held, scene)) {
            let tracer = Tracer::new(scene).map_err(|error| error.to_string())?;
            self.tracer = Some((scene.clone(), tracer));
        }
        let Some((_, tracer)) = &self.tracer else { return Ok(()) };
        while !tracing.is_done() && !task.cancel.load(Ordering::Relaxed) {
            if let Some(estimate) = tracing.advance(tracer, u32::MAX, &task.cancel)? {
                if self.sender.send(Ok(estimate)).is_err() {
                    return Ok(());
                }
                (self.wake)();
            }
        }
        Ok(())
    }
}
