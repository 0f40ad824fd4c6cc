//! Progress of long work. The laboratory reports stages and steps; the caller decides what to show.

/// Receiver of progress reports of long work. All methods may be called from any thread.
pub trait Progress: Sync {
    /// Starts a stage with `steps` steps.
    fn begin(&self, stage: &str, steps: u64);
    /// Reports that `done` of the stage's steps are done.
    fn reach(&self, done: u64);
    /// Ends the stage.
    fn end(&self);
    /// Reports something that the user should read, once: a skipped technique, an omitted part of a scene.
    fn note(&self, text: &str);
}

/// Progress receiver that ignores everything.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: u64) {}
    fn reach(&self, _: u64) {}
    fn end(&self) {}
    fn note(&self, _: &str) {}
}
