//! Per-pixel state that is kept from batch to batch, in bands of rows that fit a binding: at 3840 × 2160 one buffer for all pixels
//! would be larger than WebGPU's binding limit.

use glam::UVec2;

use crate::contract::Error;
use crate::gpu::{Stage, gpu_structs, sized_buffer};

gpu_structs! {
    /// Rows of the image in one buffer.
    pub(crate) struct PixelBand {
        first_row: u32,
        padding_0: u32,
        padding_1: u32,
        padding_2: u32,
    }
}

/// Multiple of rows at which bands begin: the height of a workgroup.
const ROWS: u32 = 8;

/// Band that is prepared for a frame.
#[derive(Clone, Debug)]
pub(super) struct Band {
    /// Number of rows.
    pub(super) rows: u32,
    /// Uniform of a [`PixelBand`].
    pub(super) uniform: wgpu::Buffer,
    pub(super) pixels: wgpu::Buffer,
}

/// Bands of an image.
#[derive(Debug, Default)]
pub(super) struct Bands {
    buffers: Vec<Option<wgpu::Buffer>>,
}

impl Bands {
    /// Prepares as few bands as hold `bytes_each` bytes for every pixel.
    pub(super) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        technique: &'static str,
        size_px: UVec2,
        bytes_each: u64,
    ) -> Result<Vec<Band>, Error> {
        let max_bytes = stage.device.limits().max_storage_buffer_binding_size;
        let row_bytes = bytes_each * u64::from(size_px.x.max(1));
        let fitting = (max_bytes / row_bytes).min(u64::from(size_px.y.next_multiple_of(ROWS))) as u32;
        let rows_each = fitting / ROWS * ROWS;
        if rows_each == 0 {
            return Err(Error::Unsupported {
                technique,
                needed: format!("a buffer of {} bytes, {bytes_each} for each pixel of {ROWS} rows", row_bytes * 8),
                had: format!("at most {max_bytes} bytes per binding"),
                remedy: "set `compare` to gather",
            });
        }
        let count = size_px.y.div_ceil(rows_each).max(1);
        self.buffers.resize(count as usize, None);
        let band = |(i, buffer): (u32, &mut Option<wgpu::Buffer>)| {
            let first_row = i * rows_each;
            let rows = rows_each.min(size_px.y - first_row);
            let uniform = PixelBand { first_row, ..PixelBand::default() };
            let usage = wgpu::BufferUsages::STORAGE;
            Band {
                rows,
                uniform: stage.uniform("antumbra pixel band", &uniform),
                pixels: sized_buffer(stage, buffer, "antumbra pixels' sums", row_bytes * u64::from(rows), usage)
                    .clone(),
            }
        };
        Ok((0..).zip(&mut self.buffers).map(band).collect())
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        self.buffers.iter().flatten().map(wgpu::Buffer::size).sum()
    }
}
