//! Antumbra's own small renderer, around the library: what the laboratory and the viewer share.
//!
//! The rooms, in the order in which data flows through them:
//!
//! - [`gpu_scene`] — a scene's geometry, textures and instances, as casters for the techniques.
//! - [`receivers`] — what a camera sees: depth, exact normals, surfaces.
//! - [`shading`] — the picture, from receivers, lights and visibility.
//! - [`antialiasing`] — which sample of a mask a place within a pixel takes.
//! - [`picture`] — what a picture and a visibility image are on the CPU; plain data.
//!
//! The device is the caller's, as [`antumbra::Gpu`]. Passes are recorded into the caller's encoder; nothing here submits,
//! and nothing waits, so that a window and a browser can use it. What has to be read back to go on (where the camera sees
//! anything) is an argument.
#![forbid(unsafe_code)]

pub mod antialiasing;
pub mod gpu_scene;
pub mod picture;
pub mod receivers;
pub mod shading;
#[cfg(test)]
mod test_support;

use antumbra::programs;

/// A texture that passes draw to, that later ones read, and that a caller may read back: one level, one sample.
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

/// Draws a triangle over the whole picture, by a module's vertex stage `vertex_screen` and the fragment stage of a name.
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

/// Entry of a buffer in a bind group's layout.
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

/// Entry of a 2D texture of one sample that a fragment stage reads.
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
