//! The thin layer between the techniques and wgpu: what the device can do, typed buffers, and the recorder that labels
//! and times every pass.

mod buffers;
mod context;
mod recorder;

pub(crate) use buffers::{
    GpuField, GpuStruct, compute_pipeline, create_uniform, gpu_structs, shader_module, storage_entry,
    storage_texture_entry, texture_entry, uniform_entry, upload_storage, write_uniform,
};
pub use context::Gpu;
pub use recorder::{PassTime, PassTimer, Recorder, Span};
