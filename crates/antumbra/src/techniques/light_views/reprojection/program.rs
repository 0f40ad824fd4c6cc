//! Compute pipelines over a central map.

use crate::gpu::{Gpu, overrides, shader_module};

/// Creates a compute pipeline with group 1, the central map, and group 2, the splat.
pub(super) fn compute_program(
    gpu: &Gpu,
    wgsl: &'static str,
    layouts: &[Option<&wgpu::BindGroupLayout>],
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    let constants = overrides::linked(&crate::shaders::text_of(wgsl), constants);
    let constants: Vec<_> = constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("reprojection"),
        bind_group_layouts: layouts,
        immediate_size: 0,
    });
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("reprojection"),
        layout: Some(&layout),
        module: &shader_module(gpu, "reprojection", wgsl),
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &constants,
            ..wgpu::PipelineCompilationOptions::default()
        },
        cache: None,
    })
}
