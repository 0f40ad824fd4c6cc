//! Devices that pipelines are made on, within WebGPU's default limits.

use antumbra::Gpu;

use crate::makings::{self, Extent};

/// Every optional feature that the library's pipelines depend on.
pub const FEATURES: wgpu::Features = wgpu::Features::DEPTH_CLIP_CONTROL.union(wgpu::Features::TIMESTAMP_QUERY);

/// Features and extents by which every program is made: hosts have light maps that clip depths, or do not.
const VARIANTS: [(wgpu::Features, Extent); 2] =
    [(FEATURES, Extent::Parameters), (wgpu::Features::empty(), Extent::Qualities)];

/// Makes every program of every variant on wgpu's own device.
///
/// # Errors
/// The first thing that is refused that should not be.
pub fn make_all_variants() -> Result<(), String> {
    VARIANTS.into_iter().try_for_each(|(features, extent)| makings::make_all(&no_op(features)?, extent))
}

/// wgpu's own device that does nothing, with these features: all is validated and nothing compiled.
///
/// # Errors
/// What wgpu says.
pub fn no_op(features: wgpu::Features) -> Result<Gpu, String> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::NOOP;
    descriptor.backend_options.noop.enable = true;
    device(descriptor, features).map(|(gpu, _)| gpu)
}

/// The first device of Vulkan, and its adapter.
///
/// # Errors
/// What wgpu says.
pub fn vulkan(features: wgpu::Features) -> Result<(Gpu, wgpu::AdapterInfo), String> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    // No validation layer and no names of objects: this driver makes pipelines alone.
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
