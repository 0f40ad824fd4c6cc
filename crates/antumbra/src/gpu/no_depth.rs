//! The attachment of passes that write to storage alone: a pass must have one. Nothing is compared with it or stored in
//! it.

use std::sync::Arc;

use glam::UVec2;

use super::{Gpu, Scratch, depth_state, texture_bytes};

/// Depth attachment without content.
#[derive(Debug)]
pub(crate) struct NoDepth {
    texture: Arc<wgpu::Texture>,
    pub(crate) view: wgpu::TextureView,
}

impl NoDepth {
    /// Of the fewest bytes that every device can render to.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

    /// `size` texels along each side.
    pub(crate) fn new(gpu: &Gpu, size: UVec2, sample_count: u32) -> Self {
        Self::of(gpu, Arc::new(gpu.device.create_texture(&Self::descriptor(size, sample_count))))
    }

    /// At least of this size: one that some light has, or a new one whose sides are powers of two.
    pub(crate) fn shared(gpu: &Gpu, size: UVec2, sample_count: u32) -> Self {
        let size = UVec2::new(size.x.next_power_of_two(), size.y.next_power_of_two());
        Self::of(gpu, gpu.device.scratch_texture(Scratch::NoDepth, &Self::descriptor(size, sample_count)))
    }

    fn descriptor(size: UVec2, sample_count: u32) -> wgpu::TextureDescriptor<'static> {
        wgpu::TextureDescriptor {
            label: Some("antumbra no depth"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        }
    }

    fn of(gpu: &Gpu, texture: Arc<wgpu::Texture>) -> Self {
        let view = gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// How a pipeline takes it: nothing is compared, nothing written.
    pub(crate) fn state() -> wgpu::DepthStencilState {
        depth_state(Self::FORMAT, wgpu::CompareFunction::Always, false)
    }

    /// Texels along each side.
    pub(crate) fn size(&self) -> UVec2 {
        UVec2::new(self.texture.width(), self.texture.height())
    }

    /// Samples a texel.
    pub(crate) fn sample_count(&self) -> u32 {
        self.texture.sample_count()
    }

    pub(crate) fn memory_bytes(&self) -> u64 {
        texture_bytes(&self.texture)
    }
}
