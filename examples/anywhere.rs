//! Visibility at the host's own points, without a camera: a slice through the air under a table.
//!
//! Everything down to `main` creates a scene; the lines that compute visibility are marked with `// shadows`. The points are a
//! grid in an upright plane, one for each pixel of an image, `anywhere.png`: the light's visibility for fog, a probe or a
//! particle there. The only crate of this project is `antumbra`.
//!
//! ```text
//! cargo run --example anywhere
//! ```

use antumbra::light::{Aabb, Light, LightShape};
use antumbra::{
    Casters, Gpu, MaskChannels, MeshCaster, PointBuffer, PointFrame, PointReceivers, Recorder, TechniqueKind,
};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// Size of the grid and of the image.
const SIZE: UVec2 = UVec2::new(480, 240);

/// Adds a box: twelve triangles, counter-clockwise from outside.
fn add_box(min: Vec3, max: Vec3, positions: &mut Vec<Vec3>, indices: &mut Vec<u32>) {
    let base = positions.len() as u32;
    positions.extend(Aabb { min, max }.corners());
    for quad in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| base + quad[corner]));
    }
}

/// Returns positions and indices of a table of five boxes.
fn table() -> (Vec<Vec3>, Vec<u32>) {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    let mut add = |min, max| add_box(Vec3::from(min), Vec3::from(max), &mut positions, &mut indices);
    add([-1.0, 0.9, -0.7], [1.0, 1.0, 0.7]);
    for (x, z) in [(-0.95, -0.65), (0.85, -0.65), (-0.95, 0.55), (0.85, 0.55)] {
        add([x, 0.0, z], [x + 0.1, 0.9, z + 0.1]);
    }
    (positions, indices)
}

/// Returns a point for each pixel of the image, row by row from the top, in an upright plane.
fn grid(least: Vec3, most: Vec3) -> Vec<Vec3> {
    let point = |i: u32| {
        let share = (UVec2::new(i % SIZE.x, i / SIZE.x).as_vec2() + 0.5) / SIZE.as_vec2();
        least + (most - least) * Vec2::new(share.x, 1.0 - share.y).extend(0.0)
    };
    (0..SIZE.element_product()).map(point).collect()
}

/// Submits the commands, reads the visibilities back, and writes them as an image.
fn save(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    visibilities: &wgpu::Buffer,
) -> Result<(), Box<dyn std::error::Error>> {
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: visibilities.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    encoder.copy_buffer_to_buffer(visibilities, 0, &readback, 0, visibilities.size());
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapping for reading"));
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let seen: Vec<f32> = bytemuck::pod_collect_to_vec(&readback.get_mapped_range(..)?);
    let gray: Vec<u8> = seen.iter().map(|v| (255.0 * v.powf(1.0 / 2.2)).round() as u8).collect();
    image::save_buffer("anywhere.png", &gray, SIZE.x, SIZE.y, image::ColorType::L8)?;
    println!("wrote anywhere.png");
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The host's device, with the optional features of the library that the adapter supports.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: adapter.features() & Gpu::WANTED_FEATURES, // shadows
        ..wgpu::DeviceDescriptor::default()
    }))?;

    // The host's scene and its points.
    let (positions, indices) = table();
    let (least, most) = (Vec3::new(-2.0, 0.0, 0.1), Vec3::new(2.0, 2.0, 0.1));
    let points = grid(least, most);
    let buffer = |label, size: usize, usage| {
        let size = size as u64;
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    };
    let filled = |label, bytes: &[u8], usage| {
        let buffer = buffer(label, bytes.len(), usage | wgpu::BufferUsages::COPY_DST);
        queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let readable = wgpu::BufferUsages::STORAGE; // shadows: `ray_traced` reads triangles
    let position_buffer = filled("positions", bytemuck::cast_slice(&positions), wgpu::BufferUsages::VERTEX | readable);
    let index_buffer = filled("indices", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX | readable);
    let instance_buffer =
        filled("instances", bytemuck::bytes_of(&Mat4::IDENTITY), wgpu::BufferUsages::VERTEX | readable);
    let point_buffer = filled("points", bytemuck::cast_slice(&points), readable);

    // Light, casters, points, and a buffer with an `f32` for each point.
    let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) }; // shadows
    let light = Light::new(shape, Vec3::new(0.5, 4.5, 0.5), Vec3::ZERO); // shadows
    let mesh = MeshCaster::new(&position_buffer, &index_buffer, indices.len() as u32, &instance_buffer)
        .with_bounds(Aabb::of(positions.iter().copied()))
        .with_closed(true); // shadows
    let casters = [mesh]; // shadows
    let visibilities =
        buffer("visibilities", 4 * points.len(), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC); // shadows
    let bounds = Aabb { min: least, max: most }; // shadows
    let receivers = PointReceivers {
        row_length: Some(SIZE.x), // points in rows; `None` for those in no order
        ..PointReceivers::new(points.len() as u32, PointBuffer::packed(&point_buffer), bounds)
    }; // shadows
    let frame = PointFrame {
        light: &light,
        casters: Casters::Meshes(&casters),
        receivers,
        visibilities: &visibilities,
        channels: MaskChannels::One,
    }; // shadows
    let gpu = Gpu::new(&device, &queue); // shadows
    let mut shadow = TechniqueKind::RayTraced.create(&gpu)?; // shadows
    let work = shadow.prepare_points(&frame)?; // shadows
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    work.record(&mut Recorder::new(&mut encoder, None)); // shadows

    save(&device, &queue, encoder, &visibilities)
}
