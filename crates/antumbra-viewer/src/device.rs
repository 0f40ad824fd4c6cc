//! The viewer's device: WebGPU's default limits, with larger textures and buffers if the adapter supports them.

use antumbra::Gpu;

/// Descriptor of the device that the viewer requests from an adapter.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let limits = adapter.limits();
    wgpu::DeviceDescriptor {
        label: Some("antumbra viewer"),
        required_features: Gpu::WANTED_FEATURES & adapter.features(),
        required_limits: wgpu::Limits {
            max_texture_dimension_2d: limits.max_texture_dimension_2d,
            max_buffer_size: limits.max_buffer_size,
            ..Gpu::wanted_limits(adapter)
        },
        ..wgpu::DeviceDescriptor::default()
    }
}
