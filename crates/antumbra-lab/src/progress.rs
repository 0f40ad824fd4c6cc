//! Observers of long work. The laboratory reports what it does and how far it is; the caller decides what to show.

/// Receiver of progress reports of long work. All methods may be called from any thread.
pub trait Progress: Sync {
    /// A stage begins that has `steps` steps.
    fn begin(&self, stage: &str, steps: u64);
    /// `done` of the stage's steps are done.
    fn reach(&self, done: u64);
    /// The stage is over.
    fn end(&self);
    /// Something that the user should read, once: a technique skipped, a part of a scene left out.
    fn note(&self, text: &str);
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: u64) {}
    fn reach(&self, _: u64) {}
    fn end(&self) {}
    fn note(&self, _: &str) {}
}
