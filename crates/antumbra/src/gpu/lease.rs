//! Memory of lights' maps: each light's own within a budget, and shared by all lights beyond it.
//!
//! A light's own maps are cached from frame to frame. Shared ones are drawn and read by one light's commands before the next light's
//! overwrite them, so that a hundred lights need no more memory than one.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::device::{Device, Scratch};

/// Budget of all lights together by default, bytes.
const DEFAULT_BUDGET_BYTES: u64 = 256 << 20;

/// Memory budget of what lights own.
#[derive(Debug)]
pub(super) struct Budget {
    bytes: AtomicU64,
    owned_bytes: AtomicU64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { bytes: DEFAULT_BUDGET_BYTES.into(), owned_bytes: 0.into() }
    }
}

impl Budget {
    pub(super) fn set(&self, bytes: u64) {
        self.bytes.store(bytes, Ordering::Relaxed);
    }

    pub(super) fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    pub(super) fn owned_bytes(&self) -> u64 {
        self.owned_bytes.load(Ordering::Relaxed)
    }

    /// Reserves bytes; `None` where fewer are left.
    fn take(self: &Arc<Self>, bytes: u64) -> Option<OwnedBytes> {
        let add = |owned: u64| owned.checked_add(bytes).filter(|all| *all <= self.bytes());
        self.owned_bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add).ok()?;
        Some(OwnedBytes { budget: Arc::clone(self), bytes })
    }
}

/// Reserved bytes, returned to the budget when dropped.
#[derive(Debug)]
struct OwnedBytes {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Drop for OwnedBytes {
    fn drop(&mut self) {
        self.budget.owned_bytes.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// One light's right to textures and buffers: its own, or those that all lights share.
#[derive(Debug)]
pub(crate) struct Lease {
    owned: Option<OwnedBytes>,
}

impl Lease {
    /// For so many bytes together.
    pub(crate) fn new(device: &Device, bytes: u64) -> Self {
        Self { owned: device.budget().take(bytes) }
    }

    /// Whether they are the light's own, and hold what they held in the frame before.
    pub(crate) fn is_own(&self) -> bool {
        self.owned.is_some()
    }

    /// Bytes of what the light owns.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.owned.as_ref().map_or(0, |owned| owned.bytes)
    }

    /// One of them; the light keeps it as long as it draws.
    pub(crate) fn texture(
        &self,
        device: &Device,
        scratch: Scratch,
        descriptor: &wgpu::TextureDescriptor<'_>,
    ) -> Arc<wgpu::Texture> {
        match &self.owned {
            Some(_) => Arc::new(device.create_texture(descriptor)),
            None => device.scratch_texture(scratch, descriptor),
        }
    }

    /// The same of a buffer.
    pub(crate) fn buffer(
        &self,
        device: &Device,
        scratch: Scratch,
        descriptor: &wgpu::BufferDescriptor<'_>,
    ) -> Arc<wgpu::Buffer> {
        match &self.owned {
            Some(_) => Arc::new(device.create_buffer(descriptor)),
            None => device.scratch_buffer(scratch, descriptor),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_taken_and_given_back() {
        let budget = Arc::new(Budget::default());
        budget.set(100);
        let first = budget.take(60).expect("there is room");
        assert!(budget.take(41).is_none());
        let second = budget.take(40).expect("there is just room");
        assert_eq!(budget.owned_bytes(), 100);
        drop(first);
        assert_eq!(budget.owned_bytes(), 40);
        assert!(budget.take(u64::MAX).is_none());
        drop(second);
        assert_eq!(budget.owned_bytes(), 0);
    }
}
