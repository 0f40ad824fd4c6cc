//! Descriptor of textures that one pass writes and another reads.

use glam::UVec2;

/// Returns the descriptor of a texture that one pass writes and another reads.
pub(super) fn written(
    label: &'static str,
    format: wgpu::TextureFormat,
    size: UVec2,
    levels: u32,
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
        view_formats: &[],
    }
}
