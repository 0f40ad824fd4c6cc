//! Asynchronous readback of textures and of a few words of buffers: requested in one frame, available some frames later.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use antumbra::Gpu;
use glam::UVec2;

/// Reader of one texture or buffer at a time.
#[derive(Debug, Default)]
pub struct TextureReader {
    pending: Option<Pending>,
}

#[derive(Debug)]
struct Pending {
    buffer: wgpu::Buffer,
    size_px: UVec2,
    texel_bytes: u32,
    /// Version of the content, chosen by the caller.
    version: u64,
    outcome: Arc<AtomicU8>,
}

/// States of a mapping.
const WAITING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// Texels that were read back.
#[derive(Debug)]
pub struct Texels {
    /// Version of the content, chosen by the caller.
    pub version: u64,
    /// Width and height.
    pub size_px: UVec2,
    /// Rows tightly packed, the top row first.
    pub bytes: Vec<u8>,
}

impl TextureReader {
    /// Whether a readback is in flight.
    pub fn is_waiting(&self) -> bool {
        self.pending.as_ref().is_some_and(|pending| pending.outcome.load(Ordering::Acquire) == WAITING)
    }

    /// Whether a readback is in flight or not yet taken.
    pub fn is_pending(&self) -> bool {
        self.pending.is_some()
    }

    /// Records the copy of the first level and layer of `texture`, which has usage `COPY_SRC`. It is available once the
    /// encoder's commands have run. An earlier pending readback is dropped.
    pub fn record(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture, version: u64) {
        let size_px = UVec2::new(texture.width(), texture.height());
        let texel_bytes = match texture.format() {
            wgpu::TextureFormat::Depth32Float => 4,
            format => format.block_copy_size(None).unwrap_or(4),
        };
        self.expect(gpu, encoder, size_px, texel_bytes, version, |encoder, buffer, row_bytes| {
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer, layout },
                wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 1 },
            );
        });
    }

    /// Records the copy of a buffer's first `count` words, as a row of 32-bit texels. The buffer has usage `COPY_SRC`.
    pub fn record_words(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        words: &wgpu::Buffer,
        count: u32,
        version: u64,
    ) {
        self.expect(gpu, encoder, UVec2::new(count, 1), 4, version, |encoder, buffer, _| {
            encoder.copy_buffer_to_buffer(words, 0, buffer, 0, u64::from(count) * 4);
        });
    }

    /// Records a copy into a mappable buffer of padded rows, and requests its mapping.
    fn expect(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        size_px: UVec2,
        texel_bytes: u32,
        version: u64,
        copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer, u32),
    ) {
        let row_bytes = padded_row_bytes(size_px.x, texel_bytes);
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("viewer: read back"),
            size: u64::from(row_bytes) * u64::from(size_px.y),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        copy(encoder, &buffer, row_bytes);
        let outcome = Arc::new(AtomicU8::new(WAITING));
        let told = outcome.clone();
        encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
            told.store(if result.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
        });
        self.pending = Some(Pending { buffer, size_px, texel_bytes, version, outcome });
    }

    /// Returns the texels once they are read back.
    pub fn take(&mut self) -> Option<Texels> {
        let outcome = self.pending.as_ref()?.outcome.load(Ordering::Acquire);
        if outcome == WAITING {
            return None;
        }
        let pending = self.pending.take()?;
        if outcome == FAILED {
            return None;
        }
        let mapped = pending.buffer.get_mapped_range(..).ok()?;
        let row = (pending.size_px.x * pending.texel_bytes) as usize;
        let padded = padded_row_bytes(pending.size_px.x, pending.texel_bytes) as usize;
        let bytes = mapped.chunks_exact(padded).flat_map(|padded| &padded[..row]).copied().collect();
        Some(Texels { version: pending.version, size_px: pending.size_px, bytes })
    }
}

fn padded_row_bytes(width: u32, texel_bytes: u32) -> u32 {
    (width * texel_bytes).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

impl Texels {
    /// Texels as 32-bit integers.
    pub fn u32s(&self) -> Vec<u32> {
        self.bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }

    /// Texels as 32-bit floats.
    pub fn f32s(&self) -> Vec<f32> {
        self.bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }

    /// Mean of the first three components of texels of four non-negative 16-bit floats.
    pub fn mean_of_half_rgb(&self) -> Vec<f32> {
        let half = |b: &[u8]| f32_from_positive_half(u16::from_le_bytes([b[0], b[1]]));
        self.bytes.chunks_exact(8).map(|b| (half(&b[0..2]) + half(&b[2..4]) + half(&b[4..6])) / 3.0).collect()
    }
}

/// Converts IEEE 754 binary16; the sign is ignored, infinities become large numbers.
pub(super) fn f32_from_positive_half(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023) / 1024.0);
    if exponent == 0 { fraction * 2f32.powi(-14) } else { (1.0 + fraction) * 2f32.powi(exponent - 15) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_what_the_standard_says() {
        for (bits, value) in
            [(0x0000, 0.0), (0x3c00, 1.0), (0x3800, 0.5), (0x3555, 0.333_251_95), (0x0001, 5.960_464_5e-8)]
        {
            assert_eq!(f32_from_positive_half(bits), value);
        }
    }
}
