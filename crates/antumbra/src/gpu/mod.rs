//! Layer between the techniques and wgpu: device capabilities, typed buffers, and the recorder that labels and times
//! every pass.

pub(crate) mod bindings;
mod budget;
pub(crate) mod buffers;
mod cached;
mod commands;
mod constant_branches;
mod content;
mod context;
mod device;
mod draw_pipeline;
pub(crate) mod embedded;
mod feedback;
mod lease;
#[cfg(feature = "mutants")]
pub(crate) mod mutants;
mod no_depth;
pub(crate) mod overrides;
mod plan;
#[doc(hidden)]
pub mod programs;
mod quirks;
mod rasteriser;
mod recorder;
mod scratch;
pub(crate) mod shared_constants;
mod shared_values;
mod stage;
mod textures;
mod trial;
mod uniforms;

pub(crate) use bindings::{Bindings, bindings, samples, texels};
pub(crate) use buffers::{
    GpuField, GpuStruct, color_pipeline, compute_entry, compute_pipeline, compute_pipeline_without_zeroing,
    create_uniform, dispatch_threads, gpu_structs, shader_module, shared_table, sized_buffer, upload_growable,
    upload_storage, write_uniform,
};
pub(crate) use cached::Cached;
pub(crate) use commands::{Commands, CommandsEnd};
pub(crate) use content::Content;
pub use context::{Gpu, MemoryBytes};
pub use device::ObjectCounts;
pub(crate) use device::{TableKey, texture_bytes};
pub(crate) use draw_pipeline::{DrawPipeline, depth_state, with_early_depth_test};
pub use embedded::ShaderFunction;
pub(crate) use embedded::{Embeddable, EmbeddedGroup};
pub(crate) use feedback::Feedback;
pub(crate) use lease::{Lease, LeasedBuffer};
pub(crate) use no_depth::NoDepth;
pub use plan::{MemoryPlan, PlannedResource};
pub use recorder::{Pass, PassTime, PassTimer, Recorder, Span};
pub(crate) use scratch::{Scratch, passed_texture};
pub(crate) use shared_constants::shared_constants;
pub(crate) use shared_values::SharedValues;
pub use stage::Stage;
pub(crate) use stage::{Resource, RetainedState, StagedUploads};
pub(crate) use textures::{array_view, slice_views, texture_of, white_texture};
pub(crate) use trial::{ViewKind, storage_validation_error};
