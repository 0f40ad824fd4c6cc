//! Views of layered textures, and the texture that stands in for none.

use super::Gpu;

/// All layers of a texture, with all their levels.
pub(crate) fn array_view(gpu: &Gpu, texture: &wgpu::Texture) -> wgpu::TextureView {
    gpu.device.create_view(
        texture,
        &wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        },
    )
}

/// The first level of each layer of a texture alone.
pub(crate) fn slice_views(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<wgpu::TextureView> {
    let slice = |base_array_layer| {
        gpu.device.create_view(
            texture,
            &wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                mip_level_count: Some(1),
                base_array_layer,
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            },
        )
    };
    (0..texture.depth_or_array_layers()).map(slice).collect()
}

/// Each level of a texture alone, with all its layers.
pub(crate) fn level_views(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<wgpu::TextureView> {
    let level = |base_mip_level| {
        gpu.device.create_view(
            texture,
            &wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                base_mip_level,
                mip_level_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            },
        )
    };
    (0..texture.mip_level_count()).map(level).collect()
}

/// One white texel, in the place of a surface's texture.
pub(crate) fn white_texture(gpu: &Gpu) -> wgpu::TextureView {
    let white = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("antumbra white"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    gpu.queue.write_texture(
        white.as_image_copy(),
        &[255; 4],
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None },
        white.size(),
    );
    gpu.device.create_view(&white, &wgpu::TextureViewDescriptor::default())
}
