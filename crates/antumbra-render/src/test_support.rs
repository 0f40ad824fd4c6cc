//! Helpers of GPU tests: a device whose errors fail the test, and a small mesh.

use std::sync::OnceLock;

use antumbra::Gpu;
use antumbra_scene::Mesh;
use glam::{Vec2, Vec3};

/// Returns the device; `None`, with a message, if this machine has no adapter and none is required. wgpu panics on
/// unhandled errors.
pub(crate) fn gpu_or_skip() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let options = wgpu::RequestAdapterOptions::default();
        let adapter = pollster::block_on(instance.request_adapter(&options)).ok()?;
        let made = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()));
        let (device, queue) = made.unwrap_or_else(|error| panic!("the adapter cannot create a device: {error}"));
        Some(Gpu::new(&device, &queue))
    });
    if gpu.is_none() {
        antumbra_testing::skip_without_adapter();
    }
    gpu.as_ref()
}

/// A square in the xz plane about the origin, facing up, with texture coordinates over it.
pub(crate) fn quad(half_side_m: f32) -> Mesh {
    let corners = [Vec2::new(-1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, -1.0)];
    Mesh {
        name: "quad".into(),
        positions: corners.map(|c| Vec3::new(c.x, 0.0, c.y) * half_side_m).to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: corners.map(|c| 0.5 * c + 0.5).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}
