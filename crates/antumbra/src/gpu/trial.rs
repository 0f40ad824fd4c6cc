//! Trial binding of a host's texture view or buffer, because wgpu does not reveal a view's aspect, dimension or device, nor a
//! buffer's device.

use super::Gpu;

/// Binding type of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ViewKind {
    /// `texture_2d<f32>`, of any float or depth format.
    Float,
    /// `texture_2d<f32>` of a filterable format.
    Filtered,
    /// `texture_2d_array<f32>`.
    FloatArray,
    /// `texture_depth_2d`.
    Depth,
}

impl ViewKind {
    /// Validation error that wgpu reports for a view of this kind, or `None`; `None` also if a browser does not answer at once.
    pub(crate) fn validation_error(self, gpu: &Gpu, view: &wgpu::TextureView) -> Option<String> {
        validation_error(gpu, self.binding_type(), wgpu::BindingResource::TextureView(view))
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

/// Validation error that wgpu reports for a storage buffer; `None` as for [`ViewKind::validation_error`].
pub(crate) fn storage_validation_error(gpu: &Gpu, buffer: &wgpu::Buffer) -> Option<String> {
    let ty = wgpu::BufferBindingType::Storage { read_only: false };
    let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    validation_error(gpu, ty, buffer.as_entire_binding())
}

fn validation_error(gpu: &Gpu, ty: wgpu::BindingType, resource: wgpu::BindingResource<'_>) -> Option<String> {
    let visibility = wgpu::ShaderStages::COMPUTE;
    let entry = wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None };
    let label = Some("antumbra trial");
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &[entry] });
    let entries = [wgpu::BindGroupEntry { binding: 0, resource }];
    gpu.validation_error(|| {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout: &layout, entries: &entries });
    })
}
