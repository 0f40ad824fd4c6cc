//! Geometric normals of a view.
//!
//! The library uses surfaces' planes against light leaks. Without normals it derives the planes from depth alone, which gives a
//! neighbour's plane at silhouettes and on thin surfaces. Bevy's normal prepass knows a pixel's surface, but not its plane: its
//! normals are interpolated and mapped, with ten bits. `normals.wgsl` combines both.

/// Uniform `View` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct View {
    view_from_clip: glam::Mat4,
    world_from_view: glam::Mat4,
    origin_px: glam::UVec2,
    size_px: glam::UVec2,
}

/// Normal derivation pass, one per device.
pub struct NormalDeriver {
    device: wgpu::Device,
    pipeline: wgpu::ComputePipeline,
}

/// Geometric normals of a view.
pub struct Normals {
    /// Normals in world space: `Rgba32Float`, of the normal prepass's size.
    pub view: wgpu::TextureView,
    uniform: wgpu::Buffer,
    /// Depth that the normals are derived from.
    depth: wgpu::TextureView,
    shading_normals: wgpu::Texture,
    group: wgpu::BindGroup,
}

/// Inputs from which a view's normals are derived.
pub struct NormalSources<'a> {
    pub depth: &'a wgpu::TextureView,
    pub shading_normals: &'a wgpu::Texture,
    pub view_from_world: glam::Mat4,
    pub clip_from_view: glam::Mat4,
    pub origin_px: glam::UVec2,
    pub size_px: glam::UVec2,
}

impl NormalDeriver {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bevy_antumbra normals"),
            source: wgpu::ShaderSource::Wgsl(include_str!("normals.wgsl").into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("bevy_antumbra normals"),
            layout: None,
            module: &module,
            entry_point: Some("derive"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { device: device.clone(), pipeline }
    }

    /// Records a view's normals. Reuses an earlier frame's resources if they fit.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        queue: &wgpu::Queue,
        kept: Option<Normals>,
        sources: &NormalSources<'_>,
    ) -> Normals {
        let fits =
            |normals: &Normals| normals.depth == *sources.depth && normals.shading_normals == *sources.shading_normals;
        let normals = kept.filter(fits).unwrap_or_else(|| self.make(sources));
        let view = View {
            view_from_clip: sources.clip_from_view.inverse(),
            world_from_view: sources.view_from_world.inverse(),
            origin_px: sources.origin_px,
            size_px: sources.size_px,
        };
        queue.write_buffer(&normals.uniform, 0, bytemuck::bytes_of(&view));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("bevy_antumbra normals"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &normals.group, &[]);
        pass.dispatch_workgroups(sources.size_px.x.div_ceil(8), sources.size_px.y.div_ceil(8), 1);
        drop(pass);
        normals
    }

    fn make(&self, sources: &NormalSources<'_>) -> Normals {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("bevy_antumbra normals"),
            size: sources.shading_normals.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let shading = sources.shading_normals.create_view(&wgpu::TextureViewDescriptor::default());
        let uniform = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("bevy_antumbra normals"),
            size: size_of::<View>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("bevy_antumbra normals"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, uniform.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(sources.depth)),
                entry(2, wgpu::BindingResource::TextureView(&shading)),
                entry(3, wgpu::BindingResource::TextureView(&view)),
            ],
        });
        let (depth, shading_normals) = (sources.depth.clone(), sources.shading_normals.clone());
        Normals { view, uniform, depth, shading_normals, group }
    }
}
