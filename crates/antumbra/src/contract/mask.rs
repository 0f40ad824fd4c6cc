//! What comes out: a visibility mask the size of the receivers.

use glam::UVec2;

/// The visibility mask: `R32Float`, 1 lit, 0 umbra. Every pixel is written once per light; the host multiplies.
#[derive(Clone, Debug)]
pub struct Mask {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Mask {
    /// The mask's format: the one single-channel format that every WebGPU adapter can write and accumulate in compute.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

    /// A mask of `size_px` pixels.
    pub fn new(device: &wgpu::Device, size_px: UVec2) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra mask"),
            size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Self::FORMAT,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// Size in pixels.
    pub fn size_px(&self) -> UVec2 {
        UVec2::new(self.texture.width(), self.texture.height())
    }

    /// The texture, for copies.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// The view, for shaders: `texture_2d<f32>`, read by `textureLoad`.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }
}
