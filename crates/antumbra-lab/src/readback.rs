//! Readback of textures and buffers to the CPU. Rows of textures are tightly packed, top row first.

use crate::device::{DeviceError, LabDevice};

/// Reads an `R32Float` or `Depth32Float` texture: `width · height` values.
///
/// # Errors
/// If the device fails, also in earlier work.
pub fn read_f32(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<f32>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads one layer of an `R32Float` array: `width · height` values.
///
/// # Errors
/// If the device fails, also in earlier work.
pub fn read_f32_layer(lab: &LabDevice, texture: &wgpu::Texture, layer: u32) -> Result<Vec<f32>, DeviceError> {
    read_texels(lab, texture, layer)
}

/// Reads an `Rgba32Float` texture: `width · height` texels.
///
/// # Errors
/// If the device fails, also in earlier work.
pub fn read_rgba32f(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<[f32; 4]>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads an `Rgba32Uint` texture: `width · height` texels.
///
/// # Errors
/// If the device fails, also in earlier work.
pub fn read_rgba32u(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<[u32; 4]>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads a texture of four bytes per texel, as stored: `width · height` texels.
///
/// # Errors
/// If the device fails, also in earlier work.
pub fn read_rgba8(lab: &LabDevice, texture: &wgpu::Texture) -> Result<Vec<[u8; 4]>, DeviceError> {
    read_texels(lab, texture, 0)
}

/// Reads the first values of a buffer with usage `COPY_SRC`: all of them, but at most `most`.
///
/// # Errors
/// If the device fails, also in earlier work.
pub fn read_buffer<T: bytemuck::Pod>(
    lab: &LabDevice,
    source: &wgpu::Buffer,
    most: usize,
) -> Result<Vec<T>, DeviceError> {
    let size = source.size().min((most * size_of::<T>()) as u64);
    let buffer = readback_buffer(lab, size);
    let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    encoder.copy_buffer_to_buffer(source, 0, &buffer, 0, size);
    lab.queue.submit([encoder.finish()]);
    Ok(bytemuck::pod_collect_to_vec(&mapped(lab, &buffer)?))
}

fn readback_buffer(lab: &LabDevice, size: u64) -> wgpu::Buffer {
    lab.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

/// Returns a buffer's bytes after all submitted work is done.
fn mapped(lab: &LabDevice, buffer: &wgpu::Buffer) -> Result<wgpu::BufferView, DeviceError> {
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    // A rejected copy leaves nothing mapped; the device's error has the reason.
    lab.check()?;
    buffer
        .get_mapped_range(..)
        .map_err(|error| DeviceError::Failed { count: 1, first: format!("cannot map the readback buffer: {error}") })
}

/// Reads the first mip level of a layer of a texture with usage `COPY_SRC` through a buffer, and waits.
fn read_texels<T: bytemuck::Pod>(lab: &LabDevice, texture: &wgpu::Texture, layer: u32) -> Result<Vec<T>, DeviceError> {
    let (width, height) = (texture.width(), texture.height());
    let row_bytes = width as usize * size_of::<T>();
    let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
    let buffer = readback_buffer(lab, (padded_row_bytes * height as usize) as u64);
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
    let mapped = mapped(lab, &buffer)?;
    let mut texels = vec![T::zeroed(); width as usize * height as usize];
    for (row, padded) in texels.chunks_exact_mut(width as usize).zip(mapped.chunks_exact(padded_row_bytes)) {
        bytemuck::cast_slice_mut(row).copy_from_slice(&padded[..row_bytes]);
    }
    Ok(texels)
}
