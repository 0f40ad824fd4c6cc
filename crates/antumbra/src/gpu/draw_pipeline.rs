//! Render pipelines by what differs from one to the next.

use super::{Gpu, overrides};

/// A render pipeline of a linked shader.
#[derive(Clone, Debug)]
pub(crate) struct DrawPipeline<'a> {
    pub(crate) label: &'a str,
    pub(crate) wgsl: &'static str,
    /// Group by group.
    pub(crate) layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    /// The entry point of vertices.
    pub(crate) vertex: &'a str,
    pub(crate) vertex_buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// The entry point of fragments.
    pub(crate) fragment: Option<&'a str>,
    /// Its overridable constants.
    pub(crate) constants: &'a [(&'a str, f64)],
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) primitive: wgpu::PrimitiveState,
    pub(crate) depth: Option<wgpu::DepthStencilState>,
    /// Samples a texel of the attachments.
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
    /// The pipeline, shared by all that ask for the same.
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

/// A shader with the depth test before the fragment stage, which WGSL of the web has no word for: of devices with
/// `SHADER_EARLY_DEPTH_TEST` alone.
pub(crate) fn with_early_depth_test(wgsl: &str) -> String {
    wgsl.replace("@fragment", "@early_depth_test(force) @fragment")
}

/// A comparison with a depth attachment, and whether it is written.
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
