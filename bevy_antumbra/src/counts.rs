//! Cost of shadows, for display.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use bevy::prelude::*;

/// Counts and processor time of the last frame's shadows. A resource of the main world.
#[derive(Resource, Clone, Debug, Default)]
pub struct ShadowCounts(Arc<Mutex<Counts>>);

/// Counts of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Number of lights with shadows.
    pub lights: usize,
    /// Number of casters.
    pub casters: usize,
    /// Number of wgpu resources (textures, buffers, bind groups and so on) that the library has created since the start. A frame
    /// that only moves creates none.
    pub objects_created: u64,
    /// GPU memory of casters and lights' states, bytes; without masks.
    pub memory_bytes: u64,
    /// Processor time of the render world's own work for shadows: synchronising casters, preparing and recording frames.
    pub processor_time: Duration,
}

impl ShadowCounts {
    /// Returns the counts of the last frame.
    pub fn get(&self) -> Counts {
        *self.lock()
    }

    /// Locks the counts for changes.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Counts> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds the time since `since` to the processor time.
    pub(crate) fn spend(&self, since: Instant) {
        self.lock().processor_time += since.elapsed();
    }

    /// Resets the processor time at the start of a frame.
    pub(crate) fn begin(&self) {
        self.lock().processor_time = Duration::ZERO;
    }
}
