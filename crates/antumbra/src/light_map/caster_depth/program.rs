//! Programs for casters: a pipeline for opaque casters and one for those with holes, and the vertex buffers that they read.

use super::CasterDepth;
use crate::gpu::{DrawPipeline, Gpu, depth_state};

/// Pipelines that draw casters: one for opaque casters and one for those with holes.
#[derive(Debug)]
pub(crate) struct CasterProgram {
    pub(super) opaque: wgpu::RenderPipeline,
    /// Pipeline for closed opaque meshes that culls back faces; `None` if all faces are drawn.
    pub(super) opaque_closed: Option<wgpu::RenderPipeline>,
    pub(super) cutout: wgpu::RenderPipeline,
}

/// Descriptor of a [`CasterProgram`]. Both shaders have the vertex entry point `vertex`, as this module's own shaders.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CasterProgramDescriptor<'a> {
    pub(crate) label: &'a str,
    pub(crate) opaque_wgsl: &'static str,
    pub(crate) cutout_wgsl: &'static str,
    /// Fragment entry point for opaque casters; `None` for no fragment stage.
    pub(crate) opaque_fragment: Option<&'a str>,
    pub(crate) cutout_fragment: &'a str,
    /// Overridable constants of the fragment entry points.
    pub(crate) constants: &'a [(&'a str, f64)],
    /// Layout of group 2, which is specific to the program.
    pub(crate) layout: Option<&'a wgpu::BindGroupLayout>,
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) depth_compare: wgpu::CompareFunction,
    pub(crate) depth_write: bool,
    /// Whether the back faces of closed, opaque meshes are culled.
    pub(crate) front_faces_of_solids: bool,
    /// Samples per texel of the attachments.
    pub(crate) sample_count: u32,
}

/// Kind of caster, which selects its pipeline.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Opaque,
    OpaqueClosed,
    CutOut,
}

pub(super) fn program(
    gpu: &Gpu,
    view_layout: &wgpu::BindGroupLayout,
    cutout_layout: &wgpu::BindGroupLayout,
    descriptor: &CasterProgramDescriptor<'_>,
) -> CasterProgram {
    CasterProgram {
        opaque: pipeline(gpu, descriptor, [Some(view_layout), None, descriptor.layout], Kind::Opaque),
        opaque_closed: descriptor
            .front_faces_of_solids
            .then(|| pipeline(gpu, descriptor, [Some(view_layout), None, descriptor.layout], Kind::OpaqueClosed)),
        cutout: pipeline(gpu, descriptor, [Some(view_layout), Some(cutout_layout), descriptor.layout], Kind::CutOut),
    }
}

fn pipeline(
    gpu: &Gpu,
    descriptor: &CasterProgramDescriptor<'_>,
    bind_group_layouts: [Option<&wgpu::BindGroupLayout>; 3],
    kind: Kind,
) -> wgpu::RenderPipeline {
    let cut_out = kind == Kind::CutOut;
    let (wgsl, fragment) = if cut_out {
        (descriptor.cutout_wgsl, Some(descriptor.cutout_fragment))
    } else {
        (descriptor.opaque_wgsl, descriptor.opaque_fragment)
    };
    let used = bind_group_layouts.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let buffers = [Some(POSITIONS), Some(INSTANCES), Some(UVS)];
    DrawPipeline {
        label: descriptor.label,
        wgsl,
        layouts: &bind_group_layouts[..used],
        vertex_buffers: if cut_out { &buffers } else { &buffers[..2] },
        fragment,
        constants: descriptor.constants,
        targets: descriptor.targets,
        primitive: caster_primitives(gpu, (kind == Kind::OpaqueClosed).then_some(wgpu::Face::Back)),
        depth: Some(depth_state(CasterDepth::FORMAT, descriptor.depth_compare, descriptor.depth_write)),
        sample_count: descriptor.sample_count,
        ..DrawPipeline::default()
    }
    .create(gpu)
}

/// Vertex buffer of casters' positions.
pub(crate) const POSITIONS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 12,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3],
};

/// Instance buffer of casters' matrices, column by column.
pub(crate) const INSTANCES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Float32x4],
};

/// Vertex buffer of casters' texture coordinates.
pub(crate) const UVS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 8,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![5 => Float32x2],
};

/// Primitive state of casters. Triangles nearer than the near plane, where the light's plane cuts them, are drawn at it, not clipped.
pub(crate) fn caster_primitives(gpu: &Gpu, cull_mode: Option<wgpu::Face>) -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        cull_mode,
        unclipped_depth: gpu.has(wgpu::Features::DEPTH_CLIP_CONTROL),
        ..wgpu::PrimitiveState::default()
    }
}
