//! Views of layered textures, and a placeholder texture.

use super::Gpu;

/// Creates a view of all layers and levels of a texture.
pub(crate) fn array_view(gpu: &Gpu, texture: &wgpu::Texture) -> wgpu::TextureView {
    gpu.device.create_view(
        texture,
        &wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        },
    )
}

/// Creates a view of each layer of a texture, first level only.
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

/// Creates a texture of one white texel, a placeholder for a surface's texture.
pub(crate) fn white_texture(gpu: &Gpu) -> wgpu::TextureView {
    texture_of(gpu, "antumbra white", wgpu::TextureFormat::Rgba8Unorm, 1, &[255; 4])
}

/// Creates a square texture of `side` × `side` texels, given row by row.
pub(crate) fn texture_of(
    gpu: &Gpu,
    label: &str,
    format: wgpu::TextureFormat,
    side: u32,
    texels: &[u8],
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let bytes_per_row = Some(texels.len() as u32 / side);
    gpu.queue.write_texture(
        texture.as_image_copy(),
        texels,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None },
        texture.size(),
    );
    gpu.device.create_view(&texture, &wgpu::TextureViewDescriptor::default())
}
