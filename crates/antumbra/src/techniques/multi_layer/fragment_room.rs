//! Number of fragments that a frame allocates, from what earlier frames needed.

use super::MultiLayer;
use super::levels::{Level, list_count};
use crate::contract::{Error, Overflow};
use crate::gpu::{Feedback, Gpu, Stage};
use crate::light_map::texel_lists::FRAGMENT_BYTES;
use crate::techniques::Technique;

/// Fragments per texel of the base that the first frame allocates, before any count is known.
const FIRST_FRAGMENTS_PER_TEXEL: u32 = 4;

/// Factor on the number of fragments that the last frame needed, so that a moving scene seldom overflows.
const HEADROOM: f64 = 1.25;

/// Room for fragments.
#[derive(Debug)]
pub(super) struct FragmentRoom {
    /// Numbers of fragments that frames needed: of the base, and of all levels.
    pub(super) feedback: Feedback,
    pub(super) capacity: u32,
    /// Side of a square base with as many texels, in the frames that the feedback describes.
    pub(super) map_size: u32,
    /// Shortage in the last frame whose counts have arrived.
    pub(super) overflow: Option<Overflow>,
}

impl FragmentRoom {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self { feedback: Feedback::new(gpu, 2), capacity: 0, map_size: 0, overflow: None }
    }

    /// Sets the capacity from what the last frames needed, and records whether it sufficed.
    pub(super) fn update(&mut self, stage: &Stage<'_>, map_size: u32, levels: &[Level]) -> Result<(), Error> {
        let limits = stage.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let largest = (binding / FRAGMENT_BYTES) as u32;
        let lists = list_count(levels);
        if lists > largest {
            return Err(Error::Unsupported {
                technique: MultiLayer::NAME,
                needed: format!("{lists} lists for a base map of {map_size} × {map_size} texels"),
                had: format!("at most {largest} in a binding of {binding} bytes"),
                remedy: "set a smaller `map_size`",
            });
        }
        let needed = self.feedback.collect(stage).map(|counters| counters[0].max(counters[1]));
        self.overflow = needed.filter(|needed| *needed > self.capacity).map(|needed| Overflow {
            what: "fragments",
            needed: needed.into(),
            had: self.capacity.into(),
        });
        let first = (map_size * map_size).saturating_mul(FIRST_FRAGMENTS_PER_TEXEL);
        let wanted = needed.map_or(0, |needed| (f64::from(needed) * HEADROOM) as u32);
        if self.map_size != map_size {
            self.capacity = 0;
            self.map_size = map_size;
        }
        if self.overflow.is_some() || self.capacity == 0 {
            self.capacity = wanted.max(first).clamp(1024, largest);
        }
        Ok(())
    }
}
