//! Depth attachment for passes that write only to storage, because a pass needs an attachment. It is neither compared
//! with nor written.

use std::sync::Arc;

use glam::UVec2;

use super::{Gpu, Scratch, depth_state};

/// Depth attachment without content.
#[derive(Debug)]
pub(crate) struct NoDepth {
    attachment: Arc<(wgpu::Texture, wgpu::TextureView)>,
}

impl NoDepth {
    /// Renderable format of the fewest bytes that every device supports.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

    /// Returns an attachment of `size` texels, shared by all lights.
    pub(crate) fn new(gpu: &Gpu, size: UVec2, sample_count: u32) -> Self {
        let descriptor = Self::descriptor(size, sample_count);
        Self { attachment: gpu.device.scratch_attachment(Scratch::NoDepth, &descriptor) }
    }

    /// Returns an attachment of at least `size` texels, rounded up to powers of two.
    pub(crate) fn at_least(gpu: &Gpu, size: UVec2, sample_count: u32) -> Self {
        Self::new(gpu, UVec2::new(size.x.next_power_of_two(), size.y.next_power_of_two()), sample_count)
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

    /// View that passes draw to.
    pub(crate) fn view(&self) -> &wgpu::TextureView {
        &self.attachment.1
    }

    /// Depth state of pipelines that use it: always passes, never writes.
    pub(crate) fn state() -> wgpu::DepthStencilState {
        depth_state(Self::FORMAT, wgpu::CompareFunction::Always, false)
    }

    /// Size, texels.
    pub(crate) fn size(&self) -> UVec2 {
        UVec2::new(self.attachment.0.width(), self.attachment.0.height())
    }

    /// Samples per texel.
    pub(crate) fn sample_count(&self) -> u32 {
        self.attachment.0.sample_count()
    }
}
