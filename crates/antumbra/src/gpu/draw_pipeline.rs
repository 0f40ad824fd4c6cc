//! Render pipeline descriptors, with defaults for everything but what differs between pipelines.

use super::{Gpu, overrides};

/// Descriptor of a render pipeline of a linked shader.
#[derive(Clone, Debug)]
pub(crate) struct DrawPipeline<'a> {
    pub(crate) label: &'a str,
    pub(crate) wgsl: &'static str,
    /// Bind group layouts, by group index.
    pub(crate) layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    /// Vertex entry point.
    pub(crate) vertex: &'a str,
    pub(crate) vertex_buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Fragment entry point; `None` for a pipeline without a fragment stage.
    pub(crate) fragment: Option<&'a str>,
    /// Values of overridable constants of the fragment stage, by name.
    pub(crate) constants: &'a [(&'a str, f64)],
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) primitive: wgpu::PrimitiveState,
    pub(crate) depth: Option<wgpu::DepthStencilState>,
    /// Samples per texel of the attachments.
    pub(crate) sample_count: u32,
}

impl Default for DrawPipeline<'_> {
    fn default() -> Self {
        Self {
            label: "",
            wgsl: "",
            layouts: &[],
            vertex: "vertex",
            vertex_buffers: &[],
            fragment: Some("fragment"),
            constants: &[],
            targets: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth: None,
            sample_count: 1,
        }
    }
}

impl DrawPipeline<'_> {
    /// Returns the pipeline, shared by all callers with an equal descriptor.
    pub(crate) fn create(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let label = Some(self.label);
        let module = gpu.device.create_shader_module(self.label, self.wgsl);
        let constants = overrides::linked(&crate::shaders::text_of(self.wgsl), self.constants);
        let constants: Vec<_> = constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: self.layouts,
            immediate_size: 0,
        });
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: self.vertex_buffers,
            },
            primitive: self.primitive,
            depth_stencil: self.depth.clone(),
            multisample: wgpu::MultisampleState { count: self.sample_count, ..wgpu::MultisampleState::default() },
            fragment: self.fragment.map(|entry_point| wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                targets: self.targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Returns the shader with the depth test forced before the fragment stage. The attribute is not part of WebGPU's WGSL,
/// so the device needs `SHADER_EARLY_DEPTH_TEST`.
pub(crate) fn with_early_depth_test(wgsl: &str) -> String {
    wgsl.replace("@fragment", "@early_depth_test(force) @fragment")
}

/// Depth state with a comparison and a write flag, without stencil and bias.
pub(crate) fn depth_state(
    format: wgpu::TextureFormat,
    compare: wgpu::CompareFunction,
    is_written: bool,
) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(is_written),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}
