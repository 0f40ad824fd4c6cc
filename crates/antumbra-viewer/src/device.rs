//! The device that the viewer draws with: WebGPU's default limits, larger pictures and scenes where they can be.

use antumbra::Gpu;

/// What the viewer asks of an adapter.
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
