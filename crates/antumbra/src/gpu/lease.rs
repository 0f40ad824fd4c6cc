//! Memory of lights' maps: each light's own within a budget, and shared by all lights beyond it.
//!
//! A light's own maps are cached from frame to frame. Shared ones are drawn and read by one light's commands before the next light's
//! overwrite them, so that a hundred lights need no more memory than one.

use std::sync::Arc;

use super::budget::OwnedBytes;
use super::device::Device;
use super::scratch::Scratch;

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
        self.owned.as_ref().map_or(0, OwnedBytes::bytes)
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

/// A buffer of a light's own within the budget, and shared beyond it.
#[derive(Debug, Default)]
pub(crate) struct LeasedBuffer(Option<(Lease, Arc<wgpu::Buffer>)>);

impl LeasedBuffer {
    /// The buffer of exactly so many bytes: the one at hand, or a new one.
    pub(crate) fn sized(
        &mut self,
        device: &Device,
        scratch: Scratch,
        descriptor: &wgpu::BufferDescriptor<'_>,
    ) -> &wgpu::Buffer {
        // What is there goes back to the budget before another is taken.
        let made = self.0.take().filter(|(_, buffer)| buffer.size() == descriptor.size);
        let (_, buffer) = self.0.insert(made.unwrap_or_else(|| {
            let lease = Lease::new(device, descriptor.size);
            let buffer = lease.buffer(device, scratch, descriptor);
            (lease, buffer)
        }));
        buffer
    }

    /// The buffer; `None` before it was asked for.
    #[cfg(test)]
    pub(crate) fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.0.as_ref().map(|(_, buffer)| &**buffer)
    }

    /// Bytes of it where the light owns it.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.0.as_ref().map_or(0, |(lease, _)| lease.own_bytes())
    }
}
