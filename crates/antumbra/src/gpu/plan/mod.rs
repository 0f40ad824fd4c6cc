//! Plan of GPU memory: the lights' own `prepare` on a device that keeps descriptors and creates nothing.
//!
//! ```text
//!  MemoryPlan::new(gpu) ─► Gpu of a planned device ─► Shadow::prepare ─► create_buffer, create_texture ─► Ledger
//!     limits, features,       (same code as on                             bytes and label of each,
//!     what is left of         the real device)                             returned when it is dropped
//!     the map budget
//! ```
//!
//! wgpu takes a device of one's own ([`wgpu::custom`]). So techniques, pool, budget and reports are those of a real frame, and a plan
//! cannot differ from what the frame then takes, as far as that is known before it is drawn.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Gpu;
use super::device::Device;

mod commands;
mod device;
mod objects;
#[cfg(test)]
mod tests;

use device::{PlannedDevice, PlannedQueue};

/// Plan of GPU memory: lights are prepared on a device that allocates and compiles nothing, and report what they would take.
///
/// Use [`gpu`](Self::gpu) in place of the real handle: create techniques with it, set their parameters and
/// [`prepare`](crate::Shadow::prepare) their frames. [`Shadow::memory_bytes`](crate::Shadow::memory_bytes) then is what the light will
/// retain, and [`Gpu::memory_bytes`] what all planned lights will share. The numbers are bytes and those that the same calls report
/// after the same frames on the real device, with two exceptions: lists whose length only the GPU knows may grow in later frames,
/// which [`Shadow::overflow`](crate::Shadow::overflow) reports, and drivers may align and pad what they allocate.
///
/// Receivers, masks and casters may be the real ones, or be made with the [`device`](Gpu::device) of the planned handle, which
/// allocates nothing for them. Nothing planned may be given to a real device. [`Prepared::record`](crate::Prepared::record) of a planned
/// light records nothing.
#[derive(Debug)]
pub struct MemoryPlan {
    gpu: Gpu,
    ledger: Arc<Ledger>,
}

/// Planned buffers and textures of one label.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlannedResource {
    /// The label that graphics debuggers show.
    pub label: String,
    /// Number of resources.
    pub count: u64,
    /// Bytes of all of them together.
    pub bytes: u64,
}

impl MemoryPlan {
    /// A plan for the device of `gpu`, with its limits and features and what is left of its
    /// [map budget](Gpu::set_map_budget) at present: planned lights come beside those that there are.
    pub fn new(gpu: &Gpu) -> Self {
        let ledger = Arc::new(Ledger::default());
        let device = wgpu::Device::from_custom(PlannedDevice::new(gpu.device(), &ledger));
        let queue = wgpu::Queue::from_custom(PlannedQueue);
        let gpu = Gpu { device: Device::planned(&gpu.device, &device), queue };
        Self { gpu, ledger }
    }

    /// The handle of the planned device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Buffers and textures that planned lights hold at present, small ones included, by label; those that take most come first.
    pub fn resources(&self) -> Vec<PlannedResource> {
        let held = self.ledger.held();
        let mut resources: Vec<_> = held
            .iter()
            .map(|(label, of_label)| PlannedResource {
                label: label.clone(),
                count: of_label.count,
                bytes: of_label.bytes,
            })
            .collect();
        resources.sort_by_key(|resource| std::cmp::Reverse(resource.bytes));
        resources
    }
}

/// Bytes of planned resources by label.
#[derive(Debug, Default)]
struct Ledger(Mutex<BTreeMap<String, OfLabel>>);

#[derive(Clone, Copy, Debug, Default)]
struct OfLabel {
    count: u64,
    bytes: u64,
}

impl Ledger {
    fn held(&self) -> MutexGuard<'_, BTreeMap<String, OfLabel>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Enters a resource, until the entry is dropped.
    fn enter(self: &Arc<Self>, label: Option<&str>, bytes: u64) -> Entry {
        let label = label.unwrap_or_default().to_owned();
        let mut held = self.held();
        let of_label = held.entry(label.clone()).or_default();
        of_label.count += 1;
        of_label.bytes += bytes;
        Entry { ledger: Arc::clone(self), label, bytes }
    }
}

/// One resource in a ledger.
#[derive(Debug)]
struct Entry {
    ledger: Arc<Ledger>,
    label: String,
    bytes: u64,
}

impl Drop for Entry {
    fn drop(&mut self) {
        let mut held = self.ledger.held();
        let Some(of_label) = held.get_mut(&self.label) else { return };
        of_label.count -= 1;
        of_label.bytes -= self.bytes;
        if of_label.count == 0 {
            held.remove(&self.label);
        }
    }
}
