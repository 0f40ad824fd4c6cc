//! Typed uniforms, and helpers for descriptors that every pass repeats.

use std::sync::Arc;

use super::{DrawPipeline, Gpu, Stage, TableKey, overrides};

#[cfg(test)]
pub(crate) mod tests;

/// Layout of a member of a [`GpuStruct`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuField {
    /// Name of the member, the same in the shader.
    pub name: &'static str,
    /// Offset from the start of the struct, bytes.
    pub offset: usize,
    /// Size, bytes.
    pub size: usize,
}

/// Struct that Rust and the shaders share. A test compares [`FIELDS`](Self::FIELDS) with the struct of the same name in
/// every linked shader.
pub trait GpuStruct: bytemuck::Pod {
    /// Name of the struct in the shaders.
    #[cfg_attr(not(test), expect(dead_code, reason = "read only by the layout test"))]
    const WGSL_NAME: &'static str;
    /// Members in order, including padding.
    #[cfg_attr(not(test), expect(dead_code, reason = "read only by the layout test"))]
    const FIELDS: &'static [GpuField];
}

/// Declares structs that Rust and the shaders share. A test named after each compares it with the shaders.
macro_rules! gpu_structs {
    ($( $(#[$outer:meta])* pub(crate) struct $name:ident { $( $(#[$inner:meta])* $field:ident: $ty:ty, )+ } )+) => { $(
        $(#[$outer])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
        pub(crate) struct $name { $( $(#[$inner])* pub(crate) $field: $ty, )+ }

        impl $crate::gpu::GpuStruct for $name {
            const WGSL_NAME: &'static str = stringify!($name);
            const FIELDS: &'static [$crate::gpu::GpuField] = &[$( $crate::gpu::GpuField {
                name: stringify!($field),
                offset: std::mem::offset_of!($name, $field),
                size: size_of::<$ty>(),
            }, )+];
        }

        #[cfg(test)]
        #[test]
        #[allow(non_snake_case, reason = "named as what it tests")]
        fn $name() {
            $crate::gpu::buffers::tests::assert_same_layout::<$name>();
        }
    )+ };
}
pub(crate) use gpu_structs;

/// Creates a zeroed uniform buffer that holds one `T`.
pub(crate) fn create_uniform<T: GpuStruct>(gpu: &Gpu, label: &str) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size_of::<T>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Uploads a uniform before the frame's passes.
pub(crate) fn write_uniform<T: GpuStruct>(stage: &Stage<'_>, buffer: &wgpu::Buffer, value: &T) {
    stage.upload(buffer, 0, bytemuck::bytes_of(value));
}

/// Uploads a storage buffer before the frame's passes; recreates `buffer` if its size differs. `data` must not be empty,
/// because WebGPU has no empty bindings.
pub(crate) fn upload_storage<'a, T: bytemuck::NoUninit>(
    stage: &Stage<'_>,
    buffer: &'a mut Option<wgpu::Buffer>,
    label: &str,
    data: &[T],
) -> &'a wgpu::Buffer {
    let bytes = bytemuck::cast_slice::<T, u8>(data);
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let buffer = sized_buffer(stage, buffer, label, bytes.len() as u64, usage);
    stage.upload(buffer, 0, bytes);
    buffer
}

/// Returns a storage buffer whose content depends only on its key. It is created once and shared by all lights.
pub(crate) fn shared_table(gpu: &Gpu, key: TableKey, bytes: impl FnOnce() -> Vec<u8>) -> Arc<wgpu::Buffer> {
    let label = key.of;
    gpu.device.table(key, || {
        let bytes = bytes();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&buffer, 0, &bytes);
        buffer
    })
}

/// Uploads bytes whose number varies from frame to frame, to a storage buffer that never shrinks.
pub(crate) fn upload_growable<'a>(
    stage: &Stage<'_>,
    buffer: &'a mut Option<wgpu::Buffer>,
    label: &str,
    bytes: &[u8],
) -> &'a wgpu::Buffer {
    const STEP_BYTES: u64 = 4096;
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let room = buffer.as_ref().map_or(0, wgpu::Buffer::size);
    let needed = (bytes.len() as u64).next_multiple_of(STEP_BYTES);
    let buffer = sized_buffer(stage, buffer, label, room.max(needed), usage);
    stage.upload(buffer, 0, bytes);
    buffer
}

/// Returns a buffer of exactly `bytes` bytes: the existing one, or a new one if the size differs.
pub(crate) fn sized_buffer<'a>(
    gpu: &Gpu,
    buffer: &'a mut Option<wgpu::Buffer>,
    label: &str,
    bytes: u64,
    usage: wgpu::BufferUsages,
) -> &'a wgpu::Buffer {
    if buffer.as_ref().is_some_and(|buffer| buffer.size() != bytes) {
        *buffer = None;
    }
    buffer.get_or_insert_with(|| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    })
}

/// Creates the module of a linked shader.
pub(crate) fn shader_module(gpu: &Gpu, label: &str, wgsl: &'static str) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(label, wgsl)
}

/// Creates a compute pipeline from the only entry point of a linked shader.
pub(crate) fn compute_pipeline(
    gpu: &Gpu,
    label: &str,
    wgsl: &'static str,
    bind_group_layouts: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    compute_entry(gpu, label, wgsl, None, &[], bind_group_layouts)
}

/// Creates a compute pipeline from one entry point of a linked shader, with values for its overridable constants.
pub(crate) fn compute_entry(
    gpu: &Gpu,
    label: &str,
    wgsl: &'static str,
    entry_point: Option<&str>,
    constants: &[(&str, f64)],
    bind_group_layouts: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    compute_entry_with(gpu, label, wgsl, entry_point, constants, true, bind_group_layouts)
}

/// Creates a compute pipeline from the only entry point of a linked shader, without zeroing workgroup memory: the shader
/// writes all workgroup memory before reading it.
pub(crate) fn compute_pipeline_without_zeroing(
    gpu: &Gpu,
    label: &str,
    wgsl: &'static str,
    constants: &[(&str, f64)],
    bind_group_layouts: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    compute_entry_with(gpu, label, wgsl, None, constants, false, bind_group_layouts)
}

fn compute_entry_with(
    gpu: &Gpu,
    label: &str,
    wgsl: &'static str,
    entry_point: Option<&str>,
    constants: &[(&str, f64)],
    zero_initialize_workgroup_memory: bool,
    bind_group_layouts: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    let constants = overrides::linked(&crate::shaders::text_of(wgsl), constants);
    let constants: Vec<_> = constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let bind_group_layouts: Vec<_> = bind_group_layouts.iter().map(|layout| Some(*layout)).collect();
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &bind_group_layouts,
        immediate_size: 0,
    });
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        module: &shader_module(gpu, label, wgsl),
        entry_point,
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &constants,
            zero_initialize_workgroup_memory,
        },
        cache: None,
    })
}

/// Dispatches at least `threads` threads in workgroups of 64, in two dimensions if one exceeds WebGPU's limit.
pub(crate) fn dispatch_threads(pass: &mut wgpu::ComputePass<'_>, threads: u32) {
    const MAX_IN_ONE_DIMENSION: u32 = 65_535;
    let workgroups = threads.div_ceil(64);
    pass.dispatch_workgroups(workgroups.min(MAX_IN_ONE_DIMENSION), workgroups.div_ceil(MAX_IN_ONE_DIMENSION), 1);
}

/// Creates a pipeline that draws to all `targets` with the entry points `vertex` and `draw` of a linked shader.
pub(crate) fn color_pipeline(
    gpu: &Gpu,
    label: &str,
    wgsl: &'static str,
    layout: &wgpu::BindGroupLayout,
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    let layouts = [Some(layout)];
    DrawPipeline { label, wgsl, layouts: &layouts, fragment: Some("draw"), targets, ..DrawPipeline::default() }
        .create(gpu)
}
