//! Plan of GPU memory: runs the lights' own `prepare` on a device that keeps descriptors and creates nothing.
//!
//! ```text
//!  MemoryPlan::new(gpu) ─► Gpu of a planned device ─► Shadow::prepare ─► create_buffer, create_texture ─► Ledger
//!     limits, features,       (same code as on                             bytes and label of each,
//!     what is left of         the real device)                             returned when it is dropped
//!     the map budget
//! ```
//!
//! wgpu accepts custom devices ([`wgpu::custom`]). So techniques, resource pool, budget and reports are those of a real frame,
//! and the plan equals what the frame allocates, as far as that is known before drawing.

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

/// Plan of GPU memory. Lights are prepared on a device that allocates and compiles nothing, and report what they would allocate.
///
/// Use [`gpu`](Self::gpu) in place of the real handle: create techniques with it, set their parameters and
/// [`prepare`](crate::Shadow::prepare) their frames. [`Shadow::memory_bytes`](crate::Shadow::memory_bytes) then returns what
/// the light will retain, and [`Gpu::memory_bytes`] what all planned lights will share. Both equal what the same calls return
/// after the same frames on the real device, with two exceptions. Lists whose length only the GPU knows may grow in later
/// frames, which [`Shadow::overflow`](crate::Shadow::overflow) reports. Drivers may align and pad allocations.
///
/// Receivers, masks and casters may be real ones, or be created with the [`device`](Gpu::device) of the planned handle, which
/// allocates nothing for them. Do not pass planned resources to a real device. [`Prepared::record`](crate::Prepared::record) of
/// a planned light records nothing.
#[derive(Debug)]
pub struct MemoryPlan {
    gpu: Gpu,
    ledger: Arc<Ledger>,
}

/// Planned buffers and textures with the same label.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlannedResource {
    /// The label that graphics debuggers show.
    pub label: String,
    /// Number of resources.
    pub count: u64,
    /// Bytes of all these resources together.
    pub bytes: u64,
}

impl MemoryPlan {
    /// Creates a plan for the device of `gpu`, with its limits and features. Planned lights are added to the existing ones:
    /// they get the part of the [map budget](Gpu::set_map_budget) that is left.
    pub fn new(gpu: &Gpu) -> Self {
        let ledger = Arc::new(Ledger::default());
        let device = wgpu::Device::from_custom(PlannedDevice::new(gpu.device(), &ledger));
        let queue = wgpu::Queue::from_custom(PlannedQueue);
        let gpu = Gpu { device: Device::planned(&gpu.device, &device), queue };
        Self { gpu, ledger }
    }

    /// Handle of the planned device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Buffers and textures that planned lights hold at present, including small ones, by label, largest first.
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

    /// Adds a resource until the returned entry is dropped.
    fn enter(self: &Arc<Self>, label: Option<&str>, bytes: u64) -> Entry {
        let label = label.unwrap_or_default().to_owned();
        let mut held = self.held();
        let of_label = held.entry(label.clone()).or_default();
        of_label.count += 1;
        of_label.bytes += bytes;
        Entry { ledger: Arc::clone(self), label, bytes }
    }
}

/// Entry of one resource in a ledger.
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
