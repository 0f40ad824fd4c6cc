//! An independent renderer with eight lights: all cast soft shadows of casters that move and deform.
//!
//! All but `shadows.rs` is an ordinary small engine: interleaved and packed vertices, 16-bit indices, skinning in compute,
//! alpha-tested leaves, two cameras in one window, depth from 0 near to 1 far. `shadows.rs` contains everything for shadows: one
//! caster set shared by the lights, a state for each light and view, three techniques, and masks in the layers of the host's own
//! arrays. The only crate of this project is `antumbra`. It draws some frames, one submission each, and writes the last one as
//! `many_lights.png`:
//!
//! ```text
//! cargo run --example many_lights
//! ```

mod buffers;
mod meshes;
mod pipelines;
mod renderer;
mod scene;
mod shadows;

use antumbra::Gpu;
use glam::UVec2;
use renderer::Renderer;

const VIEW_SIZE: UVec2 = UVec2::new(400, 300);
const FRAMES: u32 = 6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: adapter.features() & Gpu::WANTED_FEATURES, // shadows
        ..wgpu::DeviceDescriptor::default()
    }))?;
    let mut renderer = Renderer::new(&device, &queue, VIEW_SIZE)?;
    for (i, light) in renderer.scene.lights.iter().enumerate() {
        println!("{}: {}", light.name, renderer.shadows.of_light(0, i).kind());
    }
    for frame in 0..FRAMES {
        renderer.draw(frame as f32 / 5.0)?;
        device.poll(wgpu::PollType::wait_indefinitely())?;
        println!("frame {frame}: {} objects made so far", renderer.shadows.gpu().objects_created().total());
    }
    let pixels = read_rgba8(&device, &queue, renderer.targets.color.texture())?;
    image::save_buffer("many_lights.png", &pixels, 2 * VIEW_SIZE.x, VIEW_SIZE.y, image::ColorType::Rgba8)?;
    println!("wrote many_lights.png");
    Ok(())
}

/// Returns a texture's bytes, row by row.
fn read_rgba8(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let row_bytes = (4 * texture.width()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(row_bytes * texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let target = wgpu::TexelCopyBufferInfo { buffer: &readback, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapping for reading"));
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = readback.get_mapped_range(..)?;
    let row = |row: &[u8]| row[..4 * texture.width() as usize].to_vec();
    Ok(bytes.chunks_exact(row_bytes as usize).flat_map(row).collect())
}
