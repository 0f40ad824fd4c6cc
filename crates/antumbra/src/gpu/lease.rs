//! Memory of lights' maps: owned by one light within a budget, and shared by all lights beyond it.
//!
//! Owned maps are cached from frame to frame. Shared ones are drawn and read by one light's commands before the next light's
//! overwrite them, so that a hundred lights need no more memory than one.

use std::sync::Arc;

use super::budget::OwnedBytes;
use super::device::Device;
use super::scratch::Scratch;

/// Right of one light to textures and buffers: owned, or shared by all lights.
#[derive(Debug)]
pub(crate) struct Lease {
    owned: Option<OwnedBytes>,
}

impl Lease {
    /// Reserves `bytes` bytes of the map budget; if they exceed it, the resources are shared.
    pub(crate) fn new(device: &Device, bytes: u64) -> Self {
        Self { owned: device.budget().take(bytes) }
    }

    /// Whether the resources are owned, so that they retain the last frame's content.
    pub(crate) fn is_own(&self) -> bool {
        self.owned.is_some()
    }

    /// Memory that the light owns, bytes.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.owned.as_ref().map_or(0, OwnedBytes::bytes)
    }

    /// Returns a texture; the light holds it as long as it draws.
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

    /// Returns a buffer; the light holds it as long as it draws.
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

/// Buffer that a light owns within the budget, and shares beyond it.
#[derive(Debug, Default)]
pub(crate) struct LeasedBuffer(Option<(Lease, Arc<wgpu::Buffer>)>);

impl LeasedBuffer {
    /// Returns a buffer of exactly the descriptor's size: the existing one, or a new one.
    pub(crate) fn sized(
        &mut self,
        device: &Device,
        scratch: Scratch,
        descriptor: &wgpu::BufferDescriptor<'_>,
    ) -> &wgpu::Buffer {
        // Return the old buffer's bytes to the budget before reserving new ones.
        let made = self.0.take().filter(|(_, buffer)| buffer.size() == descriptor.size);
        let (_, buffer) = self.0.insert(made.unwrap_or_else(|| {
            let lease = Lease::new(device, descriptor.size);
            let buffer = lease.buffer(device, scratch, descriptor);
            (lease, buffer)
        }));
        buffer
    }

    /// Buffer; `None` before the first request.
    #[cfg(test)]
    pub(crate) fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.0.as_ref().map(|(_, buffer)| &**buffer)
    }

    /// Memory of the buffer, bytes; 0 if it is shared.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.0.as_ref().map_or(0, |(lease, _)| lease.own_bytes())
    }
}
