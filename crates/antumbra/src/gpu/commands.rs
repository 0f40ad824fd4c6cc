//! Tracking of recorded commands that were dropped instead of submitted, so that their output is missing.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Commands of one owner over all frames.
#[derive(Debug, Default)]
pub(crate) struct Commands {
    are_dropped: Arc<AtomicBool>,
}

/// Completion token of some commands: marks them as dropped unless [`done`](Self::done) is called.
#[derive(Debug)]
pub(crate) struct CommandsEnd {
    are_dropped: Arc<AtomicBool>,
    is_done: bool,
}

impl Commands {
    /// Returns the completion token for new commands.
    pub(crate) fn end(&self) -> CommandsEnd {
        CommandsEnd { are_dropped: Arc::clone(&self.are_dropped), is_done: false }
    }

    /// Whether any commands were dropped since the last [`take_dropped`](Self::take_dropped).
    pub(crate) fn are_dropped(&self) -> bool {
        self.are_dropped.load(Ordering::Acquire)
    }

    /// Whether any commands were dropped since the last call; clears the flag.
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
