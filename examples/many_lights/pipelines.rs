//! Pipelines of the host, and their bind group layouts.

use super::buffers::Instance;
use super::meshes::{PackedVertex, Vertex};

pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
pub const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

pub struct Pipelines {
    /// Depth and normal passes, for plain and packed vertices.
    pub depth: [wgpu::RenderPipeline; 2],
    /// Colour passes at equal depth, for plain and packed vertices.
    pub color: [wgpu::RenderPipeline; 2],
    pub skinning: wgpu::ComputePipeline,
}

/// Bind group layouts of the render pipelines.
pub struct Layouts {
    pub globals: wgpu::BindGroupLayout,
    pub lights: wgpu::BindGroupLayout,
}

impl Layouts {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = |types: &[wgpu::BindingType]| {
            let entry = |(binding, ty): (u32, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: *ty,
                count: None,
            };
            let entries: Vec<_> = (0..).zip(types).map(entry).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = |filterable, view_dimension| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        Self {
            globals: layout(&[uniform, texture(true, wgpu::TextureViewDimension::D2), sampler]),
            // Masks are 32-bit floats, which are not filterable.
            lights: layout(&[uniform, texture(false, wgpu::TextureViewDimension::D2Array)]),
        }
    }
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("shader.wgsl"));
        let pipeline = |is_packed, with_color| render_pipeline(device, layouts, &module, is_packed, with_color);
        Self {
            depth: [pipeline(false, false), pipeline(true, false)],
            color: [pipeline(false, true), pipeline(true, true)],
            skinning: device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("skinning"),
                layout: None,
                module: &device.create_shader_module(wgpu::include_wgsl!("skinning.wgsl")),
                entry_point: Some("skin_vertices"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            }),
        }
    }
}

/// Creates the pipeline of the colour pass, or of the depth and normal pass, for plain or packed vertices.
fn render_pipeline(
    device: &wgpu::Device,
    layouts: &Layouts,
    module: &wgpu::ShaderModule,
    is_packed: bool,
    with_color: bool,
) -> wgpu::RenderPipeline {
    let instance = wgpu::vertex_attr_array![4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4];
    let plain = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2];
    let packed = wgpu::vertex_attr_array![0 => Snorm16x4, 1 => Snorm8x4];
    let buffer = |stride: usize, step_mode, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride: stride as u64, step_mode, attributes })
    };
    let groups = [Some(&layouts.globals), Some(&layouts.lights)];
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: if with_color { &groups } else { &groups[..1] },
        immediate_size: 0,
    });
    let (stride, attributes): (_, &[_]) =
        if is_packed { (size_of::<PackedVertex>(), &packed) } else { (size_of::<Vertex>(), &plain) };
    let target = if with_color { COLOR_FORMAT } else { NORMAL_FORMAT };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(if is_packed { "vertex_packed" } else { "vertex" }),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[
                buffer(stride, wgpu::VertexStepMode::Vertex, attributes),
                buffer(size_of::<Instance>(), wgpu::VertexStepMode::Instance, &instance),
            ],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(!with_color),
            depth_compare: Some(if with_color { wgpu::CompareFunction::Equal } else { wgpu::CompareFunction::Less }),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(if with_color { "fragment_color" } else { "fragment_depth" }),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(target.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Creates a bind group of resources in the order of their bindings.
pub fn bind_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let resources = (0..).zip(resources.iter().cloned());
    let entries: Vec<_> = resources.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
