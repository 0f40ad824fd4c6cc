//! Recorded commands, and whether they were ever submitted: what they would have written is not there if they were dropped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The commands of one owner, frame after frame.
#[derive(Debug, Default)]
pub(crate) struct Commands {
    are_dropped: Arc<AtomicBool>,
}

/// The end of some commands: done, or dropped.
#[derive(Debug)]
pub(crate) struct CommandsEnd {
    are_dropped: Arc<AtomicBool>,
    is_done: bool,
}

impl Commands {
    /// What new commands are recorded with.
    pub(crate) fn end(&self) -> CommandsEnd {
        CommandsEnd { are_dropped: Arc::clone(&self.are_dropped), is_done: false }
    }

    /// Whether any were dropped.
    pub(crate) fn are_dropped(&self) -> bool {
        self.are_dropped.load(Ordering::Acquire)
    }

    /// Whether any were dropped since this was called last.
    pub(crate) fn take_dropped(&self) -> bool {
        self.are_dropped.swap(false, Ordering::AcqRel)
    }
}

impl CommandsEnd {
    pub(super) fn done(mut self) {
        self.is_done = true;
    }
}

impl Drop for CommandsEnd {
    fn drop(&mut self) {
        if !self.is_done {
            self.are_dropped.store(true, Ordering::Release);
        }
    }
}
