//! Devices that pipelines are created on, within WebGPU's default limits.

use antumbra::Gpu;

use crate::makings::{self, Extent};

/// All optional features that the library's pipelines depend on.
pub const FEATURES: wgpu::Features = wgpu::Features::DEPTH_CLIP_CONTROL.union(wgpu::Features::TIMESTAMP_QUERY);

/// Features and extents that together cover all programs: devices whose light maps can disable depth clipping, and others.
const VARIANTS: [(wgpu::Features, Extent); 2] =
    [(FEATURES, Extent::Parameters), (wgpu::Features::empty(), Extent::Qualities)];

/// Creates every program of every variant on wgpu's no-op device.
///
/// # Errors
/// The first unexpected rejection.
pub fn make_all_variants() -> Result<(), String> {
    VARIANTS.into_iter().try_for_each(|(features, extent)| makings::make_all(&no_op(features)?, extent))
}

/// Creates wgpu's no-op device with these features. It validates everything and compiles nothing.
///
/// # Errors
/// The error of wgpu.
pub fn no_op(features: wgpu::Features) -> Result<Gpu, String> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::NOOP;
    descriptor.backend_options.noop.enable = true;
    device(descriptor, features).map(|(gpu, _)| gpu)
}

/// Creates a device on the first Vulkan adapter.
///
/// # Errors
/// The error of wgpu.
pub fn vulkan(features: wgpu::Features) -> Result<(Gpu, wgpu::AdapterInfo), String> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    // No validation layer and no object names, because this driver only creates pipelines.
    descriptor.flags = wgpu::InstanceFlags::empty();
    device(descriptor, features)
}

fn device(
    descriptor: wgpu::InstanceDescriptor,
    required_features: wgpu::Features,
) -> Result<(Gpu, wgpu::AdapterInfo), String> {
    let instance = wgpu::Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.map_err(|error| error.to_string())?;
    let descriptor = wgpu::DeviceDescriptor { required_features, ..wgpu::DeviceDescriptor::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| error.to_string())?;
    Ok((Gpu::new(&device, &queue), adapter.get_info()))
}
