//! Cache keys of layouts and pipelines: everything that they are created from.

use std::num::NonZeroU32;

/// Entries of a layout, first as declared, then as the device receives them.
pub(super) type LayoutKey = [Vec<wgpu::BindGroupLayoutEntry>; 2];

/// Entry point, with values for its overridable constants.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct EntryKey {
    module: wgpu::ShaderModule,
    entry_point: Option<String>,
    constants: Vec<(String, u64)>,
    zeroed: bool,
}

impl EntryKey {
    pub(super) fn new(
        module: &wgpu::ShaderModule,
        entry_point: Option<&str>,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> Self {
        Self {
            module: module.clone(),
            entry_point: entry_point.map(Into::into),
            constants: options.constants.iter().map(|(name, value)| ((*name).into(), value.to_bits())).collect(),
            zeroed: options.zero_initialize_workgroup_memory,
        }
    }
}

#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct ComputeKey {
    pub(super) layout: Option<wgpu::PipelineLayout>,
    pub(super) entry: EntryKey,
}

#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct RenderKey {
    layout: Option<wgpu::PipelineLayout>,
    vertex: EntryKey,
    vertex_buffers: Vec<Option<VertexBufferKey>>,
    primitive: wgpu::PrimitiveState,
    depth_stencil: Option<wgpu::DepthStencilState>,
    multisample: wgpu::MultisampleState,
    fragment: Option<(EntryKey, Vec<Option<wgpu::ColorTargetState>>)>,
    multiview_mask: Option<NonZeroU32>,
}

#[derive(Debug, PartialEq, Eq, Hash)]
struct VertexBufferKey {
    stride: u64,
    step_mode: wgpu::VertexStepMode,
    attributes: Vec<wgpu::VertexAttribute>,
}

impl RenderKey {
    pub(super) fn new(descriptor: &wgpu::RenderPipelineDescriptor<'_>) -> Self {
        let wgpu::RenderPipelineDescriptor { vertex, fragment, .. } = descriptor;
        let vertex_buffer = |buffer: &Option<wgpu::VertexBufferLayout<'_>>| {
            buffer.as_ref().map(|buffer| VertexBufferKey {
                stride: buffer.array_stride,
                step_mode: buffer.step_mode,
                attributes: buffer.attributes.to_vec(),
            })
        };
        Self {
            layout: descriptor.layout.cloned(),
            vertex: EntryKey::new(vertex.module, vertex.entry_point, &vertex.compilation_options),
            vertex_buffers: vertex.buffers.iter().map(vertex_buffer).collect(),
            primitive: descriptor.primitive,
            depth_stencil: descriptor.depth_stencil.clone(),
            multisample: descriptor.multisample,
            fragment: fragment.as_ref().map(|fragment| {
                let entry = EntryKey::new(fragment.module, fragment.entry_point, &fragment.compilation_options);
                (entry, fragment.targets.to_vec())
            }),
            multiview_mask: descriptor.multiview_mask,
        }
    }
}
