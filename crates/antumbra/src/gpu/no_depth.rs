//! The attachment of passes that write to storage alone: a pass must have one. Nothing is compared with it or stored in
//! it.

use std::sync::Arc;

use glam::UVec2;

use super::{Gpu, depth_state};

/// A texture of no use but its size.
#[derive(Debug)]
pub(crate) struct NoDepth {
    size: UVec2,
    sample_count: u32,
    pub(crate) view: wgpu::TextureView,
}

impl NoDepth {
    /// Of the fewest bytes that every device can render to.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

    /// `size` texels along each side.
    pub(crate) fn new(gpu: &Gpu, size: UVec2, sample_count: u32) -> Self {
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra no depth"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        Self { size, sample_count, view: gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default()) }
    }

    /// At least of this size: one that some light has, or a new one whose sides are powers of two.
    pub(crate) fn shared(gpu: &Gpu, size: UVec2, sample_count: u32) -> Arc<Self> {
        let size = UVec2::new(size.x.next_power_of_two(), size.y.next_power_of_two());
        gpu.device.no_depth(size, sample_count, || Self::new(gpu, size, sample_count))
    }

    /// How a pipeline takes it: nothing is compared, nothing written.
    pub(crate) fn state() -> wgpu::DepthStencilState {
        depth_state(Self::FORMAT, wgpu::CompareFunction::Always, false)
    }

    /// Texels along each side.
    pub(crate) fn size(&self) -> UVec2 {
        self.size
    }

    /// Samples a texel.
    pub(crate) fn sample_count(&self) -> u32 {
        self.sample_count
    }

    pub(crate) fn memory_bytes(&self) -> u64 {
        2 * u64::from(self.sample_count) * u64::from(self.size.element_product())
    }
}
