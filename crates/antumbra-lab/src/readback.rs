//! Textures back on the CPU, rows tightly packed, the top row first.

use crate::device::{DeviceError, LabDevice};

/// Reads an `R32Float` or `Depth32Float` texture: `width · height` values.
///
/// # Errors
/// Where the device failed, now or in the work before.
pub fn read_f32(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<f32>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads one layer of an `R32Float` array: `width · height` values.
///
/// # Errors
/// Where the device failed, now or in the work before.
pub fn read_f32_layer(lab: &LabDevice, texture: &wgpu::Texture, layer: u32) -> Result<Vec<f32>, DeviceError> {
    read_texels(lab, texture, layer)
}

/// Reads an `Rgba32Float` texture: `width · height` texels.
///
/// # Errors
/// Where the device failed, now or in the work before.
pub fn read_rgba32f(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<[f32; 4]>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads an `Rgba32Uint` texture: `width · height` texels.
///
/// # Errors
/// Where the device failed, now or in the work before.
pub fn read_rgba32u(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<[u32; 4]>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads a texture of four bytes a texel, as they are stored: `width · height` texels.
///
/// # Errors
/// Where the device failed, now or in the work before.
pub fn read_rgba8(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<[u8; 4]>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Copies the first level of a layer of a texture with usage `COPY_SRC` through a buffer, and waits.
fn read_texels<T: bytemuck::Pod>(lab: &LabDevice, texture: &wgpu::Texture, layer: u32) -> Result<Vec<T>, DeviceError> {
    let (width, height) = (texture.width(), texture.height());
    let row_bytes = width as usize * size_of::<T>();
    let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
    let buffer = lab.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: (padded_row_bytes * height as usize) as u64,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x: 0, y: 0, z: layer }, ..texture.as_image_copy() },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row_bytes as u32),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    lab.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    // A copy that was refused leaves nothing mapped; the device's own words say why.
    lab.check()?;
    let mapped = buffer
        .get_mapped_range(..)
        .map_err(|error| DeviceError::Failed { count: 1, first: format!("cannot map what was read back: {error}") })?;
    let mut texels = vec![T::zeroed(); width as usize * height as usize];
    for (row, padded) in texels.chunks_exact_mut(width as usize).zip(mapped.chunks_exact(padded_row_bytes)) {
        bytemuck::cast_slice_mut(row).copy_from_slice(&padded[..row_bytes]);
    }
    Ok(texels)
}
