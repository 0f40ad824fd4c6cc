//! Creation of shader modules, layouts and pipelines, reported to a listener: `cargo xtask web --shaders` recreates each of
//! them in a browser.
//!
//! The library's own renderer and viewer use these functions, too. Hosts do not need them.

use std::sync::OnceLock;

/// Created object, with its description.
#[derive(Debug)]
pub enum CreatedObject<'a> {
    /// Bind group layout and its entries.
    BindGroupLayout(&'a wgpu::BindGroupLayout, &'a [wgpu::BindGroupLayoutEntry]),
    /// Pipeline layout and its bind group layouts.
    PipelineLayout(&'a wgpu::PipelineLayout, &'a [Option<&'a wgpu::BindGroupLayout>]),
    /// Shader module, its label and its WGSL.
    Module(&'a wgpu::ShaderModule, &'a str, &'a str),
    /// Compute pipeline.
    Compute(&'a wgpu::ComputePipelineDescriptor<'a>),
    /// Render pipeline.
    Render(&'a wgpu::RenderPipelineDescriptor<'a>),
}

type Listener = Box<dyn Fn(CreatedObject<'_>) + Send + Sync>;

static LISTENER: OnceLock<Listener> = OnceLock::new();

/// Reports to `listener` everything that this process creates from now on, on any device.
///
/// # Panics
/// If a listener is already set.
pub fn listen(listener: impl Fn(CreatedObject<'_>) + Send + Sync + 'static) {
    assert!(LISTENER.set(Box::new(listener)).is_ok(), "one listener is enough");
}

/// Tells the listener, if there is one.
pub(super) fn tell(made: CreatedObject<'_>) {
    if let Some(listener) = LISTENER.get() {
        listener(made);
    }
}

/// Creates a bind group layout and reports it.
pub fn create_bind_group_layout(
    device: &wgpu::Device,
    descriptor: &wgpu::BindGroupLayoutDescriptor<'_>,
) -> wgpu::BindGroupLayout {
    let layout = device.create_bind_group_layout(descriptor);
    tell(CreatedObject::BindGroupLayout(&layout, descriptor.entries));
    layout
}

/// Creates a pipeline layout and reports it.
pub fn create_pipeline_layout(
    device: &wgpu::Device,
    descriptor: &wgpu::PipelineLayoutDescriptor<'_>,
) -> wgpu::PipelineLayout {
    let layout = device.create_pipeline_layout(descriptor);
    tell(CreatedObject::PipelineLayout(&layout, descriptor.bind_group_layouts));
    layout
}

/// Creates a shader module from WGSL and reports it.
pub fn create_shader_module(device: &wgpu::Device, label: &str, wgsl: std::borrow::Cow<'_, str>) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(wgsl.clone());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source });
    tell(CreatedObject::Module(&module, label, &wgsl));
    module
}

/// Reports a compute pipeline and creates it.
pub fn create_compute_pipeline(
    device: &wgpu::Device,
    descriptor: &wgpu::ComputePipelineDescriptor<'_>,
) -> wgpu::ComputePipeline {
    tell(CreatedObject::Compute(descriptor));
    device.create_compute_pipeline(descriptor)
}

/// Reports a render pipeline and creates it.
pub fn create_render_pipeline(
    device: &wgpu::Device,
    descriptor: &wgpu::RenderPipelineDescriptor<'_>,
) -> wgpu::RenderPipeline {
    tell(CreatedObject::Render(descriptor));
    device.create_render_pipeline(descriptor)
}
