//! What shadows cost, for whoever wants to see it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use bevy::prelude::*;

/// What the last frame's shadows were of, and what they cost the processor. A resource of the main world.
#[derive(Resource, Clone, Debug, Default)]
pub struct ShadowCounts(Arc<Mutex<Counts>>);

/// Of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Lights that had shadows.
    pub lights: usize,
    /// Casters.
    pub casters: usize,
    /// Textures, buffers, bind groups and the like that the library has made since the start. A frame that only moves makes
    /// none.
    pub objects_created: u64,
    /// Bytes of GPU memory of casters and of lights' states; masks apart.
    pub memory_bytes: u64,
    /// Processor time of the render world's own work for shadows: casters brought up to date, frames prepared and recorded.
    pub processor_time: Duration,
}

impl ShadowCounts {
    /// Those of the last frame.
    pub fn get(&self) -> Counts {
        *self.lock()
    }

    /// The last frame's, to be changed.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Counts> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds the time since a moment.
    pub(crate) fn spend(&self, since: Instant) {
        self.lock().processor_time += since.elapsed();
    }

    /// A frame begins.
    pub(crate) fn begin(&self) {
        self.lock().processor_time = Duration::ZERO;
    }
}
