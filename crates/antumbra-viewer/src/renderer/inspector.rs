//! Asynchronous readback of one pixel: requested in one frame, available some frames later.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use antumbra::{Gpu, Mask, MaskChannels};
use antumbra_render::receivers::ReceiverImages;
use glam::{UVec2, Vec3, Vec4};

use super::texture_reader::f32_from_positive_half;

/// Values of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspected {
    /// Pixel coordinates from the image's top left.
    pub pixel: UVec2,
    /// Surface at the pixel's centre; `None` for the background.
    pub surface: Option<InspectedSurface>,
    /// Visibility of the selected light on the left and right side, averaged over channels.
    pub visibilities: [Option<f32>; 2],
}

/// A surface at a pixel's centre.
#[derive(Clone, Debug, PartialEq)]
pub struct InspectedSurface {
    /// Position relative to the scene's anchor, metres; `None` until depths have been read back.
    pub position: Option<Vec3>,
    /// Geometric unit normal in world space, on the camera's side.
    pub normal: Vec3,
    /// Linear red, green and blue, and opacity, at 8-bit precision.
    pub base_color: Vec4,
    /// Range 0 to 1.
    pub metallic: f32,
    /// Range 0 to 1.
    pub roughness: f32,
}

/// Key of a reading: pixel, version of the masks with the light's index, and version of the camera.
pub type ReadingKey = (UVec2, u64, u64);

/// Reader of one pixel at a time.
#[derive(Debug, Default)]
pub struct PixelReader {
    pending: Option<Pending>,
}

#[derive(Debug)]
struct Pending {
    key: ReadingKey,
    buffer: wgpu::Buffer,
    /// Channels of the masks.
    channels: [Option<MaskChannels>; 2],
    outcome: Arc<AtomicU8>,
}

const WAITING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// Bytes between the texels of successive textures: enough for any format.
const SLOT_BYTES: u64 = 256;

impl PixelReader {
    /// Whether a reading is in flight.
    pub fn is_waiting(&self) -> bool {
        self.pending.as_ref().is_some_and(|pending| pending.outcome.load(Ordering::Acquire) == WAITING)
    }

    /// Key of the reading that is in flight or not yet taken.
    pub fn key(&self) -> Option<ReadingKey> {
        self.pending.as_ref().map(|pending| pending.key)
    }

    /// Records the copies of a pixel's texels.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        key: ReadingKey,
        images: &ReceiverImages,
        masks: [Option<&Mask>; 2],
    ) {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("viewer: pixel"),
            size: 4 * SLOT_BYTES,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let (pixel, ..) = key;
        let textures = [Some(&images.geometric_normal), Some(&images.surface)];
        let textures = textures.into_iter().chain(masks.map(|mask| mask.map(Mask::texture)));
        for (slot, texture) in (0..).zip(textures) {
            let Some(texture) = texture else { continue };
            encoder.copy_texture_to_buffer(
                wgpu::TexelCopyTextureInfo {
                    origin: wgpu::Origin3d { x: pixel.x, y: pixel.y, z: 0 },
                    ..texture.as_image_copy()
                },
                wgpu::TexelCopyBufferInfo {
                    buffer: &buffer,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: slot * SLOT_BYTES,
                        bytes_per_row: None,
                        rows_per_image: None,
                    },
                },
                wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            );
        }
        let outcome = Arc::new(AtomicU8::new(WAITING));
        let told = outcome.clone();
        encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
            told.store(if result.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
        });
        self.pending = Some(Pending { key, buffer, channels: masks.map(|mask| mask.map(Mask::channels)), outcome });
    }

    /// Returns the completed reading, without the surface's position.
    pub fn take(&mut self) -> Option<(ReadingKey, Inspected)> {
        let outcome = self.pending.as_ref()?.outcome.load(Ordering::Acquire);
        if outcome == WAITING {
            return None;
        }
        let Pending { key, buffer, channels, .. } = self.pending.take()?;
        if outcome == FAILED {
            return None;
        }
        let mapped = buffer.get_mapped_range(..).ok()?;
        let slot = |i: usize| &mapped[i * SLOT_BYTES as usize..][..16];
        let words =
            |i: usize| -> [u32; 4] { std::array::from_fn(|k| bytemuck::pod_read_unaligned(&slot(i)[4 * k..][..4])) };
        let normal = words(0).map(f32::from_bits);
        let visibility = |side: usize| Some(mean_visibility(slot(2 + side), channels[side]?));
        let inspected = Inspected {
            pixel: key.0,
            surface: (normal[3] > 0.0).then(|| surface(Vec4::from(normal).truncate(), words(1))),
            visibilities: [visibility(0), visibility(1)],
        };
        Some((key, inspected))
    }
}

/// Unpacks a surface; the inverse of `pack_surface` in the receivers' shader.
fn surface(normal: Vec3, packed: [u32; 4]) -> InspectedSurface {
    let unorm4 = |word: u32| Vec4::from(word.to_le_bytes().map(|byte| f32::from(byte) / 255.0));
    let (roots, shine) = (unorm4(packed[0]), unorm4(packed[3]));
    let base_color = (roots.truncate() * roots.truncate()).extend(roots.w);
    InspectedSurface { position: None, normal, base_color, metallic: shine.x, roughness: shine.y }
}

fn mean_visibility(texel: &[u8], channels: MaskChannels) -> f32 {
    match channels {
        MaskChannels::One => bytemuck::pod_read_unaligned(&texel[..4]),
        MaskChannels::Three => {
            let half = |i: usize| f32_from_positive_half(bytemuck::pod_read_unaligned(&texel[2 * i..][..2]));
            (half(0) + half(1) + half(2)) / 3.0
        }
    }
}
