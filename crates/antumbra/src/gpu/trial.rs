//! Trial binding of a host's texture view or buffer. wgpu does not tell a view's aspect, dimension or device, nor a buffer's
//! device, so it is bound on trial.

use super::Gpu;

/// What a view is bound as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ViewKind {
    /// `texture_2d<f32>`, of any float format or of depth.
    Float,
    /// The same that is filtered.
    Filtered,
    /// `texture_2d_array<f32>`.
    FloatArray,
    /// `texture_depth_2d`.
    Depth,
}

impl ViewKind {
    /// What wgpu says against a view of this kind; `None` where nothing is wrong with it, or where a browser does not answer at
    /// once.
    pub(crate) fn complaint(self, gpu: &Gpu, view: &wgpu::TextureView) -> Option<String> {
        complaint(gpu, self.binding_type(), wgpu::BindingResource::TextureView(view))
    }

    fn binding_type(self) -> wgpu::BindingType {
        let view_dimension = match self {
            Self::FloatArray => wgpu::TextureViewDimension::D2Array,
            Self::Float | Self::Filtered | Self::Depth => wgpu::TextureViewDimension::D2,
        };
        let sample_type = match self {
            Self::Depth => wgpu::TextureSampleType::Depth,
            Self::Filtered => wgpu::TextureSampleType::Float { filterable: true },
            Self::Float | Self::FloatArray => wgpu::TextureSampleType::Float { filterable: false },
        };
        wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
    }
}

/// What wgpu says against a storage buffer's being bound; `None` as [above](ViewKind::complaint).
pub(crate) fn storage_complaint(gpu: &Gpu, buffer: &wgpu::Buffer) -> Option<String> {
    let ty = wgpu::BufferBindingType::Storage { read_only: false };
    let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    complaint(gpu, ty, buffer.as_entire_binding())
}

fn complaint(gpu: &Gpu, ty: wgpu::BindingType, resource: wgpu::BindingResource<'_>) -> Option<String> {
    let visibility = wgpu::ShaderStages::COMPUTE;
    let entry = wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None };
    let label = Some("antumbra trial");
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &[entry] });
    let entries = [wgpu::BindGroupEntry { binding: 0, resource }];
    gpu.complaint(|| {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout: &layout, entries: &entries });
    })
}
