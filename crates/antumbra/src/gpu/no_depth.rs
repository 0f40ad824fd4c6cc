//! The attachment of passes that write to storage alone: a pass must have one. Nothing is compared with it or stored in
//! it.

use std::sync::Arc;

use glam::UVec2;

use super::{Gpu, Scratch, depth_state};

/// Depth attachment without content.
#[derive(Debug)]
pub(crate) struct NoDepth {
    attachment: Arc<(wgpu::Texture, wgpu::TextureView)>,
}

impl NoDepth {
    /// Of the fewest bytes that every device can render to.
    pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

    /// `size` texels along each side; all lights share it.
    pub(crate) fn new(gpu: &Gpu, size: UVec2, sample_count: u32) -> Self {
        let descriptor = Self::descriptor(size, sample_count);
        Self { attachment: gpu.device.scratch_attachment(Scratch::NoDepth, &descriptor) }
    }

    /// At least of this size, with powers of two as sides.
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

    /// What passes draw to.
    pub(crate) fn view(&self) -> &wgpu::TextureView {
        &self.attachment.1
    }

    /// How a pipeline takes it: nothing is compared, nothing written.
    pub(crate) fn state() -> wgpu::DepthStencilState {
        depth_state(Self::FORMAT, wgpu::CompareFunction::Always, false)
    }

    /// Texels along each side.
    pub(crate) fn size(&self) -> UVec2 {
        UVec2::new(self.attachment.0.width(), self.attachment.0.height())
    }

    /// Samples a texel.
    pub(crate) fn sample_count(&self) -> u32 {
        self.attachment.0.sample_count()
    }
}
