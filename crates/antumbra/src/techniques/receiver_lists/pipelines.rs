//! Bind group layouts and pipelines of the passes.

use crate::frame::inputs::FrameInputs;
use crate::gpu::{Gpu, compute_entry, compute_pipeline, read_write_entry, storage_entry, texture_entry, uniform_entry};
use crate::shaders;

use super::Options;
use super::batches::Surfaces;

#[derive(Debug)]
pub(super) struct Layouts {
    pub(super) clear: wgpu::BindGroupLayout,
    pub(super) lists: wgpu::BindGroupLayout,
    pub(super) arguments: wgpu::BindGroupLayout,
    pub(super) passes: wgpu::BindGroupLayout,
    pub(super) casters: wgpu::BindGroupLayout,
    pub(super) mesh: wgpu::BindGroupLayout,
    pub(super) boxes: wgpu::BindGroupLayout,
    pub(super) evaluate: wgpu::BindGroupLayout,
    pub(super) surface: wgpu::BindGroupLayout,
    pub(super) make_lookup: wgpu::BindGroupLayout,
}

#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) clear: wgpu::ComputePipeline,
    pub(super) bounds: wgpu::ComputePipeline,
    pub(super) count: wgpu::ComputePipeline,
    pub(super) scatter: wgpu::ComputePipeline,
    pub(super) arguments: wgpu::ComputePipeline,
    pub(super) begin: wgpu::ComputePipeline,
    pub(super) advance: wgpu::ComputePipeline,
    pub(super) edge_faces: wgpu::ComputePipeline,
    pub(super) triangle_count: wgpu::ComputePipeline,
    pub(super) triangle_scatter: wgpu::ComputePipeline,
    pub(super) cluster_boxes: wgpu::ComputePipeline,
    pub(super) super_boxes: wgpu::ComputePipeline,
    pub(super) make_lookup: wgpu::ComputePipeline,
}

/// What an evaluating pipeline is for; see the shader's `override` constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Evaluator {
    uses_table: bool,
    has_holes: bool,
    has_tint: bool,
    counts: bool,
}

impl Evaluator {
    pub(super) fn of(surfaces: Surfaces, options: &Options) -> Self {
        Self {
            uses_table: options.lookup_size > 0,
            has_holes: matches!(surfaces, Surfaces::Masked(_)),
            has_tint: matches!(surfaces, Surfaces::Tinted(_)),
            counts: options.counts,
        }
    }

    pub(super) fn pipeline(self, gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) -> wgpu::ComputePipeline {
        compute_entry(
            gpu,
            "view-sample evaluate",
            shaders::VIEW_SAMPLES_EVALUATE,
            None,
            &self.constants(),
            &[&inputs.layout, &layouts.evaluate, &layouts.surface],
        )
    }

    /// The shader's `override` constants.
    pub(super) fn constants(self) -> [(&'static str, f64); 4] {
        let value = |is_on: bool| f64::from(u8::from(is_on));
        [
            ("USES_TABLE", value(self.uses_table)),
            ("HAS_HOLES", value(self.has_holes)),
            ("HAS_TINT", value(self.has_tint)),
            ("COUNTS", value(self.counts)),
        ]
    }
}

impl Layouts {
    pub(super) fn new(gpu: &Gpu) -> Self {
        const COMPUTE: wgpu::ShaderStages = wgpu::ShaderStages::COMPUTE;
        // Triangles are also rasterised.
        const BOTH: wgpu::ShaderStages = COMPUTE.union(wgpu::ShaderStages::FRAGMENT);
        let uniform = |binding| uniform_entry(binding, COMPUTE);
        let read = |binding| storage_entry(binding, COMPUTE);
        let write = |binding| read_write_entry(binding, COMPUTE);
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        Self {
            clear: layout("view-sample clear", &[write(0)]),
            lists: layout(
                "view-sample lists",
                &[uniform(0), write(1), write(2), write(3), write(4), write(5), read(6)],
            ),
            arguments: layout("view-sample arguments", &[uniform(0), read(1), read(2), write(3)]),
            passes: layout("view-sample passes", &[write(0), write(1), write(2)]),
            casters: layout("view-sample casters", &[uniform(0), uniform(1), write(2), write(3), write(4), write(5)]),
            mesh: layout("view-sample mesh", &[uniform(0), read(1), read(2), read(3), read(4)]),
            boxes: layout("view-sample boxes", &[uniform(0), read(1), read(2), write(3)]),
            evaluate: layout(
                "view-sample evaluate",
                &[
                    uniform(0),
                    read(1),
                    read(2),
                    read(3),
                    read(4),
                    write(5),
                    read(6),
                    texture_entry(7, wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D3),
                    write(8),
                ],
            ),
            surface: layout(
                "view-sample surface",
                &[
                    uniform_entry(0, BOTH),
                    wgpu::BindGroupLayoutEntry {
                        visibility: BOTH,
                        ..texture_entry(
                            1,
                            wgpu::TextureSampleType::Float { filterable: true },
                            wgpu::TextureViewDimension::D2,
                        )
                    },
                    wgpu::BindGroupLayoutEntry {
                        binding: 2,
                        visibility: BOTH,
                        ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                        count: None,
                    },
                ],
            ),
            make_lookup: layout(
                "view-sample table",
                &[
                    uniform(0),
                    read(1),
                    wgpu::BindGroupLayoutEntry {
                        binding: 2,
                        visibility: COMPUTE,
                        ty: wgpu::BindingType::StorageTexture {
                            access: wgpu::StorageTextureAccess::WriteOnly,
                            format: wgpu::TextureFormat::Rgba32Uint,
                            view_dimension: wgpu::TextureViewDimension::D3,
                        },
                        count: None,
                    },
                ],
            ),
        }
    }
}

impl Pipelines {
    pub(super) fn new(gpu: &Gpu, inputs: &FrameInputs, layouts: &Layouts) -> Self {
        let lists = [&inputs.layout, &layouts.lists];
        let casters = [&layouts.casters, &layouts.mesh];
        Self {
            clear: compute_pipeline(gpu, "view-sample clear", shaders::VIEW_SAMPLES_CLEAR, &[&layouts.clear]),
            bounds: compute_pipeline(gpu, "view-sample bounds", shaders::VIEW_SAMPLES_BOUNDS, &lists),
            count: compute_pipeline(gpu, "view-sample count", shaders::VIEW_SAMPLES_COUNT, &lists),
            scatter: compute_pipeline(gpu, "view-sample scatter", shaders::VIEW_SAMPLES_SCATTER, &lists),
            arguments: compute_pipeline(
                gpu,
                "view-sample arguments",
                shaders::VIEW_SAMPLES_ARGUMENTS,
                &[&layouts.arguments],
            ),
            begin: compute_pipeline(gpu, "view-sample begin", shaders::VIEW_SAMPLES_BEGIN, &[&layouts.passes]),
            advance: compute_pipeline(gpu, "view-sample advance", shaders::VIEW_SAMPLES_ADVANCE, &[&layouts.passes]),
            edge_faces: compute_pipeline(gpu, "edge faces", shaders::VIEW_SAMPLES_EDGE_FACES, &casters),
            triangle_count: compute_pipeline(gpu, "triangle count", shaders::VIEW_SAMPLES_TRIANGLE_COUNT, &casters),
            triangle_scatter: compute_pipeline(
                gpu,
                "triangle scatter",
                shaders::VIEW_SAMPLES_TRIANGLE_SCATTER,
                &casters,
            ),
            cluster_boxes: compute_pipeline(
                gpu,
                "cluster boxes",
                shaders::VIEW_SAMPLES_CLUSTER_BOXES,
                &[&layouts.boxes],
            ),
            super_boxes: compute_pipeline(gpu, "super boxes", shaders::VIEW_SAMPLES_SUPER_BOXES, &[&layouts.boxes]),
            make_lookup: compute_pipeline(
                gpu,
                "view-sample table",
                shaders::VIEW_SAMPLES_MAKE_LOOKUP,
                &[&layouts.make_lookup],
            ),
        }
    }
}
