//! Cache keys of layouts and pipelines: everything that they are created from.

use std::hash::{Hash, Hasher};
use std::num::NonZeroU32;

/// Entries of a layout, first as declared, then as the device receives them.
pub(super) type LayoutKey = [Vec<wgpu::BindGroupLayoutEntry>; 2];

/// Text of a linked shader. It is part of the program, and so equal if its address is.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkedText(pub(super) &'static str);

impl LinkedText {
    fn address(self) -> (usize, usize) {
        (self.0.as_ptr() as usize, self.0.len())
    }
}

impl PartialEq for LinkedText {
    fn eq(&self, other: &Self) -> bool {
        self.address() == other.address()
    }
}

impl Eq for LinkedText {}

impl Hash for LinkedText {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.address().hash(state);
    }
}

/// Overridable constants: names, with the bits of their values.
pub(super) type Constants = Vec<(String, u64)>;

pub(super) fn constants_of(options: &wgpu::PipelineCompilationOptions<'_>) -> Constants {
    options.constants.iter().map(|(name, value)| ((*name).into(), value.to_bits())).collect()
}

/// Entry point, with values for its overridable constants.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(super) struct EntryKey {
    module: wgpu::ShaderModule,
    entry_point: Option<String>,
    constants: Constants,
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
            constants: constants_of(options),
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
