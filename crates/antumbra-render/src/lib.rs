//! Antumbra's own small renderer around the library, shared by the laboratory and the viewer.
//!
//! The modules, in the order of the data flow:
//!
//! - [`gpu_scene`] — geometry, textures and instances of a scene, as casters for the techniques.
//! - [`receivers`] — first hits of a camera: depth, exact normals, surfaces.
//! - [`shading`] — the shaded image, from receivers, lights and visibility.
//! - [`antialiasing`] — which mask value a position within a pixel takes.
//! - [`picture`] — images and visibility images on the CPU; plain data.
//!
//! The caller provides the device, as [`antumbra::Gpu`]. Passes are recorded into the caller's encoder. Nothing here submits
//! or waits, so a window and a browser can use it. Data that must be read back first (where the camera sees anything) is an
//! argument.
#![forbid(unsafe_code)]

pub mod antialiasing;
pub mod gpu_scene;
pub mod picture;
pub mod receivers;
pub mod shading;
#[cfg(test)]
mod test_support;

use antumbra::programs;

/// Creates a texture that passes draw to, later passes read, and a caller may read back: one level, one sample.
pub fn drawn_texture(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    size_px: glam::UVec2,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// Creates a full-screen pipeline from a module's vertex stage `vertex_screen` and the fragment stage `fragment`.
pub fn screen_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    fragment: &str,
    groups: &[Option<&wgpu::BindGroupLayout>],
    target: wgpu::ColorTargetState,
) -> wgpu::RenderPipeline {
    let layout = programs::create_pipeline_layout(
        device,
        &wgpu::PipelineLayoutDescriptor { label: Some(fragment), bind_group_layouts: groups, immediate_size: 0 },
    );
    programs::create_render_pipeline(
        device,
        &wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vertex_screen"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        },
    )
}

/// Bind group layout entry of a buffer.
pub fn buffer_entry(
    binding: u32,
    visibility: wgpu::ShaderStages,
    ty: wgpu::BufferBindingType,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// Bind group layout entry of a single-sampled 2D texture that a fragment stage reads.
pub fn texture_entry(binding: u32, sample_type: wgpu::TextureSampleType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}
