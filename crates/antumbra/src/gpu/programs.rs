//! Shader modules, layouts and pipelines, reported as they are created: `cargo xtask web --shaders` has each of them created
//! by a browser too.
//!
//! The library's own renderer and viewer make theirs by these functions. No host has a use for them.

use std::sync::OnceLock;

/// What was made, and of what.
#[derive(Debug)]
pub enum Made<'a> {
    /// A bind group's layout, and its entries.
    BindGroupLayout(&'a wgpu::BindGroupLayout, &'a [wgpu::BindGroupLayoutEntry]),
    /// A pipeline's layout, and the layouts of its groups.
    PipelineLayout(&'a wgpu::PipelineLayout, &'a [Option<&'a wgpu::BindGroupLayout>]),
    /// A module, its label, and its WGSL.
    Module(&'a wgpu::ShaderModule, &'a str, &'a str),
    /// A pipeline.
    Compute(&'a wgpu::ComputePipelineDescriptor<'a>),
    /// A pipeline.
    Render(&'a wgpu::RenderPipelineDescriptor<'a>),
}

type Listener = Box<dyn Fn(Made<'_>) + Send + Sync>;

static LISTENER: OnceLock<Listener> = OnceLock::new();

/// Tells `listener` of everything that this process makes from now on, on whatever device.
///
/// # Panics
/// Where there is a listener already.
pub fn listen(listener: impl Fn(Made<'_>) + Send + Sync + 'static) {
    assert!(LISTENER.set(Box::new(listener)).is_ok(), "one listener is enough");
}

fn tell(made: Made<'_>) {
    if let Some(listener) = LISTENER.get() {
        listener(made);
    }
}

/// A bind group's layout.
pub fn create_bind_group_layout(
    device: &wgpu::Device,
    descriptor: &wgpu::BindGroupLayoutDescriptor<'_>,
) -> wgpu::BindGroupLayout {
    let layout = device.create_bind_group_layout(descriptor);
    tell(Made::BindGroupLayout(&layout, descriptor.entries));
    layout
}

/// A pipeline's layout.
pub fn create_pipeline_layout(
    device: &wgpu::Device,
    descriptor: &wgpu::PipelineLayoutDescriptor<'_>,
) -> wgpu::PipelineLayout {
    let layout = device.create_pipeline_layout(descriptor);
    tell(Made::PipelineLayout(&layout, descriptor.bind_group_layouts));
    layout
}

/// A module of a text in WGSL.
pub fn create_shader_module(device: &wgpu::Device, label: &str, wgsl: std::borrow::Cow<'_, str>) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(wgsl.clone());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source });
    tell(Made::Module(&module, label, &wgsl));
    module
}

/// A pipeline.
pub fn create_compute_pipeline(
    device: &wgpu::Device,
    descriptor: &wgpu::ComputePipelineDescriptor<'_>,
) -> wgpu::ComputePipeline {
    tell(Made::Compute(descriptor));
    device.create_compute_pipeline(descriptor)
}

/// A pipeline.
pub fn create_render_pipeline(
    device: &wgpu::Device,
    descriptor: &wgpu::RenderPipelineDescriptor<'_>,
) -> wgpu::RenderPipeline {
    tell(Made::Render(descriptor));
    device.create_render_pipeline(descriptor)
}
